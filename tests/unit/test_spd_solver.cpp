#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "carat/solve/incomplete_cholesky.h"
#include "carat/solve/multigrid.h"
#include "carat/solve/spd_solver.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

constexpr SolverKind kIterations[] = {SolverKind::Multigrid, SolverKind::IncompleteCholesky,
                                      SolverKind::SparserCholesky};

std::shared_ptr<const SparseMatrix> share(SparseMatrix matrix) {
  return std::make_shared<SparseMatrix>(std::move(matrix));
}

SparseMatrix spd() {
  const Discretization d = discretize(quad_grid(7, 5));
  return d.stiffness + d.mass;
}

template <class Mesh>
void expect_all_kinds_agree(const Mesh& mesh, const char* name) {
  const Discretization d = discretize(mesh, name);
  const auto matrix = share(d.stiffness);
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
  fixed[3] = fixed[40] = true;
  Matrix rhs = Matrix::Random(mesh.n_vertices(), 3);
  rhs.col(1).setZero();
  const Matrix direct = Cholesky(d.stiffness, fixed).solve(rhs);
  for (const SolverKind kind : kIterations) {
    SCOPED_TRACE(solver_kind_name(kind));
    SolverOptions options{.kind = kind, .sparser = sparser_stiffness(mesh, d)};
    for (const bool sparser : {true, false}) {
      if (!sparser) options.sparser = nullptr;
      const SpdSolver solver(matrix, fixed, options);
      SolveReport report;
      const Matrix solution = solver.solve(rhs, &report);
      EXPECT_LT((solution - direct).norm(), 1e-9 * direct.norm());
      EXPECT_EQ(solution.col(1).norm(), 0);
      EXPECT_EQ(solution.row(40).norm(), 0);
      EXPECT_GT(report.iterations, 0);
      EXPECT_LT(report.residual, 1e-10);
      EXPECT_EQ(report.method.rfind("conjugate gradients", 0), 0U);
      EXPECT_EQ(solver.info().kind, kind);
      EXPECT_GT(solver.info().nonzeros, 0);
    }
  }
}

TEST(SpdSolver, all_kinds_agree) {
  expect_all_kinds_agree(generate_mesh("plane-voronoi", {.level = 2, .jitter = 0.2}), "diamond");
  expect_all_kinds_agree(generate_mesh("sphere-hexagons", {.level = 2}), "stabilized_diamond");
  expect_all_kinds_agree(generate_volume("cube-voronoi", {.level = 1, .jitter = 0.2}), "diamond");
  expect_all_kinds_agree(generate_volume("cube-tets", {.level = 2}), "bunge");
}

TEST(SpdSolver, auto_chooses_by_size_and_number_of_right_hand_sides) {
  const PolygonMesh large = generate_mesh("plane-quads", {.level = 5});
  ASSERT_GT(large.n_vertices(), 10000);
  const Discretization d = discretize(large);
  const auto matrix = share(d.stiffness + d.mass);
  const SpdSolver few(matrix, {}, {.sparser = sparser_stiffness(large, d)});
  EXPECT_EQ(few.info().kind, SolverKind::Multigrid);
  EXPECT_FALSE(few.info().reason.empty());
  const SpdSolver many(matrix, {}, {.right_hand_sides = 100});
  EXPECT_EQ(many.info().kind, SolverKind::Cholesky);
  const SpdSolver small(share(spd()));
  EXPECT_EQ(small.info().kind, SolverKind::Cholesky);
  EXPECT_EQ(small.info().reason, "48 unknowns of a surface are few");
  const Vector x = Vector::LinSpaced(large.n_vertices(), -1, 1);
  for (const SpdSolver* const solver : {&few, &many}) {
    SolveReport report;
    EXPECT_LT((solver->solve(*matrix * x, &report) - x).norm(), 1e-9 * x.norm());
    EXPECT_LT(report.residual, 1e-11);
  }
}

/// Right-hand sides that advance together, of very different size and difficulty, have the
/// solutions that they have alone, and the same bits for any number of threads.
TEST(SpdSolver, advances_right_hand_sides_together) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 4});
  const Discretization d = discretize(mesh);
  ASSERT_GT(mesh.n_vertices(), 4096);
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
  fixed[5] = true;
  Matrix rhs = Matrix::Random(mesh.n_vertices(), 11);
  rhs.col(3) = 1e-20 * rhs.col(2);
  rhs.col(4).setZero();
  rhs.col(5) = d.mass * Vector::Ones(mesh.n_vertices());
  const auto solve = [&](const Matrix& b, int threads) {
    const SpdSolver solver(
        share(d.stiffness), fixed,
        {.kind = SolverKind::Multigrid, .sparser = sparser_stiffness(mesh, d), .threads = threads});
    SolveReport report;
    const Matrix solution = solver.solve(b, &report);
    EXPECT_LT(report.residual, 1e-10);
    // Eight at a time.
    EXPECT_GE(report.passes, report.iterations);
    EXPECT_EQ(report.passes > report.iterations, b.cols() > 8);
    EXPECT_LE(report.passes, 2 * report.iterations);
    EXPECT_EQ(report.traffic, report.passes * (static_cast<double>(solver.info().operator_bytes) +
                                               16.0 * static_cast<double>(solver.info().nonzeros)));
    return solution;
  };
  const Matrix together = solve(rhs, 1);
  for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
    const Matrix alone = solve(rhs.col(k), 1);
    EXPECT_LE((together.col(k) - alone).norm(), 1e-9 * alone.norm()) << k;
  }
  EXPECT_EQ(together.col(4).norm(), 0);
  for (const int threads : {2, 3}) EXPECT_EQ(solve(rhs, threads), together);
}

TEST(SpdSolver, never_gives_a_wrong_answer) {
  SparseMatrix a = spd();
  a.coeffRef(3, 3) = -1;
  SparseMatrix b(2, 2);  // indefinite with a positive diagonal
  b.insert(0, 0) = b.insert(1, 1) = 1;
  b.insert(0, 1) = b.insert(1, 0) = 2;
  b.makeCompressed();
  const Vector nan = Vector::Constant(spd().rows(), std::numeric_limits<double>::quiet_NaN());
  for (const SolverKind kind : kIterations) {
    SCOPED_TRACE(solver_kind_name(kind));
    const SolverOptions options{.kind = kind};
    EXPECT_THROW(SpdSolver(share(a), {}, options), SolverFailure);
    EXPECT_THROW(SpdSolver(share(b), {}, options).solve(Vector{{1.0, -1.0}}), SolverFailure);
    EXPECT_THROW(SpdSolver(share(spd()), {}, options).solve(nan), SolverFailure);
    EXPECT_THROW(SpdSolver(share(spd()), {}, options).solve(Vector::Zero(3)), InvalidOption);
  }
  EXPECT_THROW(SpdSolver(share(a)), SolverFailure);
  EXPECT_THROW(SpdSolver(share(spd())).solve(nan), SolverFailure);
  EXPECT_THROW(SpdSolver(share(SparseMatrix(a.topRows(5)))), InvalidOption);
  EXPECT_THROW(SpdSolver(share(a), std::vector<bool>(3)), InvalidOption);
}

/// 1-D Laplacian with couplings from 1 to 1e-6: no preconditioner of the identity helps.
TEST(SpdSolver, failures_tell_the_course_of_the_residual) {
  class Identity final : public Preconditioner {
   public:
    void apply(const Vector& r, Vector& z) const override { z = r; }
    std::int64_t nonzeros() const override { return 0; }
  };
  const Index n = 400;
  const auto multiply = [&](const Vector& x, Vector& y) {
    for (Index i = 0; i < n; ++i)
      y[i] = 2 * x[i] - (i > 0 ? x[i - 1] : 0) - (i + 1 < n ? x[i + 1] : 0);
  };
  SolveReport report;
  try {
    conjugate_gradients(multiply, Identity(), Vector::Unit(n, 0), 4, {.iterations = 50}, report);
    FAIL() << "50 iterations cannot cross 400 links";
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("(50)"), std::string::npos) << failure.what();
    EXPECT_NE(std::string(failure.what()).find("1.0e+00 (0)"), std::string::npos);
  }
}

TEST(SpdSolver, names_are_checked) {
  EXPECT_EQ(solver_kind("multigrid"), SolverKind::Multigrid);
  EXPECT_THROW(solver_kind("jacobi"), InvalidOption);
}

/// z = M r is linear, symmetric and positive to the accuracy of its single precision.
TEST(Multigrid, is_symmetric_and_positive) {
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 4, .jitter = 0.2});
  const Discretization d = discretize(mesh);
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
  fixed[7] = true;
  const Multigrid multigrid(d.stiffness, fixed);
  Vector a = Vector::Random(mesh.n_vertices()), b = Vector::Random(mesh.n_vertices());
  Vector ma, mb, sum;
  multigrid.apply(a, ma);
  multigrid.apply(b, mb);
  multigrid.apply(a + b, sum);
  EXPECT_EQ(ma[7], 0);
  EXPECT_LT((sum - ma - mb).norm(), 1e-5 * sum.norm());
  EXPECT_NEAR(a.dot(mb), b.dot(ma), 1e-5 * a.norm() * mb.norm());
  EXPECT_GT(a.dot(ma), 0);
}

/// Iterations hardly grow with the size, on graded meshes too.
TEST(Multigrid, iterations_do_not_grow) {
  const auto iterations = [](const auto& mesh) {
    const Discretization d = discretize(mesh);
    std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
    fixed[0] = true;
    const SpdSolver solver(share(d.stiffness), fixed,
                           {.kind = SolverKind::Multigrid, .sparser = sparser_stiffness(mesh, d)});
    SolveReport report;
    solver.solve(Vector(d.mass * Vector::Random(mesh.n_vertices())), &report);
    return report.iterations;
  };
  for (const int level : {3, 4, 5}) {
    EXPECT_LT(iterations(generate_mesh("plane-voronoi", {.level = level})), 40);
    EXPECT_LT(iterations(generate_mesh("sphere-quads", {.level = level})), 40);
  }
  for (const int level : {1, 2, 3}) {
    EXPECT_LT(iterations(generate_volume("cube-tets-adaptive", {.level = level})), 40);
    EXPECT_LT(iterations(generate_volume("cube-hexahedra", {.level = level, .jitter = 0.2})), 40);
  }
}

TEST(SpdSolver, solves_large_volumes) {
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
  EXPECT_EQ(poisson.solver().kind, SolverKind::Multigrid);
  EXPECT_EQ(solution.solve.method, "conjugate gradients, multigrid of the sparser matrix");
}

/// Concave faces: the sparser matrix is so far from the matrix that even its inverse would not
/// serve.
TEST(SpdSolver, takes_multigrid_of_the_matrix_where_that_of_the_sparser_one_does_not_serve) {
  const PolygonMesh mesh = generate_mesh("plane-concave", {.level = 5, .jitter = 0.2});
  const Discretization d = discretize(mesh);
  const std::vector<bool> fixed = boundary_vertices(mesh);
  ASSERT_GT(mesh.n_vertices(), 10000);
  const SpdSolver solver(share(d.stiffness), fixed, {.sparser = sparser_stiffness(mesh, d)});
  EXPECT_EQ(solver.info().kind, SolverKind::Multigrid);
  SolveReport report;
  const Vector rhs = d.mass * Vector::Ones(mesh.n_vertices());
  for (int repeated = 0; repeated < 2; ++repeated) {
    solver.solve(rhs, &report);
    EXPECT_LT(report.iterations, 60);
    EXPECT_LT(report.residual, 1e-11);
    EXPECT_NE(report.method.find("after that of the sparser"), std::string::npos) << report.method;
  }
}

/// Third powers of 1-D Laplacians: six derivatives are beyond an aggregation of piecewise
/// constants, while the factorisation has hardly any fill.
TEST(SpdSolver, gives_way_to_the_factorisation_where_iterations_do_not_converge) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  Index n = 0;
  for (Index length = 100; n < 12000; ++length) {
    for (Index i = 0; i < length; ++i) {
      entries.emplace_back(n + i, n + i, 2);
      if (i == 0) continue;
      entries.emplace_back(n + i, n + i - 1, -1);
      entries.emplace_back(n + i - 1, n + i, -1);
    }
    n += length;
  }
  SparseMatrix chains(n, n);
  chains.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrix squared = chains * chains;
  const SpdSolver solver(share(squared * chains));
  EXPECT_EQ(solver.info().kind, SolverKind::Multigrid);
  SolveReport report;
  solver.solve(Vector::Random(n), &report);
  EXPECT_EQ(report.method.find("conjugate"), std::string::npos) << report.method;
  EXPECT_EQ(report.iterations, 0);
  EXPECT_LT(report.residual, 1e-4);  // rounding times condition numbers of up to 1e12
}

}  // namespace
}  // namespace carat::test
