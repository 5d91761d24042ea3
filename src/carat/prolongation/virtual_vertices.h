#pragma once
// The virtual vertices of a surface mesh, and the prolongation from vertices to them.

#include "carat/base/diagnostics.h"
#include "carat/kernels/virtual_vertex.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// One virtual vertex a face, with the virtual triangles it spans with the face's sides.
struct VirtualVertices {
  Array<double> weights;              ///< corner -> affine weight of its vertex   [BBA21 (15)]
  Array<VirtualTriangle> triangles;   ///< corner -> triangle over the side it stands for
  Array<VirtualVertexStatus> status;  ///< face -> how its point came about
};

/// \param points   positions to use, (n_vertices, 3): the mesh's own or others  [length]
/// \param threads  0: all the machine has. The result does not depend on it.
/// Cost: O(corners).
VirtualVertices virtual_vertices(const PolygonMesh& mesh, const Points& points,
                                 const VirtualVertexRule& rule = {}, int threads = 0);

/// The same into `result`, whose memory is reused.
void update_virtual_vertices(const PolygonMesh& mesh, const Points& points,
                             const VirtualVertexRule& rule, int threads, VirtualVertices& result);

/// Positions of the virtual vertices, (n_faces, 3), x_f = sum a_i x_i evaluated about the mean of
/// each face so that no accuracy is lost far from the origin.  [length]   [BBA21 (15)]
Points face_points(const PolygonMesh& mesh, const Points& points, const Array<double>& weights);

/// (n_vertices + n_faces) x n_vertices: the identity, then a row of weights a face.  [BBA21 (17)]
SparseMatrix prolongation_matrix(const PolygonMesh& mesh, const Array<double>& weights);

/// Lists the faces whose virtual vertex was moved, flips a triangle, or has no area to lie in.
void report_virtual_vertices(const VirtualVertices& virtuals, Diagnostics& diagnostics);
void report_virtual_vertices(std::vector<Index> moved, std::vector<Index> flipped,
                             std::vector<Index> degenerate, Diagnostics& diagnostics);

}  // namespace carat
