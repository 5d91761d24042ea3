#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/matrix_operator.h"
#include "carat/solve/symmetric_matrix.h"
#include "support/measures.h"
#include "support/meshes.h"
#include "support/volume_meshes.h"

namespace carat::test {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

SymmetricMatrix halved(SparseMatrix matrix, int threads = 0) {
  return SymmetricMatrix(std::move(matrix), threads);
}

Rows multiply(const SymmetricOperator& a, const Rows& x) {
  Rows y = Rows::Constant(x.rows(), x.cols(), std::numeric_limits<double>::quiet_NaN());
  a.multiply(x.data(), y.data(), static_cast<Index>(x.cols()));
  return y;
}

/// All that an operator has, beside the whole matrix.
void expect_equal(const SymmetricOperator& a, const SparseMatrix& matrix) {
  const Index n = static_cast<Index>(matrix.rows());
  ASSERT_EQ(a.rows(), n);
  const Vector norms = matrix.cwiseAbs() * Vector::Ones(n);
  // Sums of a row in another order.
  const double rounding = 20 * kEps * (n > 0 ? norms.maxCoeff() : 0);
  for (const Index k : {1, 3, 8, 11}) {
    const Rows x = Rows::Random(n, k);
    const Rows error = multiply(a, x) - Rows(matrix * x);
    EXPECT_LE(n > 0 ? error.cwiseAbs().maxCoeff() : 0.0, rounding) << k;
  }
  EXPECT_EQ(a.diagonal(), Vector(matrix.diagonal()));
  EXPECT_LE((a.row_norms() - norms).norm(), 20 * kEps * norms.norm());
  EXPECT_EQ(a.components(), MatrixOperator(std::make_shared<SparseMatrix>(matrix)).components());
  EXPECT_EQ(a.nonzeros(), matrix.nonZeros());
  const SparseMatrix whole = *a.matrix();
  EXPECT_EQ(whole.nonZeros(), matrix.nonZeros());
  for (Index row = 0; row < n; ++row) {
    SparseMatrix::InnerIterator expected(matrix, row);
    for (SparseMatrix::InnerIterator entry(whole, row); entry; ++entry, ++expected) {
      ASSERT_TRUE(expected);
      ASSERT_EQ(entry.col(), expected.col());
      // Above the diagonal it is the entry below that was kept.
      ASSERT_NEAR(entry.value(), expected.value(), rounding);
    }
  }
}

template <class Mesh>
void expect_all(const Mesh& mesh) {
  for (const char* const name : {"diamond", "bunge"}) {
    SCOPED_TRACE(name);
    const Discretization d = discretize(mesh, name);
    expect_equal(halved(d.stiffness), d.stiffness);
    expect_equal(halved(d.mass), d.mass);
    expect_equal(*halved(d.mass).plus(0.3 * d.stiffness), d.mass + 0.3 * d.stiffness);
  }
}

/// Vertices numbered at random, so that all blocks are coupled with each other.
SparseMatrix shuffled(const SparseMatrix& matrix) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order(matrix.rows());
  std::iota(order.indices().begin(), order.indices().end(), 0);
  std::shuffle(order.indices().begin(), order.indices().end(), std::mt19937(7));
  return SparseMatrix(SparseMatrix(order * matrix) * order.transpose());
}

TEST(SymmetricMatrix, is_the_matrix) {
  for (const FamilyEntry& family : mesh_families())
    expect_all(family.generate({.level = 1, .jitter = 0.2}));
  for (const VolumeFamilyEntry& family : volume_families())
    expect_all(family.generate({.level = 0, .jitter = 0.2}));
  for (const NamedMesh& named : unusual_meshes()) expect_all(named.mesh);
  for (const NamedVolume& named : unusual_volumes()) expect_all(named.mesh);
}

TEST(SymmetricMatrix, is_the_matrix_in_many_blocks) {
  const Discretization hexagons = discretize(generate_mesh("plane-voronoi", {.level = 4}));
  ASSERT_GT(hexagons.stiffness.rows(), 8192);
  expect_equal(halved(hexagons.stiffness), hexagons.stiffness);
  expect_equal(halved(shuffled(hexagons.stiffness)), shuffled(hexagons.stiffness));
  const Discretization cubes = discretize(generate_volume("cube-hexahedra", {.level = 3}));
  ASSERT_GT(cubes.stiffness.rows(), 8192);
  expect_equal(halved(cubes.stiffness), cubes.stiffness);
  expect_equal(*halved(cubes.mass).plus(cubes.stiffness), cubes.mass + cubes.stiffness);
}

TEST(SymmetricMatrix, takes_empty_rows_and_matrices) {
  expect_equal(halved(SparseMatrix(0, 0)), SparseMatrix(0, 0));
  expect_equal(halved(SparseMatrix(1, 1)), SparseMatrix(1, 1));
  SparseMatrix one(1, 1);
  one.insert(0, 0) = 3;
  expect_equal(halved(one), one);
  SparseMatrix gaps(5, 5);  // no diagonal in row 1, rows 0 and 3 empty, a coupling of 0
  gaps.insert(1, 4) = gaps.insert(4, 1) = 2;
  gaps.insert(2, 2) = 1;
  gaps.insert(2, 4) = gaps.insert(4, 2) = 0;
  gaps.insert(4, 4) = 5;
  expect_equal(halved(gaps), gaps);
}

TEST(SymmetricMatrix, is_the_same_for_any_number_of_threads) {
  const SparseMatrix matrix = discretize(generate_mesh("plane-quads", {.level = 6})).stiffness;
  ASSERT_GT(matrix.rows(), 8 * 4096);
  for (const SparseMatrix& a : {matrix, shuffled(matrix)})
    for (const Index k : {1, 3, 8, 11}) {
      const Rows x = Rows::Random(a.rows(), k);
      const Rows y = multiply(halved(a, 1), x);
      for (const int threads : {2, 3, 8}) EXPECT_EQ(multiply(halved(a, threads), x), y);
      // A column alone has the bits that it has among others.
      EXPECT_EQ(Vector(y.col(k - 1)), halved(a, 2) * Vector(x.col(k - 1)));
    }
}

TEST(SymmetricMatrix, halves_the_memory_of_a_numbering_with_locality) {
  const auto part = [](const SparseMatrix& matrix) {
    return static_cast<double>(halved(matrix).bytes()) /
           static_cast<double>(MatrixOperator(std::make_shared<SparseMatrix>(matrix)).bytes());
  };
  const SparseMatrix matrix = discretize(generate_mesh("plane-quads", {.level = 6})).stiffness;
  EXPECT_LT(part(matrix), 0.56);  // and a sixteenth of the triangle twice
  EXPECT_LT(part(shuffled(matrix)), 1);
}

template <class Mesh>
void expect_same_solution(const Mesh& mesh, const char* name) {
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[static_cast<std::size_t>(v)] && mesh.point(v).x() < 0.5) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(mesh.point(v).y());
    }
  const Discretization d = discretize(mesh, name);
  const Vector f = Vector::Random(mesh.n_vertices());
  for (const SolverKind kind : solver_kinds()) {
    SCOPED_TRACE(solver_kind_name(kind));
    const Poisson full(mesh, d, conditions, {.kind = kind});
    const Poisson half(mesh, d, conditions, {.kind = kind, .storage = MatrixStorage::Triangle});
    EXPECT_FALSE(full.solver().halved);
    EXPECT_TRUE(half.solver().halved);
    EXPECT_EQ(half.solver().kind, full.solver().kind);
    EXPECT_EQ(half.solver().nonzeros, full.solver().nonzeros);
    EXPECT_LT(half.solver().operator_bytes, full.solver().operator_bytes);
    const Vector u = full.solve(f).values;
    EXPECT_LE((half.solve(f).values - u).norm(), 1e-9 * u.norm());
    Discretization rest = d;
    const Poisson moved(mesh, std::move(rest), conditions,
                        {.kind = kind, .storage = MatrixStorage::Triangle});
    EXPECT_EQ(moved.solve(f).values, half.solve(f).values);
    EXPECT_EQ(rest.n_unknowns(), d.n_unknowns());
    EXPECT_EQ(rest.stiffness.nonZeros(), 0);
  }
}

TEST(SymmetricMatrix, solves_as_the_matrix_does) {
  expect_same_solution(generate_mesh("plane-triangles", {.level = 3, .jitter = 0.2}), "diamond");
  expect_same_solution(generate_mesh("plane-quads", {.level = 5}), "stabilized_diamond");
  expect_same_solution(generate_volume("cube-tets", {.level = 2}), "diamond");
}

/// Without a sparser matrix preconditioners are built from what is stored.
TEST(SymmetricMatrix, preconditions_itself) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 4, .jitter = 0.2});
  const Discretization d = discretize(mesh);
  const SparseMatrix matrix = d.stiffness + d.mass;
  const auto half = std::make_shared<SymmetricMatrix>(SparseMatrix(matrix));
  const Vector x = Vector::LinSpaced(matrix.rows(), -1, 1);
  for (const SolverKind kind : solver_kinds()) {
    SCOPED_TRACE(solver_kind_name(kind));
    const SpdSolver solver(half, {}, {.kind = kind});
    EXPECT_LT((solver.solve(Vector(matrix * x)) - x).norm(), 1e-9 * x.norm());
    if (solver.info().kind != SolverKind::Cholesky) {
      EXPECT_EQ(solver.info().method.rfind("conjugate gradients with one triangle, ", 0), 0U);
    }
  }
}

TEST(SymmetricMatrix, changes_nothing_without_a_matrix) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 3});
  const Discretization d = discretize(mesh, "diamond", {.form = OperatorForm::Products});
  BoundaryConditions conditions;
  conditions.dirichlet_vertices = {0};
  conditions.dirichlet_values = {1};
  const SolverOptions full{.kind = SolverKind::Multigrid};
  SolverOptions half = full;
  half.storage = MatrixStorage::Triangle;
  const Poisson a(mesh, d, conditions, full), b(mesh, d, conditions, half);
  EXPECT_FALSE(b.solver().halved);
  EXPECT_FALSE(b.solver().assembled);
  EXPECT_EQ(b.solver().method, a.solver().method);
  const Vector f = Vector::Zero(mesh.n_vertices());
  EXPECT_EQ(b.solve(f).values, a.solve(f).values);
}

TEST(SymmetricMatrix, storage_has_names) {
  EXPECT_EQ(matrix_storage("full"), MatrixStorage::Full);
  EXPECT_EQ(matrix_storage("triangle"), MatrixStorage::Triangle);
  EXPECT_THROW(matrix_storage("half"), InvalidOption);
}

}  // namespace
}  // namespace carat::test
