// One diamond: the gradient in its equivalent forms (7)-(9), (13), its area, its energy, and the
// boundary case; then whole meshes: unfolding makes the operator intrinsic.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <random>

#include "carat/kernels/diamond_2d.h"
#include "carat/operators/registry.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

/// A diamond in space with its hinge coordinates, written out as in (10)-(12).
struct Hinge {
  Vec3 x1, x2, xl, xr;
  // Corners in the order 1, r, 2, l: counter-clockwise.
  std::array<Vec2, 4> flat() const {
    const Vec3 u = (x2 - x1).normalized();
    const Vec3 vl = (xl - x1) - u * u.dot(xl - x1);
    const Vec3 vr = (x1 - xr) - u * u.dot(x1 - xr);
    // On the hinge itself (boundary) only rounding is left of vr, and it has no direction.
    const Vec3 right = vr.norm() > 1e-12 * (x2 - x1).norm() ? vr.normalized() : Vec3(0, 0, 0);
    return {Vec2(0, 0), Vec2(u.dot(xr - x1), right.dot(xr - x1)), Vec2((x2 - x1).norm(), 0),
            Vec2(u.dot(xl - x1), vl.normalized().dot(xl - x1))};
  }
  double shoelace() const {
    const auto p = flat();
    double sum = 0;
    for (int k = 0; k < 4; ++k)
      sum += p[k].x() * p[(k + 1) % 4].y() - p[k].y() * p[(k + 1) % 4].x();
    return sum / 2;
  }
  /// (13), columns in the order 1, 2, l, r; e^perp is the edge turned clockwise: outwards.
  Eigen::Matrix<double, 2, 4> literal_gradient() const {
    const auto p = flat();
    Eigen::Matrix<double, 2, 4> g;
    constexpr int column[] = {0, 3, 1, 2};
    for (int k = 0; k < 4; ++k) {
      const Vec2 next = p[(k + 1) % 4] - p[k], previous = p[k] - p[(k + 3) % 4];
      g.col(column[k]) =
          (Vec2(next.y(), -next.x()) + Vec2(previous.y(), -previous.x())) / (2 * shoelace());
    }
    return g;
  }
};

class DiamondGeometry : public testing::Test {
 protected:
  /// Diamonds of random shape, with both triangles of positive area.
  std::vector<Hinge> samples() {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> number(-1, 1);
    const auto point = [&] { return Vec3(number(random), number(random), number(random)); };
    std::vector<Hinge> hinges;
    for (int k = 0; k < 200; ++k) hinges.push_back({point(), point(), point(), point()});
    return hinges;
  }
  static Eigen::Matrix<double, 2, 4> gradient(const Hinge& h) {
    return diamond_gradient(h.x1, h.x2, h.xl, h.xr);
  }
  static VirtualTriangle triangle(const Hinge& h, const Vec3& tip) {
    const Vec3 e = h.x2 - h.x1;
    return {e.dot(tip - h.x1) / e.squaredNorm(), e.cross(tip - h.x1).norm()};
  }
  static Diamond2d diamond(const Hinge& h) {
    return diamond_2d((h.x2 - h.x1).squaredNorm(), triangle(h, h.xl), triangle(h, h.xr), 1e-14);
  }
  /// Rounding of relative size eps, magnified by the squared size over the area.
  static double rounding(const Hinge& h) {
    const auto p = h.flat();
    double size = 0;
    for (const Vec2& a : p)
      for (const Vec2& b : p) size = std::max(size, (a - b).squaredNorm());
    return 50 * kEps * size / h.shoelace();
  }
  static double tolerance(const Hinge& h) {
    return rounding(h) * gradient(h).cwiseAbs().maxCoeff();
  }
};

TEST_F(DiamondGeometry, gradient_is_equation_13) {
  for (const Hinge& h : samples())
    EXPECT_LT((gradient(h) - h.literal_gradient()).cwiseAbs().maxCoeff(), tolerance(h));
}

TEST_F(DiamondGeometry, gradient_is_the_mean_over_the_boundary_7) {
  const Eigen::Vector4d u(0.3, -1.2, 0.8, 2.1);  // at 1, 2, l, r
  constexpr int value[] = {0, 3, 1, 2};
  for (const Hinge& h : samples()) {
    const auto p = h.flat();
    Vec2 integral = Vec2::Zero();  // (6)
    for (int k = 0; k < 4; ++k) {
      const Vec2 e = p[(k + 1) % 4] - p[k];
      integral += Vec2(e.y(), -e.x()) * (u[value[k]] + u[value[(k + 1) % 4]]) / 2;
    }
    EXPECT_LT((gradient(h) * u - integral / h.shoelace()).norm(), 10 * tolerance(h));
  }
}

TEST_F(DiamondGeometry, gradient_reproduces_both_differences_8) {
  const Eigen::Vector4d u(0.3, -1.2, 0.8, 2.1);
  for (const Hinge& h : samples()) {
    const auto p = h.flat();
    const Vec2 g = gradient(h) * u;
    const double size = g.norm() * (1 + (p[3] - p[1]).norm());
    EXPECT_NEAR(g.dot(p[2] - p[0]), u[1] - u[0], 100 * kEps * size);
    EXPECT_NEAR(g.dot(p[3] - p[1]), u[2] - u[3], 100 * kEps * size);
  }
}

TEST_F(DiamondGeometry, gradient_from_the_two_axes_9) {
  // Both axes turned counter-clockwise; the second difference then is u_2 - u_1.
  const Eigen::Vector4d u(0.3, -1.2, 0.8, 2.1);
  const auto turned = [](const Vec2& x) { return Vec2(-x.y(), x.x()).normalized(); };
  for (const Hinge& h : samples()) {
    const auto p = h.flat();
    const Vec2 hinge = p[2] - p[0], axis = p[1] - p[3];
    const Vec2 v = turned(hinge), v_star = turned(axis);
    const double sine =
        (hinge.x() * (-axis.y()) - hinge.y() * (-axis.x())) / (hinge.norm() * axis.norm());
    const Vec2 expected =
        ((u[2] - u[3]) / axis.norm() * v + (u[1] - u[0]) / hinge.norm() * v_star) / sine;
    EXPECT_LT((gradient(h) * u - expected).norm(), 10 * tolerance(h));
  }
}

TEST_F(DiamondGeometry, area_and_energy_are_those_of_the_flat_diamond_21) {
  for (const Hinge& h : samples()) {
    const Diamond2d d = diamond(h);
    EXPECT_NEAR(d.area, h.shoelace(), rounding(h) * h.shoelace());
    const Eigen::Matrix4d energy = d.area * gradient(h).transpose() * gradient(h);
    Eigen::Matrix<double, 2, 4> differences;
    differences << -1, 1, 0, 0, 0, 0, 1, -1;
    Eigen::Matrix2d form;
    form << d.alpha, -d.beta, -d.beta, d.gamma;
    const Eigen::Matrix4d from_form = differences.transpose() * form * differences;
    EXPECT_LT((energy - from_form).cwiseAbs().maxCoeff(),
              rounding(h) * energy.cwiseAbs().maxCoeff());
    EXPECT_NEAR(d.alpha * d.gamma - d.beta * d.beta, 0.25,
                20 * kEps * (d.alpha * d.gamma + d.beta * d.beta));
  }
}

TEST_F(DiamondGeometry, boundary_diamond_is_the_linear_element_of_its_triangle_7) {
  for (Hinge h : samples()) {
    h.xr = (h.x1 + h.x2) / 2;
    const Eigen::Matrix<double, 2, 4> g = gradient(h);
    Eigen::Matrix<double, 2, 3> boundary = g.leftCols(3);
    boundary.col(0) += g.col(3) / 2;
    boundary.col(1) += g.col(3) / 2;
    // Gradient of the linear interpolant at the flat corners 1, 2, l.
    const auto p = h.flat();
    Eigen::Matrix2d edges;
    edges << (p[2] - p[0]).transpose(), (p[3] - p[0]).transpose();
    Eigen::Matrix<double, 2, 3> differences;
    differences << -1, 1, 0, -1, 0, 1;
    EXPECT_LT((boundary - edges.inverse() * differences).cwiseAbs().maxCoeff(), 10 * tolerance(h));
    EXPECT_NEAR(
        diamond_2d((h.x2 - h.x1).squaredNorm(), triangle(h, h.xl), kHingeMidpoint, 1e-14).area,
        (h.x2 - h.x1).cross(h.xl - h.x1).norm() / 2, 1e-14);
  }
}

TEST_F(DiamondGeometry, degenerate_diamonds_give_zeros) {
  const VirtualTriangle flat{0.4, 0}, sound{0.4, 1};
  for (const Diamond2d& d :
       {diamond_2d(1, flat, flat, 1e-14), diamond_2d(0, sound, sound, 1e-14),
        diamond_2d(1, {1e9, 1}, flat, 1e-14), diamond_2d(1, flat, kHingeMidpoint, 1e-14)}) {
    EXPECT_EQ(d.area, 0);
    EXPECT_EQ(d.alpha, 0);
    EXPECT_EQ(d.beta, 0);
    EXPECT_EQ(d.gamma, 0);
  }
  EXPECT_GT(diamond_2d(1, sound, flat, 1e-14).area, 0) << "one flat side is no reason to drop it";
}

TEST(Intrinsic, bending_a_flat_strip_along_its_edges_changes_nothing) {
  const PolygonMesh flat = quad_grid(6, 3);
  Points bent = flat.points();
  // Columns of squares turned against each other about their common sides.
  const double turns[] = {0.3, -0.9, 1.4, 0.2, 2.0};
  for (Index j = 0; j <= 3; ++j) {
    Vec3 x(0, j, 0);
    double angle = 0.1;
    for (Index i = 0; i <= 6; ++i) {
      bent.row(j * 7 + i) = x.transpose();
      x += Vec3(std::cos(angle), 0, std::sin(angle));
      if (i < 5) angle += turns[i];
    }
  }
  for (const char* name : {"diamond", "bunge"}) {
    const Discretization a = discretize(flat, name), b = discretize(flat.with_points(bent), name);
    EXPECT_LT(difference(b.stiffness, a.stiffness), 100 * kEps) << name;
    EXPECT_LT(difference(b.mass, a.mass), 100 * kEps) << name;
  }
  EXPECT_LT(difference(discretize(flat.with_points(bent)).gradient, discretize(flat).gradient),
            100 * kEps);
}

}  // namespace
}  // namespace carat::test
