#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <tuple>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/solve/conjugate_gradients.h"
#include "carat/solve/spd_solver.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

SparseMatrix spd() {
  const Discretization d = discretize(quad_grid(7, 5));
  return d.stiffness + d.mass;
}

TEST(SpdSolver, solves_many_right_hand_sides) {
  const SparseMatrix a = spd();
  const Matrix x = Matrix::Random(a.rows(), 4);
  EXPECT_LT((SpdSolver(a).solve(a * x) - x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SpdSolver, fixed_rows_are_held_at_zero) {
  const SparseMatrix a = spd();
  std::vector<bool> fixed(static_cast<std::size_t>(a.rows()), false);
  fixed[0] = fixed[17] = true;
  Vector x = Vector::LinSpaced(a.rows(), 1, 2);
  x[0] = x[17] = 0;
  Vector rhs = a * x;
  rhs[0] = 1e6;  // ignored
  const Vector solution = SpdSolver(a, fixed).solve(rhs);
  EXPECT_LT((solution - x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(solution[0], 0);
  EXPECT_EQ(SpdSolver(a, std::vector<bool>(fixed.size(), true)).solve(rhs).cwiseAbs().maxCoeff(),
            0);
}

TEST(SpdSolver, refactor_takes_new_values) {
  const SparseMatrix a = spd();
  SpdSolver solver(a);
  const Vector x = Vector::LinSpaced(a.rows(), -1, 1);
  solver.refactor(SparseMatrix(3 * a));
  EXPECT_LT((solver.solve(3 * (a * x)) - x).cwiseAbs().maxCoeff(), 1e-12);
  SparseMatrix other(a.rows(), a.cols());
  other.setIdentity();
  EXPECT_THROW(solver.refactor(other), InvalidOption);
}

TEST(SpdSolver, a_failing_pivot_is_named) {
  SparseMatrix a = spd();
  a.coeffRef(20, 20) = -1;
  try {
    SpdSolver solver(a);
    FAIL() << "nothing was thrown";
  } catch (const SolverFailure& e) {
    EXPECT_NE(std::string(e.what()).find("not positive definite"), std::string::npos);
    EXPECT_EQ(e.elements(), std::vector<Index>{20});  // the rows before it have sound pivots
  }
  EXPECT_THROW(SpdSolver(SparseMatrix(-spd())), SolverFailure);
}

TEST(SpdSolver, wrong_sizes_and_values_are_refused) {
  const SparseMatrix a = spd();
  EXPECT_THROW(SpdSolver(SparseMatrix(a.topRows(5))), InvalidOption);
  EXPECT_THROW(SpdSolver(a, std::vector<bool>(3)), InvalidOption);
  const SpdSolver solver(a);
  EXPECT_THROW(solver.solve(Vector::Zero(3)), InvalidOption);
  Vector rhs = Vector::Zero(a.rows());
  rhs[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solver.solve(rhs), SolverFailure);
}

TEST(ConjugateGradients, agree_with_the_factorisation) {
  const PolyhedralMesh mesh = generate_volume("cube-voronoi", {.level = 1, .jitter = 0.2});
  const Discretization d = discretize(mesh, "diamond");
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
  fixed[3] = fixed[40] = true;
  Matrix rhs = Matrix::Random(mesh.n_vertices(), 3);
  rhs.col(1).setZero();
  const Matrix direct = SpdSolver(d.stiffness, fixed).solve(rhs);
  const ConjugateGradients iterative(d.stiffness, fixed);
  const Matrix solution = iterative.solve(rhs);
  EXPECT_LT((solution - direct).norm(), 1e-9 * direct.norm());
  EXPECT_EQ(solution.col(1).norm(), 0);
  EXPECT_EQ(solution.row(40).norm(), 0);
  EXPECT_GT(iterative.info().nonzeros, 0);
}

TEST(ConjugateGradients, never_give_a_wrong_answer) {
  SparseMatrix a = spd();
  a.coeffRef(3, 3) = -1;
  EXPECT_THROW(ConjugateGradients{a}, SolverFailure);
  // Indefinite with a positive diagonal.
  SparseMatrix b(2, 2);
  b.insert(0, 0) = b.insert(1, 1) = 1;
  b.insert(0, 1) = b.insert(1, 0) = 2;
  b.makeCompressed();
  EXPECT_THROW(ConjugateGradients(b).solve(Vector{{1.0, -1.0}}), SolverFailure);
  EXPECT_THROW(ConjugateGradients(spd()).solve(
                   Vector::Constant(spd().rows(), std::numeric_limits<double>::quiet_NaN())),
               SolverFailure);
  EXPECT_THROW(ConjugateGradients(spd()).solve(Vector::Zero(3)), InvalidOption);
}

TEST(ConjugateGradients, solve_large_volumes) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 3, .jitter = 0.2});
  BoundaryConditions conditions;
  conditions.dirichlet_vertices = {0};
  conditions.dirichlet_values = {2};
  const Discretization d = discretize(mesh);
  const Poisson poisson(mesh, d, conditions);
  const Vector u = mesh.points() * Vec3(1, -2, 3);
  Vector load = d.stiffness * u;
  const PoissonSolution solution = poisson.solve_integrated(load);
  const double shift = 2 - u[0];
  EXPECT_LT((solution.values - u - Vector::Constant(u.size(), shift)).lpNorm<Eigen::Infinity>(),
            1e-8);
  EXPECT_LT(solution.relative_residual, 1e-10);
  EXPECT_EQ(solution.solver.method.substr(0, 19), "conjugate gradients");
}

/// A chain through all vertices in an order of chance: the iteration would need as many steps as it
/// has links, while its factorisation has no fill.
TEST(ConjugateGradients, give_way_to_the_factorisation_where_they_do_not_converge) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 3});
  Discretization d = discretize(mesh);
  std::vector<Index> order(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t k = 0; k + 1 < order.size(); ++k) {
    const Index a = order[k], b = order[k + 1];
    for (const auto& [row, column, value] :
         {std::tuple{a, a, 1.0}, {b, b, 1.0}, {a, b, -1.0}, {b, a, -1.0}})
      entries.emplace_back(row, column, value);
  }
  d.stiffness.setFromTriplets(entries.begin(), entries.end());
  BoundaryConditions conditions;
  conditions.dirichlet_vertices = {order.front()};
  conditions.dirichlet_values = {0};
  Vector load = Vector::Zero(mesh.n_vertices());
  load[order.back()] = 1;
  const PoissonSolution solution = Poisson(mesh, d, conditions).solve_integrated(load);
  EXPECT_EQ(solution.solver.method.find("conjugate"), std::string::npos);
  for (std::size_t k = 0; k < order.size(); k += 1000)
    EXPECT_NEAR(solution.values[order[k]], static_cast<double>(k), 1e-6);
}

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

TEST(MatrixComponents, explicit_zeros_do_not_connect) {
  SparseMatrix a(3, 3);
  a.insert(0, 0) = 1;
  a.insert(0, 1) = 0;
  a.insert(1, 1) = 1;
  EXPECT_EQ(matrix_components(a), (std::vector<Index>{0, 1, -1}));
}

}  // namespace
}  // namespace carat::test
