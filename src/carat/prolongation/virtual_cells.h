#pragma once
// The virtual vertices of the faces and cells of a volume mesh, and the prolongation to them.

#include "carat/base/diagnostics.h"
#include "carat/kernels/virtual_cell.h"
#include "carat/kernels/virtual_vertex.h"
#include "carat/mesh/polyhedral_mesh.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {

/// One virtual vertex a face and a cell. A *virtual tetrahedron* (x_i, x_{i+1}, x_f, x_c) belongs
/// to every corner of a face and every cell of it.
struct VirtualCells {
  VirtualVertices faces;       ///< of all faces: weights and triangles by face corner
  Points face_points;          ///< (n_faces, 3)  [length]
  Array<double> cell_weights;  ///< cell corner -> affine weight of its vertex  [BBA21 (29), (30)]
  Points cell_points;          ///< (n_cells, 3), sum of weights times positions  [length]
  Array<VirtualVertexStatus> cell_status;
  Array<FaceMoment> face_moments;  ///< of all faces
};

/// The point of a cell minimises the sum of its squared virtual tetrahedra (rule.point
/// AreaMinimizer or TraceMinimizer), or is the mean of its vertices and face points (Centroid). Its
/// weights are those of least norm over vertices and face points, composed with the faces' own.
/// Tetrahedra: 1/4 each. A point that flips a virtual tetrahedron is moved to a centre of the
/// cell's kernel, if it has one and rule.keep_in_kernel is set.
/// \param points  positions to use, (n_vertices, 3)  [length]
/// Cost: O(corners of faces). The memory of `result` is reused.
void update_virtual_cells(const PolyhedralMesh& mesh, const Points& points,
                          const VirtualVertexRule& rule, int threads, VirtualCells& result);

/// (n_vertices + n_faces + n_cells) x n_vertices: P = P_C P_F.  [BBA21 (17), (30)]
SparseMatrix prolongation_matrix(const PolyhedralMesh& mesh, const VirtualCells& virtuals);

/// Lists faces and cells whose virtual vertex was moved, flips an element, or has nothing to lie
/// in.
void report_virtual_cells(const VirtualCells& virtuals, Diagnostics& diagnostics);

}  // namespace carat
