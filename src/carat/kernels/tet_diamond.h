#pragma once
// The three minimal diamonds of a face between two tetrahedra: they have one gradient.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "carat/base/types.h"
#include "carat/kernels/diamond_3d.h"

namespace carat {

/// Energy of the diamonds of a face (a, b, c): that of the couplings ab, ac, bc between its
/// vertices, plus 2 w alpha . (ua, ub, uc) + gamma w^2, w = u_r - u_l. All 0 if they are
/// degenerate.
struct TetFaceDiamonds {
  double ab, ac, bc;
  std::array<double, 3> alpha;
  double gamma;
  double volume;  ///< of one of the three minimal diamonds  [length^3]
};

/// \param a,b,c  the face, seen counter-clockwise from x_r  [length]
/// \param tip    x_r - x_l                                  [length]
/// Cost: O(1), no allocation. Thread-safe.   [BBA21 (28)]
inline TetFaceDiamonds tet_face_diamonds(const Vec3& a, const Vec3& b, const Vec3& c,
                                         const Vec3& tip, double eps_rel) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 s = ac.cross(tip), t = tip.cross(ab), w = ab.cross(ac);
  // Of one minimal diamond, whose base is a third of the face.
  const double det = w.dot(tip) / 3;
  const double size2 =
      std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm(), tip.squaredNorm()});
  const double limit = 6 * eps_rel;
  if (!(det > 0 && det * det > limit * limit * (size2 * size2 * size2))) return {};
  // |D| |g|^2 with g = (s du_ab + t du_ac + w du_tip) / (3 det), |D| = det / 2 for all three
  const double scale = 1 / (18 * det);
  const double ss = scale * s.dot(s), tt = scale * t.dot(t), st = scale * s.dot(t);
  const double sw = scale * s.dot(w), tw = scale * t.dot(w);
  return {ss + st, tt + st, -st, {-(sw + tw), sw, tw}, scale * w.dot(w), det / 6};
}

}  // namespace carat
