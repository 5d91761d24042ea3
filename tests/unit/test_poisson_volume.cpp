#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"

namespace carat::test {
namespace {

const DiscretizationOptions kMatrices{.parts = DiscretizationParts::Matrices};

/// u = a . x with the flux of K = tensor through the boundary, on meshes whose boundary is planar.
class PoissonPatch : public testing::TestWithParam<const char*> {
 protected:
  PolyhedralMesh mesh = generate_volume(GetParam(), {.level = 1, .jitter = 0.2});
  Vec3 a{1, -2, 0.5};
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  Vector exact = mesh.points() * a;
  Vector zero = Vector::Zero(mesh.n_vertices());

  /// Outward normal of a boundary face.
  Vec3 normal(Index f) const {
    const auto face = mesh.face(f);
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 0; i + 1 < face.size(); ++i)
      area += (mesh.point(face[i]) - mesh.point(face[0]))
                  .cross(mesh.point(face[i + 1]) - mesh.point(face[0]));
    return (mesh.face_cells()[f].above < 0 ? 1 : -1) * area.normalized();
  }
  /// Visits the boundary faces with K du/dn.
  template <class Visit>
  void for_each_side(const Visit& visit) const {
    for (Index f = 0; f < mesh.n_faces(); ++f)
      if (mesh.face_cells()[f].boundary()) visit(f, normal(f).dot(k * a));
  }
  void check(const Discretization& d, const BoundaryConditions& conditions) const {
    const PoissonSolution s = Poisson(mesh, d, conditions).solve(zero);
    Vector expected = exact;
    if (s.floating_components > 0) {
      const Vector mass = d.lumped_mass();
      expected.array() -= mass.dot(exact) / mass.sum();
    }
    // Rounding, and the affine weights' own 1e-13.
    EXPECT_LT((s.values - expected).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT(s.imbalance, 1e-12);
  }
};

TEST_P(PoissonPatch, dirichlet_data_give_linear_functions) {
  BoundaryConditions c;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[v]) {
      c.dirichlet_vertices.push_back(v);
      c.dirichlet_values.push_back(exact[v]);
    }
  check(discretize(mesh, "diamond", kMatrices), c);
}

TEST_P(PoissonPatch, neumann_data_give_linear_functions) {
  BoundaryConditions c;
  for_each_side([&](Index f, double flux) {
    c.neumann_sides.push_back(f);
    c.neumann_flux.push_back(flux);
  });
  check(discretize(mesh, "diamond", kMatrices), c);
}

TEST_P(PoissonPatch, mixed_data_with_a_tensor_give_linear_functions) {
  k << 2, 0.5, 0.1, 0.5, 1, -0.2, 0.1, -0.2, 3;
  DiscretizationOptions options = kMatrices;
  options.cell_coefficient.resize(mesh.n_cells(), 6);
  for (Index cell = 0; cell < mesh.n_cells(); ++cell)
    options.cell_coefficient.row(cell) << 2, 1, 3, 0.5, -0.2, 0.1;
  BoundaryConditions c;
  for_each_side([&](Index f, double flux) {
    c.neumann_sides.push_back(f);
    c.neumann_flux.push_back(flux);
  });
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.points()(v, 0) == mesh.points().col(0).minCoeff()) {
      c.dirichlet_vertices.push_back(v);
      c.dirichlet_values.push_back(exact[v]);
    }
  ASSERT_FALSE(c.dirichlet_vertices.empty());
  check(discretize(mesh, "diamond", options), c);
}

TEST_P(PoissonPatch, robin_data_of_a_constant_give_it_back) {
  // alpha (u - 5) = 0 on the boundary: exact for any quadrature.
  a.setZero();
  exact.setConstant(5);
  BoundaryConditions c;
  for_each_side([&](Index f, double) {
    c.robin_sides.push_back(f);
    c.robin_alpha.push_back(2 + f % 3);
    c.robin_g.push_back(5.0 * (2 + f % 3));
  });
  check(discretize(mesh, "diamond", kMatrices), c);
}

TEST_P(PoissonPatch, robin_matrix_is_semidefinite_and_sums_to_the_area) {
  BoundaryConditions c;
  for_each_side([&](Index f, double) {
    c.robin_sides.push_back(f);
    c.robin_alpha.push_back(1);
    c.robin_g.push_back(1);
  });
  const BoundaryIntegrals integrals = integrate_boundary(mesh, c);
  EXPECT_NEAR(integrals.load.sum(), 6, 1e-12) << "the unit cube";
  EXPECT_NEAR(integrals.robin.sum(), 6, 1e-12);
  EXPECT_LT(
      (integrals.robin * Vector::Ones(mesh.n_vertices()) - integrals.load).cwiseAbs().maxCoeff(),
      1e-14);
  EXPECT_NEAR(integrals.load.dot(mesh.points().col(0)), 3, 1e-12) << "exact for linear functions";
  const Eigen::SelfAdjointEigenSolver<Matrix> values(Matrix(integrals.robin),
                                                     Eigen::EigenvaluesOnly);
  EXPECT_GT(values.eigenvalues()[0], -1e-15);
  const Matrix inside = Matrix(discretize(mesh, "diamond", kMatrices).stiffness);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (SparseMatrix::InnerIterator entry(integrals.robin, v); entry; ++entry)
      EXPECT_NE(inside(v, entry.col()), 0) << "faces lie in the stiffness' pattern";
}

INSTANTIATE_TEST_SUITE_P(Volumes, PoissonPatch,
                         testing::Values("cube-hexahedra", "cube-voronoi", "cube-truncated",
                                         "cube-tets"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST(PoissonVolume, robin_data_across_planes_of_vertices_give_linear_functions) {
  for (const int level : {0, 1, 2}) {
    const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = level});
    const Vector exact = mesh.points().col(0);
    BoundaryConditions c;
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      if (!mesh.face_cells()[f].boundary()) continue;
      Vec3 centre = Vec3::Zero();
      for (const Index v : mesh.face(f)) centre += mesh.point(v) / mesh.face(f).size();
      const bool low = centre.x() == exact.minCoeff(), high = centre.x() == exact.maxCoeff();
      if (!low && !high) continue;
      c.robin_sides.push_back(f);
      c.robin_alpha.push_back(2);
      c.robin_g.push_back((high ? 1 : -1) + 2 * centre.x());
    }
    const Discretization d = discretize(mesh, "diamond", kMatrices);
    const PoissonSolution s = Poisson(mesh, d, c).solve(Vector::Zero(mesh.n_vertices()));
    EXPECT_EQ(s.floating_components, 0);
    // u and g are constant over each face: exact.
    EXPECT_LT((s.values - exact).cwiseAbs().maxCoeff(), 1e-12) << level;
  }
}

TEST(PoissonVolume, sides_must_be_boundary_faces) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 0});
  const Discretization d = discretize(mesh, "diamond", kMatrices);
  Index inner = 0;
  while (mesh.face_cells()[inner].boundary()) ++inner;
  for (const Index face : {-1, inner, mesh.n_faces()}) {
    BoundaryConditions c;
    c.neumann_sides = {face};
    c.neumann_flux = {1};
    EXPECT_THROW(Poisson(mesh, d, c), InvalidOption) << face;
  }
  BoundaryConditions c;
  for (Index f = 0; f < mesh.n_faces() && c.robin_sides.empty(); ++f)
    if (mesh.face_cells()[f].boundary()) c.robin_sides = {f};
  c.robin_g = {0};
  for (const double alpha : {-1.0, std::numeric_limits<double>::infinity()}) {
    c.robin_alpha = {alpha};
    EXPECT_THROW(Poisson(mesh, d, c), InvalidOption);
  }
}

}  // namespace
}  // namespace carat::test
