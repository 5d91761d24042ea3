#include <gtest/gtest.h>

#include "carat/apps/poisson.h"
#include "carat/assembly/element_product.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "support/measures.h"
#include "support/meshes.h"
#include "support/volume_measures.h"
#include "support/volume_meshes.h"

namespace carat::test {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A product is as exact as its largest factors, which may be larger than the entries of the
/// matrix.
double rounding(const SymmetricOperator& product) {
  return 100 * kEps * product.row_norms().maxCoeff();
}

void expect_equal(const SymmetricOperator& product, const SparseMatrix& matrix) {
  ASSERT_EQ(product.rows(), matrix.rows());
  EXPECT_FALSE(product.assembled());
  const Index n = product.rows();
  const double tolerance = rounding(product);
  for (const Index k : {1, 3, 11}) {
    const Matrix x = Matrix::Random(n, k);
    const Rows rows = x;
    Rows y(n, k);
    product.multiply(rows.data(), y.data(), k);
    EXPECT_LE((Matrix(y) - matrix * x).cwiseAbs().maxCoeff(), tolerance);
    for (Index j = 0; j < k; ++j) EXPECT_EQ(Vector(y.col(j)), product * Vector(x.col(j)));
  }
  EXPECT_LE((product.diagonal() - Vector(matrix.diagonal())).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LE(max_abs(SparseMatrix(*product.matrix() - matrix)), tolerance);
  const Vector norms = matrix.cwiseAbs() * Vector::Ones(n);
  EXPECT_GE((product.row_norms() - norms).minCoeff(), -tolerance);
}

template <class Mesh>
void expect_products(const Mesh& mesh, const std::string& name, DiscretizationOptions options) {
  options.threads = 1;
  const Discretization matrices = discretize(mesh, name, options);
  options.form = OperatorForm::Products;
  const Discretization d = discretize(mesh, name, options);
  EXPECT_EQ(d.stiffness.nonZeros() + d.mass.nonZeros(), 0);
  EXPECT_EQ(d.n_unknowns(), matrices.n_unknowns());
  expect_equal(*d.stiffness_product, matrices.stiffness);
  expect_equal(*d.mass_product, matrices.mass);
  EXPECT_LE(difference(d.gradient, matrices.gradient), 1e-11);  // tetrahedra: in closed form
  EXPECT_LE((d.sample_measure - matrices.sample_measure).norm(),
            1e-13 * matrices.sample_measure.norm());
  EXPECT_LE((d.lumped_mass() - matrices.lumped_mass()).norm(),
            1e-13 * matrices.lumped_mass().norm());
  // M + t S, and its sum with a matrix.
  const ElementProduct &s = *d.stiffness_product, &m = *d.mass_product;
  const SparseMatrix expected = matrices.mass + 0.3 * matrices.stiffness;
  expect_equal(*ElementProduct::sum(m, 0.3, s), expected);
  expect_equal(*ElementProduct::sum(s, 2, m), matrices.stiffness + 2 * matrices.mass);
  expect_equal(*ElementProduct::sum(m, 0.3, s)->plus(matrices.stiffness),
               expected + matrices.stiffness);
  options.threads = 3;
  const Discretization again = discretize(mesh, name, options);
  const Vector x = Vector::Random(d.n_unknowns());
  EXPECT_EQ(*d.stiffness_product * x, *again.stiffness_product * x);
  EXPECT_EQ(*d.mass_product * x, *again.mass_product * x);
}

/// The operators, with all that changes their terms.
template <class Mesh>
void expect_all_products(const Mesh& mesh, const Matrix& tensors) {
  for (const char* const name : {"diamond", "stabilized_diamond"}) {
    SCOPED_TRACE(name);
    expect_products(mesh, name, {});
    expect_products(mesh, name, {.mass = MassKind::Lumped});
    expect_products(mesh, name,
                    {.virtual_vertex = {.keep_in_kernel = false}, .mass = MassKind::MomentExact});
    expect_products(mesh, name,
                    {.mass = MassKind::Full,
                     .coefficient = [](const Vec3& x) { return 1 + x.squaredNorm(); },
                     .cell_coefficient = tensors});
  }
}

TEST(ElementProduct, equals_the_matrices_on_surfaces) {
  for (const FamilyEntry& family : mesh_families()) {
    SCOPED_TRACE(family.name);
    expect_all_products(family.generate({.level = 1, .jitter = 0.2}), {});
  }
  for (const NamedMesh& named : unusual_meshes()) {
    SCOPED_TRACE(named.name);
    expect_all_products(named.mesh, {});
  }
}

TEST(ElementProduct, equals_the_matrices_in_volumes) {
  std::vector<NamedVolume> meshes = unusual_volumes();
  for (const VolumeFamilyEntry& family : volume_families())
    meshes.push_back({family.name, family.generate({.level = 0, .jitter = 0.2})});
  for (const NamedVolume& named : meshes) {
    SCOPED_TRACE(named.name);
    Matrix tensors(named.mesh.n_cells(), 6);
    for (Index c = 0; c < tensors.rows(); ++c)
      tensors.row(c) << 1 + c % 3, 2, 3, 0.2, 0.1 * (c % 5), -0.3;
    expect_all_products(named.mesh, tensors);
  }
}

TEST(ElementProduct, is_the_same_for_any_number_of_threads) {
  const auto expect_same = [](const auto& mesh) {
    ASSERT_GT(mesh.n_vertices(), 2048);  // below, one thread does it
    const auto product = [&](int threads) {
      return discretize(mesh, "diamond", {.form = OperatorForm::Products, .threads = threads})
          .stiffness_product;
    };
    const Matrix x = Matrix::Random(3, mesh.n_vertices());
    const auto multiply = [&](int threads) {
      Matrix y(3, mesh.n_vertices());
      product(threads)->multiply(x.data(), y.data(), 3);
      return y;
    };
    const Matrix y = multiply(1);
    for (const int threads : {2, 3, 7}) EXPECT_EQ(multiply(threads), y);
  };
  expect_same(generate_mesh("plane-voronoi", {.level = 4}));
  expect_same(generate_volume("cube-truncated", {.level = 2}));
}

TEST(ElementProduct, has_the_components_of_the_matrix) {
  const auto expect_same = [](const auto& mesh) {
    const Discretization matrices = discretize(mesh);
    const Discretization d = discretize(mesh, "diamond", {.form = OperatorForm::Products});
    EXPECT_EQ(d.stiffness_product->components(), matrix_components(matrices.stiffness));
  };
  for (const NamedMesh& named : unusual_meshes()) expect_same(named.mesh);
  for (const NamedVolume& named : unusual_volumes()) expect_same(named.mesh);
}

template <class Mesh>
void expect_same_solution(const Mesh& mesh, const char* name,
                          const BoundaryConditions& conditions) {
  ASSERT_GE(mesh.n_vertices(), 10000);
  ASSERT_EQ(poisson_form(mesh, name), OperatorForm::Products);
  const Discretization matrices = discretize(mesh, name);
  const Discretization d = discretize(mesh, name, {.form = OperatorForm::Products});
  Vector f = Vector::Random(mesh.n_vertices());
  f.array() -= f.dot(d.lumped_mass()) / d.lumped_mass().sum();
  const Poisson with_matrix(mesh, matrices, conditions), without(mesh, d, conditions);
  const PoissonSolution expected = with_matrix.solve(f), solution = without.solve(f);
  EXPECT_LE((solution.values - expected.values).norm(), 1e-10 * expected.values.norm());
  EXPECT_EQ(solution.floating_components, expected.floating_components);
  EXPECT_EQ(solution.solve.method.rfind("matrix-free conjugate gradients, multigrid", 0), 0U)
      << solution.solve.method;
  EXPECT_NE(without.solver().reason.find("no matrix"), std::string::npos);
  EXPECT_FALSE(without.solver().assembled);
  EXPECT_TRUE(with_matrix.solver().assembled);
  EXPECT_LT(without.solver().operator_bytes, with_matrix.solver().operator_bytes);
  EXPECT_LT(solution.relative_residual, 1e-12);
  EXPECT_LT(solution.solve.residual, 1e-11);
  // A factorisation has the matrix made.
  const Poisson direct(mesh, d, conditions, {.kind = SolverKind::Cholesky});
  EXPECT_LE((direct.solve(f).values - expected.values).norm(), 1e-9 * expected.values.norm());
  EXPECT_TRUE(direct.solver().assembled);
}

TEST(ElementProduct, solves_as_the_matrix_does) {
  const PolygonMesh surface = generate_mesh("plane-voronoi", {.level = 5});
  BoundaryConditions conditions;
  expect_same_solution(surface, "diamond", conditions);  // up to a constant
  const EdgeTopology& edges = surface.edges();
  for (Index e = 0; e < edges.size(); ++e) {
    if (edges.corners.size(e) != 1) continue;
    const Vec3 x = surface.point(edges.vertices[e][0]);
    if (x.x() < 1e-9) {
      conditions.robin_sides.push_back(e);
      conditions.robin_alpha.push_back(1 + x.y());
      conditions.robin_g.push_back(0.5);
    } else {
      conditions.dirichlet_vertices.push_back(edges.vertices[e][1]);
      conditions.dirichlet_values.push_back(1);
    }
  }
  expect_same_solution(surface, "stabilized_diamond", conditions);
  const PolyhedralMesh volume = generate_volume("cube-truncated", {.level = 3});
  conditions = {};
  conditions.dirichlet_vertices = {0, 5, 77};
  conditions.dirichlet_values = {1, 2, 3};
  expect_same_solution(volume, "diamond", conditions);
}

TEST(ElementProduct, is_chosen_where_it_is_faster) {
  const PolygonMesh hexagons = generate_mesh("plane-voronoi", {.level = 5});
  EXPECT_EQ(poisson_form(hexagons, "diamond", {.kind = SolverKind::Cholesky}),
            OperatorForm::Matrices);
  EXPECT_EQ(poisson_form(hexagons, "diamond", {.right_hand_sides = 100}), OperatorForm::Matrices);
  EXPECT_EQ(poisson_form(hexagons, "bunge"), OperatorForm::Matrices);
  EXPECT_EQ(poisson_form(cube(), "diamond"), OperatorForm::Matrices);
  EXPECT_EQ(poisson_form(generate_mesh("plane-triangles", {.level = 5}), "diamond"),
            OperatorForm::Matrices);
  EXPECT_EQ(poisson_form(generate_volume("cube-tets", {.level = 3}), "diamond"),
            OperatorForm::Matrices);
}

TEST(ElementProduct, is_only_had_where_it_is_offered) {
  const DiscretizationOptions products{.form = OperatorForm::Products};
  EXPECT_THROW(discretize(cube(), "bunge", products), InvalidOption);
  EXPECT_THROW(discretize(hex_grid(1), "vem", products), InvalidOption);
  EXPECT_THROW(discretize(cube(), "diamond", products).laplacian(), InvalidOption);
}

}  // namespace
}  // namespace carat::test
