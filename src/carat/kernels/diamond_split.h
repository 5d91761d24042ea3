#pragma once
// What a diamond needs beyond its own gradient: where its two diagonals cross, the energy of the
// jump between its two halves, and masses that meet its first moment.

#include <algorithm>
#include <array>
#include <cstddef>

#include "carat/kernels/diamond_2d.h"
#include "carat/kernels/diamond_3d.h"

namespace carat {

/// The line between a diamond's tips l and r meets the plane (surfaces: the line) of its base at
/// p = left x_l + right x_r = sum of base[i] x_i. A function that is linear on either half jumps in
/// its normal derivative by (left u_l + right u_r - sum of base[i] u_i) / height, and has the
/// energy
///   |D| |g|^2 + |D_l| |D_r| / |D| jump^2,   g the diamond's gradient.
/// The second term is stiffness * (left u_l + right u_r - sum of base[i] u_i)^2.
///
/// \tparam kBase  number of the base's vertices: the dimension
template <std::size_t kBase>
struct DiamondCrossing {
  double left, right;
  std::array<double, kBase> base;
  double stiffness;      ///< 0 where a half has no measure: there is no jump then
  double left_fraction;  ///< |D_l| / |D|; outside [0, 1] where a tip is on the wrong side
};

/// \param length2     squared hinge length  [length^2]
/// \param left,right  the two virtual triangles, both present, not both degenerate
/// \param eps_rel     a half with |D_l| <= eps_rel |D| has no jump
/// Cost: O(1), no allocation. Thread-safe.
inline DiamondCrossing<2> diamond_crossing(double length2, VirtualTriangle left,
                                           VirtualTriangle right, double eps_rel) {
  const double sum = left.double_area + right.double_area;
  const double l = left.double_area / sum, r = right.double_area / sum;
  const double foot = r * left.foot + l * right.foot;
  const bool jumps = l > eps_rel && r > eps_rel;
  return {r, l, {1 - foot, foot}, jumps ? length2 / (2 * sum * l * r) : 0.0, l};
}

/// The same of a minimal diamond that is not degenerate.
/// \param x1,x2,xf,xl,xr  as in diamond_3d
inline DiamondCrossing<3> diamond_crossing(const Diamond3d& diamond, const Vec3& x1, const Vec3& x2,
                                           const Vec3& xf, const Vec3& xl, const Vec3& xr,
                                           double eps_rel) {
  const double l = diamond.w.dot(x1 - xl) / diamond.determinant;
  const double r = 1 - l;
  const Vec3 q = r * xl + l * xr - x1;
  const double w2 = diamond.w.squaredNorm();
  const double at_2 = q.cross(xf - x1).dot(diamond.w) / w2;
  const double at_f = (x2 - x1).cross(q).dot(diamond.w) / w2;
  const bool jumps = l > eps_rel && r > eps_rel;
  // |D_l| |D_r| / |D| (1/h_l + 1/h_r)^2 with h = l det / |w|
  return {
      r, l, {1 - at_2 - at_f, at_2, at_f}, jumps ? w2 / (6 * diamond.determinant * l * r) : 0.0, l};
}

/// Masses of a diamond's vertices as fractions of its measure: they sum to one.
template <std::size_t kBase>
struct DiamondMass {
  std::array<double, kBase> base;
  double left, right;
};

/// Masses that meet the diamond's first moment: linear functions are integrated exactly. Two
/// splits of the diamond into simplices do: at its base (tau = 0) and about its axis from tip to
/// tip (tau = 1); tau is between them. Where that makes a mass negative, the nearest tau that does
/// not serves; where there is none, equal masses do.
/// Cost: O(1), no allocation. Thread-safe.
template <std::size_t kBase>
DiamondMass<kBase> moment_exact_mass(const DiamondCrossing<kBase>& crossing, double tau) {
  constexpr double kShare = 1.0 / (kBase + 1);
  // Fractions kShare (1 - tau base_i) and kShare (tau + (1 - tau) l), kShare (tau + (1 - tau) r).
  const double most =
      1 / std::max(1.0, *std::max_element(crossing.base.begin(), crossing.base.end()));
  const double smaller = std::min(crossing.left_fraction, 1 - crossing.left_fraction);
  const double least = smaller < 0 ? -smaller / (1 - smaller) : 0.0;
  DiamondMass<kBase> mass;
  if (least > most) {
    mass.base.fill(1.0 / (kBase + 2));
    mass.left = mass.right = 1.0 / (kBase + 2);
    return mass;
  }
  const double t = std::clamp(tau, least, most);
  for (std::size_t i = 0; i < kBase; ++i)
    mass.base[i] = std::max(0.0, kShare * (1 - t * crossing.base[i]));
  mass.left = std::max(0.0, kShare * (t + (1 - t) * crossing.left_fraction));
  mass.right = std::max(0.0, kShare * (t + (1 - t) * (1 - crossing.left_fraction)));
  return mass;
}

}  // namespace carat
