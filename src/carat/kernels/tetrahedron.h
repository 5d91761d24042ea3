#pragma once
// Linear finite elements on one tetrahedron.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

#include "carat/base/types.h"

namespace carat {

/// A tetrahedron with the gradients of its four linear hat functions, normal / determinant.
struct Tetrahedron {
  Vec3 normal[4];  ///< twice the area vectors of the opposite faces, pointing inwards  [length^2]
  double determinant;  ///< 6 V  [length^3]; 0 if the tetrahedron is degenerate or inverted

  double volume() const { return determinant / 6; }
  /// V grad_a . grad_b, off the diagonal -1/6 of the length of the opposite edge times the
  /// cotangent of the dihedral angle there.  [length]
  double coupling(int a, int b) const { return normal[a].dot(normal[b]) / (6 * determinant); }
  /// The same with a tensor between the gradients.
  double coupling(int a, int b, const Eigen::Matrix3d& k) const {
    return normal[a].dot(k * normal[b]) / (6 * determinant);
  }
};

/// \param x1,x2,x3  seen clockwise from x4  [length]
/// \param eps_rel   V <= eps_rel * size^3 counts as degenerate, size = the longest edge
/// Cost: O(1), no allocation. Thread-safe.
inline Tetrahedron tetrahedron(const Vec3& x1, const Vec3& x2, const Vec3& x3, const Vec3& x4,
                               double eps_rel) {
  const Vec3 p = x1 - x4, q = x2 - x4, r = x3 - x4;
  Tetrahedron tet{{q.cross(r), r.cross(p), p.cross(q), Vec3::Zero()}, 0};
  tet.normal[3] = -(tet.normal[0] + tet.normal[1] + tet.normal[2]);
  const double determinant = p.dot(tet.normal[0]);
  const double size2 =
      std::max({p.squaredNorm(), q.squaredNorm(), r.squaredNorm(), (p - q).squaredNorm(),
                (q - r).squaredNorm(), (r - p).squaredNorm()});
  const double limit = 6 * eps_rel;
  if (determinant > 0 && determinant * determinant > limit * limit * (size2 * size2 * size2))
    tet.determinant = determinant;
  return tet;
}

}  // namespace carat
