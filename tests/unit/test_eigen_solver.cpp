#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "carat/base/error.h"
#include "carat/operators/registry.h"
#include "carat/solve/eigen_solver.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

// Asked of every pair, far above rounding times the ratio of the largest eigenvalue (about 1e4 of
// the first here).
constexpr double kResidual = 1e-9;

/// Number of eigenvalues below sigma by Sylvester's law: negative pivots of S - sigma M.
Index count_below(const SparseMatrix& s, const SparseMatrix& m, double sigma) {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  factor.compute(Eigen::SparseMatrix<double>(s - sigma * m));
  return static_cast<Index>((factor.vectorD().array() < 0).count());
}

void expect_sound(const EigenPairs& pairs, const SparseMatrix& m) {
  const Index n = static_cast<Index>(pairs.values.size());
  const Matrix gram = pairs.vectors.transpose() * (m * pairs.vectors);
  EXPECT_LT((gram - Matrix::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT(pairs.residuals.maxCoeff(), kResidual);
  for (Index k = 1; k < n; ++k) EXPECT_GE(pairs.values[k], pairs.values[k - 1]);
}

/// Nothing is missing: the pairs below the last one are as many as S - sigma M has negative pivots.
void expect_complete(const EigenPairs& pairs, const SparseMatrix& s, const SparseMatrix& m) {
  const Index n = static_cast<Index>(pairs.values.size());
  const double last = pairs.values[n - 1];
  const Index below = static_cast<Index>((pairs.values.array() < last * (1 - 1e-7)).count());
  EXPECT_EQ(count_below(s, m, last * (1 - 1e-7)), below);
  EXPECT_GE(count_below(s, m, last * (1 + 1e-7)), n);
}

/// Diagonal pencil of known values: M = 2, S = 2 values.
SparseMatrix diagonal(const Vector& values) {
  SparseMatrix a(values.size(), values.size());
  for (Index i = 0; i < values.size(); ++i) a.insert(i, i) = values[i];
  a.makeCompressed();
  return a;
}

/// The 5-point stiffness of a path of n unit intervals, both ends free, with lumped mass 1.
SparseMatrix path(Index n) {
  SparseMatrix a(n, n);
  for (Index i = 0; i < n; ++i) {
    if (i > 0) a.insert(i, i - 1) = -1;
    a.insert(i, i) = (i > 0) + (i + 1 < n);
    if (i + 1 < n) a.insert(i, i + 1) = -1;
  }
  a.makeCompressed();
  return a;
}

TEST(EigenSolver, path_has_its_closed_form_values) {
  const Index n = 1500;
  const SparseMatrix s = path(n), m = diagonal(Vector::Ones(n));
  const EigenPairs pairs = smallest_eigenpairs(s, m, 20);
  EXPECT_GT(pairs.solves, 0);
  EXPECT_EQ(pairs.zero_modes, 1);
  EXPECT_EQ(pairs.values[0], 0);
  for (Index k = 1; k < 20; ++k) {
    const double exact = 4 * std::pow(std::sin(std::numbers::pi * k / (2 * n)), 2);
    // The condition of S is about n^2.
    EXPECT_NEAR(pairs.values[k] / exact, 1, 1e-10) << k;
  }
  expect_sound(pairs, m);
}

TEST(EigenSolver, clusters_of_which_a_krylov_space_shows_one_member_are_complete) {
  // Equal copies: every eigenvalue has 20 members, of which a Krylov space shows one; the copies
  // are long enough for it to find others first.
  const Index copies = 20, n = 150;
  const SparseMatrix one = path(n);
  SparseMatrix s(copies * n, copies * n);
  for (Index c = 0; c < copies; ++c)
    for (Index i = 0; i < n; ++i)
      for (SparseMatrix::InnerIterator entry(one, i); entry; ++entry)
        s.insert(c * n + i, c * n + static_cast<Index>(entry.col())) = entry.value();
  s.makeCompressed();
  std::vector<bool> fixed(static_cast<std::size_t>(copies * n), false);
  for (Index c = 0; c < copies; ++c) fixed[c * n] = true;
  const SparseMatrix m = diagonal(Vector::Ones(copies * n));
  const auto exact = [&](int k) {
    return 4 * std::pow(std::sin(std::numbers::pi * (k - 0.5) / (2 * n - 1)), 2);
  };
  for (const Index count : {9, 13, 24}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(s, m, count, fixed);
    EXPECT_GT(pairs.solves, 0);
    EXPECT_EQ(pairs.zero_modes, 0);
    for (Index k = 0; k < count; ++k)
      EXPECT_NEAR(pairs.values[k] / exact(k < 20 ? 1 : 2), 1, 1e-10) << k;  // condition 1e4
    expect_sound(pairs, m);
  }
}

TEST(EigenSolver, members_that_a_whole_krylov_space_misses_are_found) {
  // Two distinct values: a Krylov space is exhausted at once, with one member of each.
  Vector values = Vector::Constant(500, 2);
  for (Index k = 0; k < 20; ++k) values[25 * k] = 1;
  const SparseMatrix s = diagonal(values), m = diagonal(Vector::Ones(500));
  for (const Index count : {9, 20, 26}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(s, m, count);
    EXPECT_GT(pairs.solves, 0);
    for (Index k = 0; k < count; ++k) EXPECT_NEAR(pairs.values[k], k < 20 ? 1 : 2, 1e-13) << k;
    expect_sound(pairs, m);
  }
}

TEST(EigenSolver, graphs_of_few_distinct_values_are_solved) {
  // The complete graph: all of its non-zero values are equal, so that every vector is an
  // eigenvector and what an iteration sees beside it is rounding.
  const Index n = 400;
  SparseMatrix complete(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) complete.insert(i, j) = i == j ? n - 1 : -1;
  complete.makeCompressed();
  const SparseMatrix ones = diagonal(Vector::Ones(n));
  for (const Index count : {2, 20}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(complete, ones, count);
    EXPECT_GT(pairs.solves, 0);
    EXPECT_LT((pairs.values.tail(count - 1) / n - Vector::Ones(count - 1)).cwiseAbs().maxCoeff(),
              1e-12);  // condition n
    expect_sound(pairs, ones);
  }
  // The hypercube: 2 k, binomial(9, k) times.
  SparseMatrix cube(512, 512);
  for (Index i = 0; i < 512; ++i) {
    cube.insert(i, i) = 9;
    for (Index bit = 1; bit < 512; bit *= 2) cube.insert(i, i ^ bit) = -1;
  }
  cube.makeCompressed();
  const SparseMatrix cube_mass = diagonal(Vector::Ones(512));
  for (const Index count : {5, 10, 11, 46, 47}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(cube, cube_mass, count);
    EXPECT_GT(pairs.solves, 0);
    for (Index k = 1; k < count; ++k)
      EXPECT_NEAR(pairs.values[k], k < 10 ? 2 : k < 46 ? 4 : 6, 1e-11) << k;
    expect_sound(pairs, cube_mass);
  }
}

TEST(EigenSolver, as_many_pairs_as_a_value_has_members_are_found) {
  // What is left has no other vectors of that value to converge to.
  Vector values = Vector::Constant(600, 5);
  for (Index k = 0; k < 70; ++k) values[8 * k] = 1;
  const EigenPairs pairs = smallest_eigenpairs(diagonal(values), diagonal(Vector::Ones(600)), 70);
  EXPECT_LT((pairs.values - Vector::Ones(70)).cwiseAbs().maxCoeff(), 1e-13);
  expect_sound(pairs, diagonal(Vector::Ones(600)));
}

TEST(EigenSolver, symmetric_grids_give_complete_clusters_wherever_they_are_cut) {
  const PolygonMesh mesh = quad_grid(30, 30);
  const Discretization d = discretize(mesh);
  for (const Index count : {2, 3, 7, 24, 25, 40, 51}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, count);
    EXPECT_GT(pairs.solves, 0);
    expect_sound(pairs, d.mass);
    expect_complete(pairs, d.stiffness, d.mass);
  }
}

TEST(EigenSolver, constants_of_every_component_are_exact) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const Discretization d = discretize(mesh);
  const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, 7);
  EXPECT_EQ(pairs.zero_modes, 2);
  EXPECT_EQ(pairs.values.head(2), Vector::Zero(2));
  EXPECT_GT(pairs.values[2], 0);
  const double triangle = 1 / std::sqrt(0.5);
  const Vector first = pairs.vectors.col(0), second = pairs.vectors.col(1);
  EXPECT_NEAR(first[0], triangle, 1e-14);
  EXPECT_EQ(first[0], first[2]);
  EXPECT_EQ(first[5], 0);
  EXPECT_NEAR(second[5], 1, 1e-14);
  EXPECT_EQ(pairs.vectors.row(3).cwiseAbs().maxCoeff(), 0) << "a vertex without a face";
  EXPECT_EQ(smallest_eigenpairs(d.stiffness, d.mass, 1).zero_modes, 2);
  expect_sound(pairs, d.mass);
  EXPECT_THROW(smallest_eigenpairs(d.stiffness, d.mass, 8), InvalidOption);
}

TEST(EigenSolver, dense_and_iterative_methods_agree) {
  const PolygonMesh mesh = quad_grid(19, 17);  // 360 vertices: above the dense limit
  const Discretization d = discretize(mesh);
  const EigenPairs few = smallest_eigenpairs(d.stiffness, d.mass, 12);
  const EigenPairs all = smallest_eigenpairs(d.stiffness, d.mass, mesh.n_vertices());
  EXPECT_GT(few.solves, 0);
  EXPECT_EQ(all.solves, 0);
  EXPECT_LT((few.values - all.values.head(12)).cwiseAbs().maxCoeff(), 1e-12);
  expect_sound(all, d.mass);
}

TEST(EigenSolver, nearly_all_pairs_of_a_large_pencil_are_refused) {
  const SparseMatrix s = path(4000), m = diagonal(Vector::Ones(4000));
  EXPECT_THROW(smallest_eigenpairs(s, m, 3990), InvalidOption);
}

TEST(EigenSolver, scales_of_length_and_mass_do_not_matter) {
  const Discretization d = discretize(quad_grid(22, 20));
  const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, 8);
  for (const double scale : {1e-18, 1e18}) {
    const EigenPairs scaled = smallest_eigenpairs(d.stiffness, SparseMatrix(scale * d.mass), 8);
    EXPECT_LT((scaled.values * scale - pairs.values).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(scaled.residuals.maxCoeff(), kResidual);
  }
}

TEST(EigenSolver, results_repeat_bit_by_bit_and_signs_are_fixed) {
  const Discretization d = discretize(quad_grid(30, 30));
  const EigenPairs a = smallest_eigenpairs(d.stiffness, d.mass, 10);
  const EigenPairs b = smallest_eigenpairs(d.stiffness, d.mass, 10);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.vectors, b.vectors);
  for (Index k = 0; k < 10; ++k) {
    const auto x = a.vectors.col(k);
    const double bound = 0.6 * x.lpNorm<Eigen::Infinity>();
    Index i = 0;
    while (std::abs(x[i]) < bound) ++i;
    EXPECT_GT(x[i], 0) << k;
  }
}

TEST(EigenSolver, far_apart_eigenvalues_are_found) {
  // Two stiff blobs that hang together by a thread: the first value is 1e-7 of the next.
  SparseMatrix s = path(1200);
  const Index cut = 599;
  s.coeffRef(cut, cut) -= 1 - 1e-9;
  s.coeffRef(cut + 1, cut + 1) -= 1 - 1e-9;
  s.coeffRef(cut, cut + 1) = s.coeffRef(cut + 1, cut) = -1e-9;
  const SparseMatrix m = diagonal(Vector::Ones(1200));
  const EigenPairs pairs = smallest_eigenpairs(s, m, 6);
  EXPECT_NEAR(pairs.values[1] / (1e-9 / 300), 1, 1e-3);
  const double second = 4 * std::pow(std::sin(std::numbers::pi / 1200), 2);
  EXPECT_NEAR(pairs.values[2] / second, 1, 1e-3);
  // Inverse values 1e7 apart: the larger ones' rounding is 1e-9 of the others.
  EXPECT_LT(pairs.residuals.tail(4).maxCoeff(), 1e-6);
  // 1e-16 of |S| is this much of the first value.
  EXPECT_LT(pairs.residuals.maxCoeff(), 1e-16 * 4 / pairs.values[1] * 10);
}

TEST(EigenSolver, values_that_stand_out_spoil_no_others) {
  // A random start vector's image is all but the first eigenvectors.
  for (const Index n_tiny : {1, 3}) {
    SCOPED_TRACE(n_tiny);
    Vector values = Vector::LinSpaced(600, 1, 7);
    values.head(n_tiny).setConstant(1e-12);
    const SparseMatrix m = diagonal(Vector::Ones(600));
    const EigenPairs pairs = smallest_eigenpairs(diagonal(values), m, 10);
    for (Index k = 0; k < 10; ++k)
      // The larger inverse values' rounding is 1e-4 of the others, squared in their values.
      EXPECT_NEAR(pairs.values[k] / values[k], 1, 1e-7) << k;
    const Matrix gram = pairs.vectors.transpose() * pairs.vectors;
    EXPECT_LT((gram - Matrix::Identity(10, 10)).cwiseAbs().maxCoeff(), 1e-11);
  }
}

const EigenOptions kCholesky{.method = EigenMethod::Cholesky};
const EigenOptions kIterative{.method = EigenMethod::Iterative};

TEST(EigenSolver, iteration_factorisation_and_dense_method_agree) {
  const Discretization d = discretize(quad_grid(30, 30));
  const EigenPairs all = smallest_eigenpairs(d.stiffness, d.mass, d.n_vertices());
  for (const Index count : {2, 7, 24, 40}) {
    SCOPED_TRACE(count);
    const EigenPairs lanczos = smallest_eigenpairs(d.stiffness, d.mass, count, {}, kCholesky);
    const EigenPairs iterated = smallest_eigenpairs(d.stiffness, d.mass, count, {}, kIterative);
    EXPECT_EQ(lanczos.method, EigenMethod::Cholesky);
    EXPECT_EQ(iterated.method, EigenMethod::Iterative);
    EXPECT_EQ(lanczos.iterations, 0);
    EXPECT_GT(iterated.iterations, 0);
    EXPECT_GT(iterated.bytes, 0);
    const Vector scale = all.values.segment(1, count - 1);
    for (const EigenPairs* const pairs : {&lanczos, &iterated}) {
      EXPECT_LT(((pairs->values.tail(count - 1) - scale).array() / scale.array()).abs().maxCoeff(),
                1e-12);
      expect_sound(*pairs, d.mass);
      expect_complete(*pairs, d.stiffness, d.mass);
    }
  }
}

TEST(EigenSolver, iteration_finds_clusters_of_more_members_than_a_block) {
  // The hypercube: 2 k, binomial(9, k) times.
  SparseMatrix cube(512, 512);
  for (Index i = 0; i < 512; ++i) {
    cube.insert(i, i) = 9;
    for (Index bit = 1; bit < 512; bit *= 2) cube.insert(i, i ^ bit) = -1;
  }
  cube.makeCompressed();
  const SparseMatrix mass = diagonal(Vector::Ones(512));
  for (const Index count : {5, 10, 11, 46, 47}) {
    SCOPED_TRACE(count);
    const EigenPairs pairs = smallest_eigenpairs(cube, mass, count, {}, kIterative);
    EXPECT_EQ(pairs.method, EigenMethod::Iterative);
    for (Index k = 1; k < count; ++k)
      EXPECT_NEAR(pairs.values[k], k < 10 ? 2 : k < 46 ? 4 : 6, 1e-11) << k;
    expect_sound(pairs, mass);
  }
}

TEST(EigenSolver, threads_do_not_change_a_bit) {
  const Discretization d = discretize(quad_grid(60, 50));
  for (const EigenMethod method : {EigenMethod::Cholesky, EigenMethod::Iterative}) {
    const EigenPairs one =
        smallest_eigenpairs(d.stiffness, d.mass, 12, {}, {.method = method, .threads = 1});
    const EigenPairs three =
        smallest_eigenpairs(d.stiffness, d.mass, 12, {}, {.method = method, .threads = 3});
    EXPECT_EQ(one.values, three.values);
    EXPECT_EQ(one.vectors, three.vectors);
  }
}

TEST(EigenSolver, iteration_that_does_not_converge_tells_its_course) {
  // A preconditioner of another matrix, whose smooth vectors are rough in this one.
  const Discretization d = discretize(quad_grid(60, 50));
  EigenOptions options = kIterative;
  const Index n = d.n_vertices();
  options.sparser = [n] {
    Vector values(n);
    for (Index i = 0; i < n; ++i) values[i] = std::pow(10.0, i % 31);
    return diagonal(values);
  };
  try {
    smallest_eigenpairs(d.stiffness, d.mass, 10, {}, options);
    FAIL() << "converged";
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("residual"), std::string::npos) << failure.what();
  }
}

TEST(EigenSolver, progress_is_told_and_may_end_the_work) {
  struct Stop {};
  const Discretization d = discretize(quad_grid(30, 30));
  for (EigenOptions options : {kCholesky, kIterative}) {
    Index last = -1;
    options.progress = [&](Index converged) { last = converged; };
    smallest_eigenpairs(d.stiffness, d.mass, 11, {}, options);
    EXPECT_EQ(last, 10) << "the constant is known";
    options.progress = [](Index) { throw Stop{}; };
    EXPECT_THROW(smallest_eigenpairs(d.stiffness, d.mass, 11, {}, options), Stop);
  }
}

TEST(EigenSolver, pairs_without_room_for_an_iteration_are_had_densely) {
  const Discretization d = discretize(quad_grid(19, 17));
  const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, 200, {}, kIterative);
  EXPECT_EQ(pairs.method, EigenMethod::Cholesky);
  EXPECT_NE(pairs.reason.find("no room"), std::string::npos) << pairs.reason;
  expect_sound(pairs, d.mass);
}

TEST(EigenSolver, names_of_methods_are_read_back) {
  for (const EigenMethod method :
       {EigenMethod::Auto, EigenMethod::Cholesky, EigenMethod::Iterative})
    EXPECT_EQ(eigen_method(eigen_method_name(method)), method);
  EXPECT_THROW(eigen_method("lanczos"), InvalidOption);
}

TEST(EigenSolver, bad_matrices_are_refused) {
  const Discretization d = discretize(quad_grid(20, 20));
  const Index n = d.n_vertices();
  const SparseMatrix &s = d.stiffness, &m = d.mass;
  for (const Index count : {-1, 0, n + 1})
    EXPECT_THROW(smallest_eigenpairs(s, m, count), InvalidOption);
  EXPECT_THROW(smallest_eigenpairs(s, diagonal(Vector::Ones(3)), 1), InvalidOption);
  EXPECT_THROW(smallest_eigenpairs(s, m, 1, std::vector<bool>(3)), InvalidOption);
  EXPECT_THROW(smallest_eigenpairs(s, m, 1, std::vector<bool>(static_cast<std::size_t>(n), true)),
               InvalidOption);
  SparseMatrix bad = m;
  bad.coeffRef(7, 7) = -bad.coeff(7, 7);
  EXPECT_THROW(smallest_eigenpairs(s, bad, 3), SolverFailure) << "negative diagonal";
  bad = m;
  bad.coeffRef(7, 8) = bad.coeffRef(8, 7) = 3 * m.coeff(7, 7);
  EXPECT_THROW(smallest_eigenpairs(s, bad, 3), SolverFailure) << "indefinite pair of rows";
  bad = m;
  bad.coeffRef(7, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(smallest_eigenpairs(s, bad, 3), SolverFailure);
  EXPECT_THROW(smallest_eigenpairs(SparseMatrix(-s), m, 3), SolverFailure);
  bad = s;
  bad.coeffRef(7, 7) *= 0.5;
  EXPECT_THROW(smallest_eigenpairs(bad, m, 3), SolverFailure) << "indefinite stiffness";
  bad = s;
  bad.coeffRef(7, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(smallest_eigenpairs(bad, m, 3), SolverFailure);
}

}  // namespace
}  // namespace carat::test
