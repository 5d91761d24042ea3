#include <gtest/gtest.h>

#include <cmath>

#include "carat/kernels/tetrahedron.h"

namespace carat {
namespace {

const Vec3 kCorners[4] = {{0.1, 0, 0}, {0.2, 0.9, -0.1}, {1.1, 0.1, 0.2}, {0.3, 0.2, 1.2}};

Tetrahedron some_tetrahedron() {
  return tetrahedron(kCorners[0], kCorners[1], kCorners[2], kCorners[3], 1e-14);
}

TEST(Tetrahedron, hats_are_linear_and_one_at_their_corner) {
  const Tetrahedron t = some_tetrahedron();
  ASSERT_GT(t.determinant, 0);
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const int other = (a + 1) % 4;  // where hat a is zero
      const double value = t.normal[a].dot(kCorners[b] - kCorners[other]) / t.determinant;
      EXPECT_NEAR(value, a == b ? 1 : 0, 1e-14);
    }
  const Vec3 e1 = kCorners[1] - kCorners[0], e2 = kCorners[2] - kCorners[0],
             e3 = kCorners[3] - kCorners[0];
  EXPECT_NEAR(t.volume(), std::abs(e1.cross(e2).dot(e3)) / 6, 1e-15);
}

TEST(Tetrahedron, couplings_are_lengths_times_cotangents) {
  // -1/6 of the opposite edge's length times the cotangent of the dihedral angle there.
  const Tetrahedron t = some_tetrahedron();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      int rest[2], n = 0;
      for (int k = 0; k < 4; ++k)
        if (k != i && k != j) rest[n++] = k;
      const Vec3 edge = kCorners[rest[1]] - kCorners[rest[0]];
      const Vec3 u = edge.normalized();
      const auto across = [&](int k) -> Vec3 {
        const Vec3 d = kCorners[k] - kCorners[rest[0]];
        return d - u * u.dot(d);
      };
      const Vec3 a = across(i), b = across(j);
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
      EXPECT_NEAR(t.coupling(i, j), -edge.norm() / std::tan(angle) / 6, 1e-15);
      EXPECT_NEAR(t.coupling(i, j, 3 * Eigen::Matrix3d::Identity()), 3 * t.coupling(i, j), 1e-15);
    }
}

TEST(Tetrahedron, flat_and_inverted_ones_have_no_determinant) {
  EXPECT_EQ(tetrahedron(kCorners[1], kCorners[0], kCorners[2], kCorners[3], 1e-14).determinant, 0);
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const Vec3 a(0, 0, 0), b(0, scale, 0), c(scale, 0, 0);
    const auto with_height = [&](double h) {
      return tetrahedron(a, b, c, Vec3(0.3 * scale, 0.3 * scale, h * scale), 1e-14).determinant;
    };
    EXPECT_EQ(with_height(0), 0);
    EXPECT_EQ(with_height(1e-14), 0);
    EXPECT_GT(with_height(1e-12), 0);
  }
}

}  // namespace
}  // namespace carat
