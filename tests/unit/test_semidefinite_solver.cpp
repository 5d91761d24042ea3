#include <gtest/gtest.h>

#include <memory>

#include "carat/operators/registry.h"
#include "carat/solve/semidefinite_solver.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

TEST(SemidefiniteSolver, works_in_the_complement_of_constants_of_each_component) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const Discretization d = discretize(mesh);
  const SemidefiniteSolver solver(d.stiffness);
  EXPECT_EQ(solver.n_components(), 2);
  EXPECT_EQ(solver.components(), (std::vector<Index>{0, 0, 0, -1, -1, 1, 1, 1, 1}));
  Vector rhs = Vector::Zero(9);
  rhs << 1, -2, 1, 5, 5, 3, -1, -1, -1;
  const Vector u = solver.solve(rhs);
  rhs[3] = rhs[4] = 0;
  EXPECT_LT((d.stiffness * u - rhs).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_NEAR(u.head(3).sum(), 0, 1e-14);
  EXPECT_NEAR(u.tail(4).sum(), 0, 1e-14);
  EXPECT_EQ(u[3], 0);
  EXPECT_NEAR(solver.imbalance(rhs), 0, 1e-15);
  rhs[5] += 6;
  EXPECT_NEAR(solver.imbalance(rhs), 6.0 / 12, 1e-15);
}

TEST(SemidefiniteSolver, an_iteration_gives_what_a_factorisation_gives) {
  const Discretization d = discretize(quad_grid(30, 20));
  const auto stiffness = std::make_shared<SparseMatrix>(d.stiffness);
  const SemidefiniteSolver by_factor(*stiffness);
  const SemidefiniteSolver by_iteration(stiffness, {.kind = SolverKind::Multigrid});
  EXPECT_EQ(by_factor.info().kind, SolverKind::Cholesky);
  EXPECT_EQ(by_iteration.info().kind, SolverKind::Multigrid);
  const Matrix rhs = Matrix::Random(stiffness->rows(), 3);
  const Matrix u = by_factor.solve(rhs);
  EXPECT_LT((by_iteration.solve(rhs) - u).norm(), 1e-9 * u.norm());
}

}  // namespace
}  // namespace carat::test
