#pragma once
// One diamond of a surface: the region of an edge and the virtual vertices of the faces beside it.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "carat/base/types.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {

/// A diamond's energy |D| |g|^2 = alpha (u2-u1)^2 - 2 beta (u2-u1)(ul-ur) + gamma (ul-ur)^2, with
/// alpha gamma - beta^2 = 1/4. The unfolding (11)-(12) is in the feet and areas: a virtual
/// triangle's foot on the hinge and its area do not change when it is turned about the hinge.
struct Diamond2d {
  double alpha, beta, gamma;  ///< dimensionless
  double shear;               ///< foot of l minus foot of r, in units of the hinge
  double area;                ///< |D|  [length^2]; 0 if the diamond is degenerate
};

/// A missing side of a boundary diamond: the midpoint of the hinge.
inline constexpr VirtualTriangle kHingeMidpoint{0.5, 0.0};

/// Energy of one diamond.   [BBA21 (7), (12), (21)]
///
/// \param length2      squared hinge length |x2-x1|^2                  [length^2]
/// \param left,right   the two virtual triangles, feet measured from x1; kHingeMidpoint where the
///                     side is missing
/// \param eps_rel      |D| <= eps_rel * size^2 counts as degenerate, size = largest of the hinge
///                     and the distances of the virtual vertices from x1
/// \return all zero if the diamond is degenerate
/// Cost: O(1), no allocation. Thread-safe.
inline Diamond2d diamond_2d(double length2, VirtualTriangle left, VirtualTriangle right,
                            double eps_rel) {
  const double a2 = left.double_area + right.double_area;  // 2 |D|
  // Both sides times length2, which saves the divisions.
  const auto distance2 = [&](VirtualTriangle t) {
    const double along = t.foot * length2;
    return along * along + t.double_area * t.double_area;
  };
  const double size2 = std::max({length2 * length2, distance2(left), distance2(right)});
  if (!(length2 > 0 && a2 * length2 > 2 * eps_rel * size2)) return {0, 0, 0, 0, 0};
  const double shear = left.foot - right.foot;
  const double gamma = length2 / (2 * a2);
  const double beta = gamma * shear;
  return {a2 / (2 * length2) + beta * shear, beta, gamma, shear, a2 / 2};
}

/// Gradient of the affine fit over one surface diamond.   [BBA21 (13)]
///
/// \param x1,x2  hinge end points                                      [length]
/// \param xl,xr  virtual vertices; on the boundary the midpoint of the hinge stands for the
///               missing one                                           [length]
/// \return 2x4, columns (1, 2, l, r), rows along u = x2-x1 and along the left normal v
///         [1/length]; not finite where |D| = 0
/// Cost: O(1), no allocation. Thread-safe.
inline Eigen::Matrix<double, 2, 4> diamond_gradient(const Vec3& x1, const Vec3& x2, const Vec3& xl,
                                                    const Vec3& xr) {
  const Vec3 e = x2 - x1;
  const double length = e.norm();
  const double height = (e.cross(xl - x1).norm() + e.cross(xr - x1).norm()) / length;
  const double shear = e.dot(xl - xr) / (length * length);
  Eigen::Matrix<double, 2, 4> g;
  g << -1 / length, 1 / length, 0, 0, shear / height, -shear / height, 1 / height, -1 / height;
  return g;
}

}  // namespace carat
