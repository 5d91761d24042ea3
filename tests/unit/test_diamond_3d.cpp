#include <gtest/gtest.h>

#include "carat/kernels/diamond_3d.h"

namespace carat::test {
namespace {

// Counter-clockwise seen from xr.
const Vec3 kX1(0.1, 0, 0.2), kX2(1.2, 0.1, 0), kXf(0.4, 0.9, 0.1), kXl(0.5, 0.2, -0.8),
    kXr(0.6, 0.4, 1.1);

double tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).dot((c - a).cross(d - a)) / 6;
}

TEST(Diamond3d, volume_is_the_sum_of_both_tetrahedra) {
  const Diamond3d d = diamond_3d(kX1, kX2, kXf, kXl, kXr, 1e-14);
  const double expected = tetrahedron(kX1, kX2, kXf, kXr) + tetrahedron(kX2, kX1, kXf, kXl);
  EXPECT_NEAR(d.volume(), expected, 1e-15);
}

TEST(Diamond3d, gradient_fits_the_differences) {
  const auto g = diamond_gradient(diamond_3d(kX1, kX2, kXf, kXl, kXr, 1e-14));
  EXPECT_LT((g * Eigen::Matrix<double, 5, 1>::Ones()).norm(), 1e-14);
  Eigen::Matrix<double, 5, 3> x;
  x << kX1.transpose(), kX2.transpose(), kXf.transpose(), kXl.transpose(), kXr.transpose();
  EXPECT_LT((g * x - Eigen::Matrix3d::Identity()).norm(), 1e-14) << "exact on linear functions";
  // [BBA21 (28)]: whatever the values, the fit has the values' differences along three directions.
  const Eigen::Matrix<double, 5, 1> u{0.3, -1.2, 0.7, 2.1, -0.4};
  const Vec3 fit = g * u;
  EXPECT_NEAR(fit.dot(kX2 - kX1), u[1] - u[0], 1e-14);
  EXPECT_NEAR(fit.dot(kXf - kX1), u[2] - u[0], 1e-14);
  EXPECT_NEAR(fit.dot(kXl - kXr), u[3] - u[4], 1e-14);
}

TEST(Diamond3d, gradient_is_the_sum_over_the_outer_triangles) {
  // [BBA21 (27)]: the gradient sums over the outer triangles of the diamond the mean of their
  // values times their outward vector area, over |D|.
  const Diamond3d d = diamond_3d(kX1, kX2, kXf, kXl, kXr, 1e-14);
  const Eigen::Matrix<double, 5, 1> u{0.3, -1.2, 0.7, 2.1, -0.4};
  const Vec3 base[3] = {kX1, kX2, kXf};
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    sum += (base[j] - base[i]).cross(kXr - base[i]) / 2 * (u[i] + u[j] + u[4]) / 3;
    sum -= (base[j] - base[i]).cross(kXl - base[i]) / 2 * (u[i] + u[j] + u[3]) / 3;
  }
  EXPECT_LT((sum / d.volume() - diamond_gradient(d) * u).norm(), 1e-14);
}

TEST(Diamond3d, on_the_boundary_it_is_the_gradient_of_the_tetrahedron) {
  const auto g = diamond_gradient(diamond_3d(kX1, kX2, kXf, kXl, kXf, 1e-14));
  Eigen::Matrix3d edges;
  edges << (kX2 - kX1).transpose(), (kXf - kX1).transpose(), (kXl - kX1).transpose();
  const Eigen::Vector4d u{0.3, -1.2, 0.7, 2.1};
  const Vec3 expected = edges.inverse() * Vec3(u[1] - u[0], u[2] - u[0], u[3] - u[0]);
  Eigen::Matrix<double, 5, 1> values;
  values << u, u[2];
  EXPECT_LT((g * values - expected).norm(), 1e-13);
}

TEST(Diamond3d, tells_degenerate_and_inverted_ones) {
  EXPECT_EQ(diamond_3d(kX1, kX2, kXf, kXr, kXl, 1e-14).determinant, 0) << "turned";
  EXPECT_EQ(diamond_3d(kX1, kX2, kX1 + 0.5 * (kX2 - kX1), kXl, kXr, 1e-14).determinant, 0);
  EXPECT_EQ(diamond_3d(kX1, kX1, kXf, kXl, kXr, 1e-14).determinant, 0);
  // Small is not degenerate.
  const double s = 1e-9;
  EXPECT_GT(diamond_3d(s * kX1, s * kX2, s * kXf, s * kXl, s * kXr, 1e-14).determinant, 0);
}

}  // namespace
}  // namespace carat::test
