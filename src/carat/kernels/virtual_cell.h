#pragma once
// The virtual vertex of a polyhedron: where it lies and how it depends on its vertices.

#include <span>
#include <vector>

#include "carat/base/types.h"
#include "carat/kernels/half_space_center.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {

/// Sum over a face's virtual triangles of a a^T, a their area vectors: all that the squared volumes
/// over the face depend on, since the face point lies on all of them.  [length^4]
struct FaceMoment {
  double xx, yy, zz, xy, xz, yz;
};

/// \param face  the face's vertices; \param point  its virtual vertex
FaceMoment face_moment(const Points& points, std::span<const Index> face, const Vec3& point);

/// Whether a tetrahedron has no volume to speak of. Its virtual vertex needs nothing else: the
/// weights are 1/4.
bool is_flat_tetrahedron(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3);

/// A polyhedron as VirtualCellKernel sees it; everything is relative to one of its vertices.
struct CellGeometry {
  std::vector<Vec3> vertices, face_points;
  std::vector<FaceMoment> moments;        ///< one a face
  std::vector<HalfSpace> virtual_planes;  ///< behind the virtual boundary triangles, pointing out
};

/// Computes virtual vertices of cells. One object a thread.
class VirtualCellKernel {
 public:
  explicit VirtualCellKernel(VirtualVertexRule rule) : rule_(rule) {}

  /// \param cell          may be scaled and shifted
  /// \param weights       receives one a vertex, then one a face point; sum 1   [BBA21 (29)]
  /// The point is sum of weights times positions.
  VirtualVertexStatus compute(CellGeometry& cell, double* weights);

 private:
  bool minimise_volume(const CellGeometry& cell);
  bool set_weights(const CellGeometry& cell, double* weights);

  VirtualVertexRule rule_;
  Vec3 offset_;  // relative to the mean of vertices and face points
};

}  // namespace carat
