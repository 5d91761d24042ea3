#include <gtest/gtest.h>

#include <random>

#include "carat/kernels/diamond_2d.h"
#include "carat/kernels/diamond_split.h"
#include "carat/kernels/triangle_diamond_block.h"

namespace carat {
namespace {

VirtualTriangle half(const Vec3& x1, const Vec3& x2, const Vec3& opposite) {
  const Vec3 e = x2 - x1, d = (e + (opposite - x1)) / 3;
  return {e.dot(d) / e.squaredNorm(), e.cross(d).norm()};
}

TEST(TriangleDiamondBlock, equals_the_diamond_of_two_virtual_triangles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  TriangleDiamondBlock block;
  for (int k = 0; k < kBlockDiamonds; ++k) {
    block.inner[k] = k % 5 == 0 ? 0.0 : 1.0;
    for (auto& vertex : block.x)
      for (auto& coordinate : vertex) coordinate[k] = uniform(random);
  }
  triangle_diamond_block(block, 1e-14);
  for (int k = 0; k < kBlockDiamonds; ++k) {
    const auto point = [&](int i) {
      return Vec3(block.x[i][0][k], block.x[i][1][k], block.x[i][2][k]);
    };
    const Vec3 x1 = point(0), x2 = point(1);
    const Diamond2d expected =
        diamond_2d((x2 - x1).squaredNorm(), half(x1, x2, point(2)),
                   block.inner[k] > 0 ? half(x1, x2, point(3)) : kHingeMidpoint, 1e-14);
    const double tolerance = 1e-13 * (1 + expected.alpha + expected.gamma);
    EXPECT_NEAR(block.alpha[k], expected.alpha, tolerance);
    EXPECT_NEAR(block.beta[k], expected.beta, tolerance);
    EXPECT_NEAR(block.gamma[k], expected.gamma, tolerance);
    EXPECT_NEAR(block.area[k], expected.area, 1e-14);
    EXPECT_EQ(block.thin[k], 0);
  }
}

TEST(TriangleDiamondBlock, diagonals_cross_as_in_the_diamond_of_two_virtual_triangles) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  TriangleDiamondBlock block, plain;
  for (int k = 0; k < kBlockDiamonds; ++k) {
    block.inner[k] = k % 5 == 0 ? 0.0 : 1.0;
    for (auto& vertex : block.x)
      for (auto& coordinate : vertex) coordinate[k] = uniform(random);
  }
  for (int i = 0; i < 3; ++i) block.x[3][i][1] = block.x[0][i][1];  // no half to the right
  plain = block;
  TriangleCrossingBlock crossing;
  triangle_diamond_block(plain, 1e-14);
  triangle_diamond_block(block, 1e-14, crossing);
  for (int k = 0; k < kBlockDiamonds; ++k) {
    EXPECT_EQ(block.alpha[k], plain.alpha[k]);
    EXPECT_EQ(block.area[k], plain.area[k]);
    if (!(block.inner[k] > 0)) {
      EXPECT_EQ(crossing.stiffness[k], 0);
      continue;
    }
    const auto point = [&](int i) {
      return Vec3(block.x[i][0][k], block.x[i][1][k], block.x[i][2][k]);
    };
    const Vec3 x1 = point(0), x2 = point(1);
    const DiamondCrossing<2> expected = diamond_crossing(
        (x2 - x1).squaredNorm(), half(x1, x2, point(2)), half(x1, x2, point(3)), 1e-14);
    EXPECT_NEAR(crossing.left_fraction[k], expected.left_fraction, 1e-14);
    EXPECT_NEAR(crossing.right_fraction[k], 1 - expected.left_fraction, 1e-14);
    EXPECT_NEAR(crossing.foot[k], expected.base[1], 1e-13 * (1 + std::abs(expected.base[1])));
    EXPECT_NEAR(crossing.stiffness[k], expected.stiffness, 1e-12 * expected.stiffness);
    EXPECT_EQ(crossing.stiffness[k] > 0, k != 1);
  }
}

TEST(TriangleDiamondBlock, degenerate_diamonds_are_zero_and_thin_triangles_flagged) {
  TriangleDiamondBlock block{};
  const auto set = [&](int k, double inner, double x2, double y_left, double y_right) {
    block.inner[k] = inner;
    block.x[1][0][k] = x2;
    block.x[2][0][k] = block.x[3][0][k] = 0.5;
    block.x[2][1][k] = y_left;
    block.x[3][1][k] = y_right;
  };
  set(0, 1, 1, 0, 0);       // no area
  set(1, 1, 0, 1, -1);      // no hinge
  set(2, 1, 1, 1, 0);       // one half only
  set(3, 1, 1, 1e-13, -1);  // thin on the left
  set(4, 0, 1, 1, 0);       // boundary: no triangle to the right that could be thin
  triangle_diamond_block(block, 1e-14);
  for (const int k : {0, 1}) {
    EXPECT_EQ(block.area[k], 0);
    EXPECT_EQ(block.alpha[k], 0);
    EXPECT_EQ(block.beta[k], 0);
    EXPECT_EQ(block.gamma[k], 0);
  }
  for (const int k : {0, 1, 2, 3}) EXPECT_EQ(block.thin[k], 1) << k;
  for (const int k : {2, 3, 4}) EXPECT_GT(block.area[k], 0.1) << k;
  EXPECT_EQ(block.thin[4], 0);
}

}  // namespace
}  // namespace carat
