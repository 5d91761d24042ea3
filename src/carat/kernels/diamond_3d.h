#pragma once
// One minimal diamond of a volume: a side of a face with the face point as base, and the virtual
// vertices of the two cells as tips.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

#include "carat/base/types.h"

namespace carat {

/// A minimal diamond with p = x2-x1, q = xf-x1, d = xr-xl. The affine fit through the differences
/// s = u2-u1, t = uf-u1, w = ur-ul is g = (s q x d + t d x p + w p x q) / det(p, q, d).
struct Diamond3d {
  Vec3 s, t, w;        ///< the three products  [length^2]
  double determinant;  ///< 6 |D|  [length^3]; <= 0 if the diamond is degenerate or inverted

  double volume() const { return determinant / 6; }
};

/// \param x1,x2,xf  base triangle, seen counter-clockwise from xr           [length]
/// \param xl,xr     tips; on the boundary xf stands for the missing one     [length]
/// \param eps_rel   |D| <= eps_rel * size^3 counts as degenerate, size = the longest of p, q, d
/// Cost: O(1), no allocation. Thread-safe.   [BBA21 (28)]
inline Diamond3d diamond_3d(const Vec3& x1, const Vec3& x2, const Vec3& xf, const Vec3& xl,
                            const Vec3& xr, double eps_rel) {
  const Vec3 p = x2 - x1, q = xf - x1, d = xr - xl;
  Diamond3d diamond{q.cross(d), d.cross(p), p.cross(q), 0};
  const double determinant = diamond.w.dot(d);
  const double size2 = std::max({p.squaredNorm(), q.squaredNorm(), d.squaredNorm()});
  const double limit = 6 * eps_rel;
  if (determinant > 0 && determinant * determinant > limit * limit * (size2 * size2 * size2))
    diamond.determinant = determinant;
  return diamond;
}

/// Gradient of the affine fit, 3x5, columns (1, 2, f, l, r).   [1/length]   [BBA21 (27)]
/// \return not finite for a degenerate diamond
inline Eigen::Matrix<double, 3, 5> diamond_gradient(const Diamond3d& diamond) {
  Eigen::Matrix<double, 3, 5> g;
  g << -diamond.s - diamond.t, diamond.s, diamond.t, -diamond.w, diamond.w;
  return g / diamond.determinant;
}

}  // namespace carat
