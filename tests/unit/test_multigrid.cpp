#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "carat/solve/conjugate_gradients.h"
#include "carat/solve/multigrid.h"

namespace carat::test {
namespace {

/// Values that are neither smooth nor different from run to run.
Vector rough(Index n) {
  Vector result(n);
  for (Index i = 0; i < n; ++i) result[i] = std::sin(1e3 * std::sin(static_cast<double>(i)));
  return result;
}

Index iterations(const SparseMatrix& a, const Preconditioner& preconditioner, Vector b,
                 const std::vector<bool>& fixed) {
  const auto hold = [&](Vector& x) {
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (fixed[i]) x[static_cast<Index>(i)] = 0;
  };
  hold(b);
  SolveReport report;
  const auto multiply = [&](const Vector& x, Vector& y) {
    y = a * x;
    hold(y);
  };
  conjugate_gradients(multiply, preconditioner, b, 0, {.tolerance = 1e-10, .accepted = 1e-8},
                      report);
  return report.iterations;
}

/// On the stiffness of diamonds, made from the sparser one.
template <class Mesh>
Index iterations_on(const Mesh& mesh) {
  const Discretization d = discretize(mesh);
  const std::vector<bool> fixed = boundary_vertices(mesh);
  const Multigrid multigrid(sparser_stiffness(mesh, d)(), fixed);
  return iterations(d.stiffness, multigrid, rough(mesh.n_vertices()), fixed);
}

/// The columns of a block do not see each other.
TEST(Multigrid, blocks_are_single_vectors_to_the_last_bit) {
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 4, .jitter = 0.2});
  const SparseMatrix a = discretize(mesh).stiffness;
  const std::vector<bool> fixed = boundary_vertices(mesh);
  const Multigrid multigrid(a, fixed, 1);
  const Index n = mesh.n_vertices();
  for (const Index k : {1, 2, 7, 11}) {
    Vector block(Eigen::Index{n} * k), result;
    for (Index c = 0; c < k; ++c)
      for (Index i = 0; i < n; ++i)
        block[Eigen::Index{i} * k + c] = c == 1 ? 0 : std::pow(1e3, c) * std::sin(1e3 * (i + c));
    multigrid.apply_block(block, result, k);
    for (Index c = 0; c < k; ++c) {
      Vector one(n), alone;
      for (Index i = 0; i < n; ++i) one[i] = block[Eigen::Index{i} * k + c];
      multigrid.apply(one, alone);
      for (Index i = 0; i < n; ++i) ASSERT_EQ(result[Eigen::Index{i} * k + c], alone[i]) << c;
      EXPECT_EQ(alone.isZero(0), c == 1);
    }
  }
}

TEST(Multigrid, threads_change_no_bit) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 4, .jitter = 0.2});
  const SparseMatrix a = discretize(mesh).stiffness;
  const std::vector<bool> fixed = boundary_vertices(mesh);
  const Vector r = rough(mesh.n_vertices());
  Vector one, others;
  Multigrid(a, fixed, 1).apply(r, one);
  for (const int threads : {2, 3, 7}) {
    Multigrid(a, fixed, threads).apply(r, others);
    EXPECT_EQ(one, others);
  }
}

/// Cells that are much thinner than wide, and polygons with short sides: joining rows across their
/// weak couplings takes 1.4 to 1.8 times as many iterations.
TEST(Multigrid, respects_weak_couplings) {
  EXPECT_LE(iterations_on(generate_mesh("plane-voronoi", {.level = 5, .jitter = 0.2})), 21);
  EXPECT_LE(iterations_on(generate_volume("cube-hexahedra", {.level = 3, .anisotropy = 100})), 18);
}

/// Units are of no account: single precision holds ratios of entries only.
TEST(Multigrid, units_change_nothing) {
  const PolygonMesh mesh = generate_mesh("sphere-hexagons", {.level = 4, .jitter = 0.2});
  const SparseMatrix a = discretize(mesh).stiffness;
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.n_vertices()), false);
  fixed[0] = true;
  const Vector r = rough(mesh.n_vertices());
  Vector plain, scaled;
  Multigrid(a, fixed).apply(r, plain);
  for (const double unit : {0x1p-60, 0x1p60, 0x1p-600, 0x1p600}) {
    Multigrid(SparseMatrix(unit * a), fixed).apply(r, scaled);
    EXPECT_EQ(plain, Vector(unit * scaled));
  }
}

/// Components of any size beside each other, single rows among them.
TEST(Multigrid, takes_many_components) {
  const SparseMatrix a = discretize(generate_mesh("sphere-quads", {.level = 2})).stiffness;
  const Index n = static_cast<Index>(a.rows()), copies = 40, single = 100;
  std::vector<Eigen::Triplet<double, Index>> entries;
  std::vector<bool> fixed(static_cast<std::size_t>(copies * n + single), false);
  for (Index copy = 0; copy < copies; ++copy) {
    fixed[static_cast<std::size_t>(copy * n)] = true;
    const double weight = std::pow(10.0, copy % 9 - 4);
    for (Index i = 0; i < n; ++i)
      for (SparseMatrix::InnerIterator entry(a, i); entry; ++entry)
        entries.emplace_back(copy * n + i, copy * n + static_cast<Index>(entry.col()),
                             weight * entry.value());
  }
  for (Index i = 0; i < single; ++i) entries.emplace_back(copies * n + i, copies * n + i, 1 + i);
  SparseMatrix::Plain all(copies * n + single, copies * n + single);
  all.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrix matrix(std::move(all));
  EXPECT_LE(
      iterations(matrix, Multigrid(matrix, fixed), rough(static_cast<Index>(matrix.rows())), fixed),
      40);
}

TEST(Multigrid, says_which_row_is_not_definite) {
  SparseMatrix::Plain plain(3, 3);
  plain.insert(0, 0) = 1;
  plain.insert(1, 1) = -2;
  plain.insert(2, 2) = 1;
  const SparseMatrix matrix(std::move(plain));
  try {
    const Multigrid multigrid(matrix, {});
    FAIL() << "no error";
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("(vertex) 1"), std::string::npos) << failure.what();
  }
}

}  // namespace
}  // namespace carat::test
