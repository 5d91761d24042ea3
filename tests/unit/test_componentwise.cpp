#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/componentwise.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

/// M + t S with t = h^2 on a unit grid.
SparseMatrix diffusion(Index columns, Index rows) {
  const Discretization d = discretize(quad_grid(columns, rows));
  return d.mass + d.stiffness;
}

double worst_relative(const Vector& x, const Vector& reference) {
  return (x - reference).cwiseQuotient(reference).cwiseAbs().maxCoeff();
}

TEST(Componentwise, tiny_components_are_as_accurate_as_large_ones) {
  const SparseMatrix a = diffusion(150, 4);
  Matrix b = Matrix::Zero(a.rows(), 1);
  b(0, 0) = 1e250;
  SolveReport report;
  const Vector x = solve_componentwise(a, {}, b, 1, report);
  const Vector reference = Cholesky(a).solve(b);
  // It decays by far more than the range of the squares of double precision allows.
  EXPECT_LT(reference.cwiseAbs().minCoeff(), 1e-60 * reference.maxCoeff());
  EXPECT_LT(worst_relative(x, reference), 1e-8);
  EXPECT_GT(report.iterations, 150);
  EXPECT_LT(report.iterations, 400);
  EXPECT_LE(report.residual, 1e-10);
}

TEST(Componentwise, covers_the_range_of_double_precision_below_and_above_one) {
  const SparseMatrix a = diffusion(1500, 1);
  Matrix b = Matrix::Zero(a.rows(), 1);
  b(0, 0) = 1e250;
  SolveReport report;
  const Vector x = solve_componentwise(a, {}, b, 1, report);
  const Vector reference = Cholesky(a).solve(b);
  EXPECT_LT(reference.cwiseAbs().minCoeff(), 1e-300);
  Index compared = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (std::abs(reference[i]) < 1e-280) continue;
    ++compared;
    EXPECT_NEAR(x[i] / reference[i], 1, 1e-7) << i;
  }
  EXPECT_GT(compared, 2000);
}

/// M + h^2 S and the heat of vertex 0 on a strip whose sides have the length h.
struct Strip {
  SparseMatrix a;
  Matrix b;

  explicit Strip(double h) {
    const PolygonMesh unit = quad_grid(1500, 1);
    const Discretization d = discretize(PolygonMesh(h * unit.points(), unit.faces()));
    a = d.mass + h * h * d.stiffness;
    b = Matrix::Zero(a.rows(), 1);
    b(0, 0) = 1e250 * a.coeff(0, 0);
  }
};

TEST(Componentwise, units_change_nothing) {
  SolveReport report;
  const Strip strip(1);
  const Matrix x = solve_componentwise(strip.a, {}, strip.b, 1, report);
  ASSERT_LT(x.cwiseAbs().minCoeff(), 1e-290);  // every bound matters
  for (const int exponent : {-60, -20, 20, 60}) {
    const Strip other(std::ldexp(1.0, exponent));
    SolveReport own;
    EXPECT_EQ((solve_componentwise(other.a, {}, other.b, 1, own) - x).cwiseAbs().maxCoeff(), 0)
        << exponent;
    EXPECT_EQ(own.iterations, report.iterations);
  }
  for (const double h : {1e-18, 1e-6, 1e6, 1e18}) {
    const Strip other(h);
    const Matrix y = solve_componentwise(other.a, {}, other.b, 1, report);
    for (Index i = 0; i < x.size(); ++i) {
      if (std::abs(x(i)) < 1e-280) continue;
      EXPECT_NEAR(y(i) / x(i), 1, 1e-7) << h << " " << i;
    }
  }
}

TEST(Componentwise, columns_and_threads_change_no_bit) {
  const SparseMatrix a = diffusion(90, 60);
  Matrix b = Matrix::Zero(a.rows(), 13);
  for (Index k = 0; k < 12; ++k) b(400 * k, k) = std::pow(10.0, 10 * k);
  SolveReport report;
  const Matrix x = solve_componentwise(a, {}, b, 1, report);
  EXPECT_EQ(solve_componentwise(a, {}, b, 3, report), x);
  for (const Index k : {0, 7, 9, 11, 12})
    EXPECT_EQ(solve_componentwise(a, {}, b.col(k), 2, report), x.col(k)) << k;
  EXPECT_EQ(x.col(12).norm(), 0);
}

TEST(Componentwise, fixed_rows_are_held_at_zero) {
  const SparseMatrix a = diffusion(12, 9);
  std::vector<bool> fixed(static_cast<std::size_t>(a.rows()), false);
  fixed[0] = fixed[17] = true;
  const Matrix b = Matrix::Random(a.rows(), 5);
  SolveReport report;
  const Matrix x = solve_componentwise(a, fixed, b, 1, report);
  const Matrix reference = Cholesky(a, fixed).solve(b);
  EXPECT_LT((x - reference).norm(), 1e-9 * reference.norm());
  EXPECT_EQ(x.row(17).norm(), 0);
}

TEST(Componentwise, what_cannot_be_solved_is_an_error) {
  SolveReport report;
  SparseMatrix a = diffusion(5, 5);
  Matrix b = Matrix::Ones(a.rows(), 1);
  b(3, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solve_componentwise(a, {}, b, 1, report), SolverFailure);
  b(3, 0) = 1;
  SparseMatrix indefinite = a - 3 * SparseMatrix(discretize(quad_grid(5, 5)).mass);
  EXPECT_THROW(solve_componentwise(indefinite, {}, b, 1, report), SolverFailure);
  a.coeffRef(7, 7) = -1;
  EXPECT_THROW(solve_componentwise(a, {}, b, 1, report), SolverFailure);
}

}  // namespace
}  // namespace carat::test
