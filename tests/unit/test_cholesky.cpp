#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

SparseMatrix spd() {
  const Discretization d = discretize(quad_grid(7, 5));
  return d.stiffness + d.mass;
}

TEST(Cholesky, solves_many_right_hand_sides) {
  const SparseMatrix a = spd();
  const Matrix x = Matrix::Random(a.rows(), 4);
  EXPECT_LT((Cholesky(a).solve(a * x) - x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Cholesky, fixed_rows_are_held_at_zero) {
  const SparseMatrix a = spd();
  std::vector<bool> fixed(static_cast<std::size_t>(a.rows()), false);
  fixed[0] = fixed[17] = true;
  Vector x = Vector::LinSpaced(a.rows(), 1, 2);
  x[0] = x[17] = 0;
  Vector rhs = a * x;
  rhs[0] = 1e6;  // ignored
  const Vector solution = Cholesky(a, fixed).solve(rhs);
  EXPECT_LT((solution - x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(solution[0], 0);
  EXPECT_EQ(Cholesky(a, std::vector<bool>(fixed.size(), true)).solve(rhs).cwiseAbs().maxCoeff(), 0);
}

TEST(Cholesky, refactor_takes_new_values) {
  const SparseMatrix a = spd();
  Cholesky solver(a);
  const Vector x = Vector::LinSpaced(a.rows(), -1, 1);
  solver.refactor(SparseMatrix(3 * a));
  EXPECT_LT((solver.solve(3 * (a * x)) - x).cwiseAbs().maxCoeff(), 1e-12);
  SparseMatrix other(a.rows(), a.cols());
  other.setIdentity();
  EXPECT_THROW(solver.refactor(other), InvalidOption);
}

TEST(Cholesky, a_failing_pivot_is_named) {
  SparseMatrix a = spd();
  a.coeffRef(20, 20) = -1;
  try {
    Cholesky solver(a);
    FAIL() << "nothing was thrown";
  } catch (const SolverFailure& e) {
    EXPECT_NE(std::string(e.what()).find("not positive definite"), std::string::npos);
    EXPECT_EQ(e.elements(), std::vector<Index>{20});  // the rows before it have sound pivots
  }
  EXPECT_THROW(Cholesky(SparseMatrix(-spd())), SolverFailure);
}

TEST(Cholesky, wrong_sizes_and_values_are_refused) {
  const SparseMatrix a = spd();
  EXPECT_THROW(Cholesky(SparseMatrix(a.topRows(5))), InvalidOption);
  EXPECT_THROW(Cholesky(a, std::vector<bool>(3)), InvalidOption);
  const Cholesky solver(a);
  EXPECT_THROW(solver.solve(Vector::Zero(3)), InvalidOption);
  Vector rhs = Vector::Zero(a.rows());
  rhs[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solver.solve(rhs), SolverFailure);
}

TEST(MatrixComponents, explicit_zeros_do_not_connect) {
  SparseMatrix a(3, 3);
  a.insert(0, 0) = 1;
  a.insert(0, 1) = 0;
  a.insert(1, 1) = 1;
  EXPECT_EQ(matrix_components(a), (std::vector<Index>{0, 1, -1}));
}

TEST(MatrixComponents, rows_are_joined_by_entries_below_the_diagonal) {
  SparseMatrix a(7, 7);  // 0-4-2, 1-6, 3, and 5 empty; joined last to first
  a.insert(2, 2) = 1;
  a.insert(3, 3) = 1;
  a.insert(4, 2) = -1;
  a.insert(4, 0) = -1;
  a.insert(6, 1) = -1;
  EXPECT_EQ(matrix_components(a), (std::vector<Index>{0, 1, 0, 2, 0, -1, 1}));
}

}  // namespace
}  // namespace carat::test
