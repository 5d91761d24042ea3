#pragma once
// Franke's test function on the unit square, and its Laplacian by differentiating each term
// c e^q: c e^q (|grad q|^2 + laplacian q).

#include <cmath>

#include "carat/base/types.h"

namespace carat::test {

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

}  // namespace carat::test
