// Discrete duality finite volumes, ceve and cevefe: unknowns, counts, kernels, and Poisson's
// equation with unknowns beyond the vertices.

#include <gtest/gtest.h>

#include <cstdio>

#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "support/franke.h"
#include "support/volume_measures.h"

namespace carat::test {
namespace {

PolyhedralMesh grid(int n) {
  Points points((n + 1) * (n + 1) * (n + 1), 3);
  std::vector<std::array<Index, 8>> hexes;
  const auto number = [&](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.row(number(i, j, k)) = Eigen::RowVector3d(i, j, k) / n;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        hexes.push_back({number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k),
                         number(i, j + 1, k), number(i, j, k + 1), number(i + 1, j, k + 1),
                         number(i + 1, j + 1, k + 1), number(i, j + 1, k + 1)});
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> cells(
      static_cast<Eigen::Index>(hexes.size()), 8);
  for (Eigen::Index c = 0; c < cells.rows(); ++c)
    for (int v = 0; v < 8; ++v)
      cells(c, v) = hexes[static_cast<std::size_t>(c)][static_cast<std::size_t>(v)];
  return PolyhedralMesh::from_hexes(points, cells);
}

std::int64_t entries(const SparseMatrix& s) {
  const double noise = 1e-12 * max_abs(s);
  std::int64_t n = 0;
  for (Index row = 0; row < s.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(s, row); entry; ++entry)
      n += std::abs(entry.value()) > noise;
  return n;
}

Index kernel_dimension(const SparseMatrix& s) {
  const Vector values = relative_eigenvalues(s);
  EXPECT_GT(values[0], -1e-13);
  // The lowest others are of the order of (h / diameter)^2.
  return static_cast<Index>((values.array() < 1e-10).count());
}

Points unknown_points(const PolyhedralMesh& mesh, const Discretization& d) {
  Points points(d.n_unknowns(), 3);
  points << mesh.points(), d.extra.positions;
  return points;
}

const DiscretizationOptions kMatrices{.parts = DiscretizationParts::Matrices};

TEST(Ddfv, counts_of_non_zeros_on_cartesian_grids) {
  const struct {
    int n;
    std::int64_t ceve, cevefe;
  } expected[] = {{4, 2413, 3729}, {8, 15081, 26081}, {16, 101953, 194241}};
  for (const auto& e : expected) {
    EXPECT_EQ(entries(discretize(grid(e.n), "ceve", kMatrices).stiffness), e.ceve);
    EXPECT_EQ(entries(discretize(grid(e.n), "cevefe", kMatrices).stiffness), e.cevefe);
  }
}

TEST(Ddfv, unknowns_beyond_the_vertices) {
  const PolyhedralMesh mesh = generate_volume("cube-prisms", {.level = 0});
  Index n_boundary = 0;
  for (const FaceCells& cells : mesh.face_cells()) n_boundary += cells.boundary();
  const Discretization ceve = discretize(mesh, "ceve");
  EXPECT_EQ(ceve.n_vertices(), mesh.n_vertices());
  EXPECT_EQ(ceve.extra.size(), mesh.n_cells());
  EXPECT_EQ(ceve.extra.boundary_vertices.indices.size(), 0u);
  const Discretization kept = discretize(mesh, "ceve", {.boundary_unknowns = true});
  ASSERT_EQ(kept.extra.blocks.size(), 2u);
  ASSERT_EQ(kept.extra.blocks[1].elements.size(), static_cast<std::size_t>(n_boundary));
  const Index f = kept.extra.blocks[1].elements[0], k = mesh.n_cells();
  Vec3 mean = Vec3::Zero();
  for (const Index v : mesh.face(f))
    mean += mesh.point(v) / static_cast<double>(mesh.face(f).size());
  EXPECT_LT((kept.extra.positions.row(k).transpose() - mean).norm(), 1e-15);
  EXPECT_TRUE(std::equal(mesh.face(f).begin(), mesh.face(f).end(),
                         kept.extra.boundary_vertices.row(k).begin()));
  const Discretization cevefe = discretize(mesh, "cevefe");
  EXPECT_EQ(cevefe.extra.size(), mesh.n_faces() + mesh.n_cells() + mesh.n_edges());
  const Discretization inner = discretize(mesh, "cevefe", {.boundary_unknowns = false});
  EXPECT_EQ(inner.extra.boundary_vertices.indices.size(), 0u);
  EXPECT_EQ(inner.extra.blocks[0].elements.size(),
            static_cast<std::size_t>(mesh.n_faces() - n_boundary));
}

TEST(Ddfv, dimensions_of_the_kernel) {
  // All faces even: a checkerboard beside the constants, in the kept boundary values a third one.
  for (const PolyhedralMesh& mesh :
       {generate_volume("cube-hexahedra", {.level = 0, .jitter = 0.2}), grid(3)}) {
    EXPECT_EQ(kernel_dimension(discretize(mesh, "ceve", kMatrices).stiffness), 2);
    EXPECT_EQ(kernel_dimension(discretize(mesh, "ceve", {.boundary_unknowns = true}).stiffness), 3);
  }
  for (const char* family : {"cube-tets", "cube-pyramids", "cube-prisms", "cube-truncated"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 0, .jitter = 0.2});
    EXPECT_EQ(kernel_dimension(discretize(mesh, "ceve", kMatrices).stiffness), 1) << family;
    EXPECT_EQ(kernel_dimension(discretize(mesh, "ceve", {.boundary_unknowns = true}).stiffness), 2)
        << family;
  }
  for (const char* family : {"cube-hexahedra", "cube-tets", "cube-prisms"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 0, .jitter = 0.2});
    EXPECT_EQ(kernel_dimension(discretize(mesh, "cevefe", kMatrices).stiffness), 2) << family;
    EXPECT_EQ(kernel_dimension(discretize(mesh, "cevefe", {.boundary_unknowns = false}).stiffness),
              1)
        << family;
  }
}

TEST(Ddfv, weights_give_the_laplacian_of_squares_inside_cartesian_grids) {
  const int n = 6;
  const PolyhedralMesh mesh = grid(n);
  for (const char* name : {"ceve", "cevefe"}) {
    const Discretization d = discretize(mesh, name, kMatrices);
    const Points x = unknown_points(mesh, d);
    const Vector residual = d.stiffness * x.rowwise().squaredNorm() + 6 * d.mass.diagonal();
    Index checked = 0;
    for (Index i = 0; i < d.n_unknowns(); ++i) {
      if (x.row(i).minCoeff() < 1.2 / n || x.row(i).maxCoeff() > 1 - 1.2 / n) continue;
      ++checked;
      EXPECT_LT(std::abs(residual[i]), 1e-13) << name << ", unknown " << i;
    }
    EXPECT_GT(checked, 50);
    EXPECT_NEAR(total(d.mass), 1, 1e-13);
  }
}

double franke_error(const std::string& family, int level, const char* name) {
  const PolyhedralMesh mesh = generate_volume(family, {.level = level});
  const Discretization d = discretize(mesh, name, kMatrices);
  const Points x = unknown_points(mesh, d);
  Vector f(d.n_unknowns());
  for (Index i = 0; i < d.n_unknowns(); ++i) f[i] = -franke_3d_laplacian(x.row(i).transpose());
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  double squares = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[static_cast<std::size_t>(v)]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(franke_3d(mesh.point(v)));
    }
  conditions.dirichlet_function = franke_3d;
  const Vector u = Poisson(mesh, d, conditions).solve(f).values;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    squares += std::pow(u[v] - franke_3d(mesh.point(v)), 2);
  return std::sqrt(squares / mesh.n_vertices());
}

TEST(DdfvFull, second_order_at_the_vertices) {
  for (const char* name : {"ceve", "cevefe"})
    for (const char* family :
         {"cube-hexahedra", "cube-tets", "cube-prisms", "cube-pyramids", "cube-truncated"}) {
      const double coarse = franke_error(family, 1, name), fine = franke_error(family, 2, name);
      const double order = std::log2(coarse / fine);
      std::printf("%-7s %-15s errors %.2e %.2e, order %.2f\n", name, family, coarse, fine, order);
      EXPECT_GT(order, 1.6) << name << " " << family;
    }
}

TEST(Ddfv, linear_functions_are_solved_exactly) {
  const PolyhedralMesh mesh = generate_volume("cube-voronoi", {.level = 0});
  const auto linear = [](const Vec3& x) { return 2 + x.x() - 3 * x.y() + 0.5 * x.z(); };
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[static_cast<std::size_t>(v)]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(linear(mesh.point(v)));
    }
  for (const char* name : {"ceve", "cevefe"})
    for (const bool keep : {false, true}) {
      const Discretization d = discretize(mesh, name, {.boundary_unknowns = keep});
      // Means of vertices are values of linear functions, so the function may be missing.
      const Vector u = Poisson(mesh, d, conditions).solve(Vector::Zero(d.n_unknowns())).values;
      const Points x = unknown_points(mesh, d);
      for (Index i = 0; i < d.n_unknowns(); ++i)
        EXPECT_NEAR(u[i], linear(x.row(i).transpose()), 1e-10) << name << " " << keep;
    }
}

TEST(Ddfv, singular_problems_are_refused) {
  const PolyhedralMesh hexahedra = generate_volume("cube-hexahedra", {.level = 0, .jitter = 0.2});
  const PolyhedralMesh tets = generate_volume("cube-tets", {.level = 0, .jitter = 0.2});
  // The checkerboard.
  EXPECT_THROW(Poisson(hexahedra, discretize(hexahedra, "ceve")), SolverFailure);
  EXPECT_NO_THROW(Poisson(tets, discretize(tets, "ceve")));
  // The second null vector of the kept boundary values.
  for (const PolyhedralMesh* mesh : {&hexahedra, &tets}) {
    EXPECT_THROW(Poisson(*mesh, discretize(*mesh, "cevefe")), SolverFailure);
    EXPECT_NO_THROW(Poisson(*mesh, discretize(*mesh, "cevefe", {.boundary_unknowns = false})));
  }
  // Data at one vertex fix constants, not that.
  BoundaryConditions one;
  one.dirichlet_vertices = {0};
  one.dirichlet_values = {0};
  EXPECT_THROW(Poisson(tets, discretize(tets, "cevefe"), one), SolverFailure);
}

TEST(Ddfv, applications_between_vertices_refuse) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 0});
  for (const char* name : {"ceve", "cevefe"}) {
    EXPECT_THROW(eigenmodes(discretize(mesh, name), 3), InvalidOption);
    EXPECT_THROW(HeatGeodesics(mesh, discretize(mesh, name)), InvalidOption);
    EXPECT_THROW(discretize(mesh, name, {.mass = MassKind::Full}), InvalidOption);
  }
}

TEST(Ddfv, tensors_and_functions_scale_the_stiffness) {
  const PolyhedralMesh mesh = generate_volume("cube-prisms", {.level = 0, .jitter = 0.2});
  for (const char* name : {"ceve", "cevefe"}) {
    const Discretization d = discretize(mesh, name);
    DiscretizationOptions options;
    options.cell_coefficient = Matrix::Zero(mesh.n_cells(), 6);
    options.cell_coefficient.leftCols(3).setConstant(3);
    options.coefficient = [](const Vec3&) { return 2.0; };
    const Discretization scaled = discretize(mesh, name, options);
    EXPECT_LT(difference(scaled.stiffness, SparseMatrix(6 * d.stiffness)), 1e-14);
    EXPECT_TRUE(same_bits(scaled.gradient, d.gradient));
    EXPECT_TRUE(same_bits(discretize(mesh, name, {.threads = 3}).stiffness, d.stiffness));
  }
}

TEST(Ddfv, degenerate_cells_are_left_out) {
  const PolyhedralMesh mesh = grid(2);
  Points flat = mesh.points();
  flat.col(2).setZero();
  for (const char* name : {"ceve", "cevefe"}) {
    const Discretization d = discretize(mesh.with_points(flat), name);
    EXPECT_EQ(d.diagnostics.count("excluded_samples"), d.n_samples());
    EXPECT_TRUE(all_finite(d.stiffness));
    EXPECT_TRUE(all_finite(d.gradient));
    EXPECT_EQ(max_abs(d.stiffness), 0);
    EXPECT_THROW(discretize(mesh.with_points(flat), name, {.degenerate = DegeneratePolicy::Strict}),
                 DegenerateElement);
  }
}

}  // namespace
}  // namespace carat::test
