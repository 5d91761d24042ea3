#pragma once
// Franke's test function on the unit square and the unit cube, and its Laplacian by differentiating
// each term c e^q: c e^q (|grad q|^2 + laplacian q).

#include <cmath>

#include "carat/base/types.h"

namespace carat::measures {

/// One term: q = -a (9x - x0)^2 - b (9y - y0)^2 - d (9y - y0).
struct FrankeTerm {
  double factor, a, x0, b, y0, d;
};

inline constexpr FrankeTerm kFrankeTerms[] = {{0.75, 0.25, 2, 0.25, 2, 0},
                                              {0.75, 1.0 / 49, -1, 0, -1, 0.1},
                                              {0.5, 0.25, 7, 0.25, 3, 0},
                                              {-0.2, 1, 4, 1, 7, 0}};

inline double franke(const Vec3& p) {
  double sum = 0;
  for (const FrankeTerm& t : kFrankeTerms) {
    const double x = 9 * p.x() - t.x0, y = 9 * p.y() - t.y0;
    sum += t.factor * std::exp(-t.a * x * x - t.b * y * y - t.d * y);
  }
  return sum;
}

inline double franke_laplacian(const Vec3& p) {
  double sum = 0;
  for (const FrankeTerm& t : kFrankeTerms) {
    const double x = 9 * p.x() - t.x0, y = 9 * p.y() - t.y0;
    const double qx = -18 * t.a * x, qy = -18 * t.b * y - 9 * t.d;
    const double laplacian_q = -162 * (t.a + t.b);
    sum += t.factor * std::exp(-t.a * x * x - t.b * y * y - t.d * y) *
           (qx * qx + qy * qy + laplacian_q);
  }
  return sum;
}

/// One term in space: q = -a |9p - p0|^2, or with d: -x^2 / 49 - d (y + z), (x, y, z) = 9p - p0.
struct FrankeTerm3d {
  double factor, ax, ayz, d;
  double p0[3];
};

inline constexpr FrankeTerm3d kFrankeTerms3d[] = {{0.75, 0.25, 0.25, 0, {2, 2, 2}},
                                                  {0.75, 1.0 / 49, 0, 0.1, {-1, -1, -1}},
                                                  {0.5, 0.25, 0.25, 0, {7, 3, 5}},
                                                  {-0.2, 1, 1, 0, {4, 7, 5}}};

/// Calls visit(c e^q, |grad q|^2 + laplacian q) for every term.
template <class Visit>
void for_franke_terms_3d(const Vec3& p, const Visit& visit) {
  for (const FrankeTerm3d& t : kFrankeTerms3d) {
    const double x = 9 * p.x() - t.p0[0], y = 9 * p.y() - t.p0[1], z = 9 * p.z() - t.p0[2];
    const double value =
        t.factor * std::exp(-t.ax * x * x - t.ayz * (y * y + z * z) - t.d * (y + z));
    const Vec3 gradient = -9 * Vec3(2 * t.ax * x, 2 * t.ayz * y + t.d, 2 * t.ayz * z + t.d);
    visit(value, gradient.squaredNorm() - 162 * (t.ax + 2 * t.ayz));
  }
}

inline double franke_3d(const Vec3& p) {
  double sum = 0;
  for_franke_terms_3d(p, [&](double value, double) { sum += value; });
  return sum;
}

inline double franke_3d_laplacian(const Vec3& p) {
  double sum = 0;
  for_franke_terms_3d(p, [&](double value, double factor) { sum += value * factor; });
  return sum;
}

}  // namespace carat::measures
