#pragma once
// Linear finite elements on one triangle.

#include <Eigen/Geometry>

#include "carat/base/types.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {

/// Cotangents of a triangle's angles at its hinge's ends and at its tip.
struct TriangleCotangents {
  double at_first, at_second, at_tip;
};

/// From the tip's foot on the hinge and the area.  cot at x1 = (xt-x1).(x2-x1) / 2A, and so on.
/// \param length2  squared hinge length  [length^2]
/// Not finite for a triangle without area. Cost: O(1). Thread-safe.
inline TriangleCotangents triangle_cotangents(double length2, VirtualTriangle t) {
  const double ratio = length2 / t.double_area;
  return {t.foot * ratio, (1 - t.foot) * ratio, 1 / ratio - t.foot * (1 - t.foot) * ratio};
}

/// Gradients of the three linear hat functions of a triangle in space: columns, 3x3.
/// \return not finite for a triangle without area  [1/length]
/// Cost: O(1). Thread-safe.
inline Eigen::Matrix3d hat_gradients(const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const Vec3 e1 = x3 - x2, e2 = x1 - x3, e3 = x2 - x1;
  const Vec3 n = e1.cross(e2);  // 2A times the unit normal
  Eigen::Matrix3d g;
  g << n.cross(e1), n.cross(e2), n.cross(e3);
  return g / n.squaredNorm();
}

}  // namespace carat
