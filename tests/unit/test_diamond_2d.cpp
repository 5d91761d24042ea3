#include <gtest/gtest.h>

#include "carat/kernels/cotan.h"
#include "carat/kernels/diamond_2d.h"

namespace carat {
namespace {

TEST(Diamond2d, the_square_on_its_diagonals) {
  // Hinge of length 2, tips at height 1 over its middle: area 2, orthogonal axes.
  const Diamond2d d = diamond_2d(4, {0.5, 2}, {0.5, 2}, 1e-14);
  EXPECT_DOUBLE_EQ(d.area, 2);
  EXPECT_DOUBLE_EQ(d.alpha, 0.5);
  EXPECT_DOUBLE_EQ(d.beta, 0);
  EXPECT_DOUBLE_EQ(d.gamma, 0.5);
}

TEST(Diamond2d, a_sheared_diamond) {
  // Hinge (0,0)-(1,0), l = (1,1), r = (0,-1): axes (1,0) and (1,2), area 1.
  const Diamond2d d = diamond_2d(1, {1, 1}, {0, 1}, 1e-14);
  EXPECT_DOUBLE_EQ(d.area, 1);
  EXPECT_DOUBLE_EQ(d.shear, 1);
  EXPECT_DOUBLE_EQ(d.gamma, 0.25);
  EXPECT_DOUBLE_EQ(d.beta, 0.25);
  EXPECT_DOUBLE_EQ(d.alpha, 1.25);
}

TEST(Diamond2d, gradient_of_a_folded_square) {
  // The right half is turned down by a right angle: the gradient is that of the flat square.
  const Eigen::Matrix<double, 2, 4> g =
      diamond_gradient(Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, -1));
  Eigen::Matrix<double, 2, 4> expected;
  expected << -0.5, 0.5, 0, 0, 0, 0, 0.5, -0.5;
  EXPECT_LT((g - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Diamond2d, degenerate_is_relative_to_the_size) {
  EXPECT_GT(diamond_2d(1e-20, {0.5, 1e-20}, {0.5, 1e-20}, 1e-14).area, 0);
  EXPECT_EQ(diamond_2d(1e20, {0.5, 1}, {0.5, 1}, 1e-14).area, 0);
  EXPECT_EQ(diamond_2d(0, {0.5, 1}, {0.5, 1}, 1e-14).area, 0);
}

TEST(Cotan, of_the_half_square) {
  // Right angle at x1, 45 degrees at the others; legs of length 1.
  const TriangleCotangents cot = triangle_cotangents(1, {0, 1});
  EXPECT_NEAR(cot.at_first, 0, 1e-15);
  EXPECT_NEAR(cot.at_second, 1, 1e-15);
  EXPECT_NEAR(cot.at_tip, 1, 1e-15);
}

TEST(Cotan, hat_gradients_are_dual_to_the_edges) {
  const Vec3 x1(0.1, 0.2, 0.3), x2(1.4, -0.3, 0.8), x3(0.2, 1.1, -0.4);
  const Eigen::Matrix3d g = hat_gradients(x1, x2, x3);
  Eigen::Matrix3d expected;
  expected << -1, 1, 0, -1, 0, 1, 0, 0, 0;
  Eigen::Matrix3d edges;
  edges << (x2 - x1).transpose(), (x3 - x1).transpose(), (x2 - x1).cross(x3 - x1).transpose();
  EXPECT_LT((edges * g - expected).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace carat
