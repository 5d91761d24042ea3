#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/operators/registry.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

/// Boundary edges of a grid with the side they lie on: 0 left, 1 right, 2 bottom, 3 top.
struct BoundaryEdges {
  std::vector<Index> edges;
  std::vector<int> sides;
};
BoundaryEdges boundary_edges(const PolygonMesh& mesh, double width) {
  BoundaryEdges out;
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (mesh.edges().corners.size(e) != 1) continue;
    const Vec3 m =
        (mesh.point(mesh.edges().vertices[e][0]) + mesh.point(mesh.edges().vertices[e][1])) / 2;
    out.edges.push_back(e);
    out.sides.push_back(m.x() == 0 ? 0 : m.x() == width ? 1 : m.y() == 0 ? 2 : 3);
  }
  return out;
}

class PoissonTest : public testing::Test {
 protected:
  PolygonMesh mesh = quad_grid(6, 4);
  Discretization d = discretize(mesh);
  Vector x = mesh.points().col(0);
  Vector zero = Vector::Zero(mesh.n_vertices());
};

TEST_F(PoissonTest, dirichlet_data_are_kept_and_linear_functions_reproduced) {
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[v]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(x[v] + 7);
    }
  const PoissonSolution s = Poisson(mesh, d, conditions).solve(zero);
  EXPECT_LT((s.values - x - Vector::Constant(x.size(), 7)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(s.relative_residual, 1e-14);
  EXPECT_EQ(s.floating_components, 0);
}

TEST_F(PoissonTest, neumann_fluxes_drive_a_linear_flow) {
  BoundaryConditions conditions;
  const BoundaryEdges edges = boundary_edges(mesh, 6);
  for (std::size_t k = 0; k < edges.edges.size(); ++k)
    if (edges.sides[k] < 2) {
      conditions.neumann_sides.push_back(edges.edges[k]);
      conditions.neumann_flux.push_back(edges.sides[k] == 1 ? 2 : -2);
    }
  const PoissonSolution s = Poisson(mesh, d, conditions).solve(zero);
  EXPECT_EQ(s.floating_components, 1);
  EXPECT_LT(s.imbalance, 1e-15);
  EXPECT_LT((s.values - 2 * (x.array() - 3).matrix()).cwiseAbs().maxCoeff(), 1e-12)
      << "mean zero by mass";
}

TEST_F(PoissonTest, robin_data_fix_the_constant) {
  // u = x: u_n + alpha u = g with alpha = 2 left and right.
  BoundaryConditions conditions;
  const BoundaryEdges edges = boundary_edges(mesh, 6);
  for (std::size_t k = 0; k < edges.edges.size(); ++k)
    if (edges.sides[k] < 2) {
      conditions.robin_sides.push_back(edges.edges[k]);
      conditions.robin_alpha.push_back(2);
      conditions.robin_g.push_back(edges.sides[k] == 1 ? 1 + 2 * 6 : -1);
    }
  const PoissonSolution s = Poisson(mesh, d, conditions).solve(zero);
  EXPECT_EQ(s.floating_components, 0);
  EXPECT_LT((s.values - x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PoissonTest, data_without_balance_are_refused) {
  EXPECT_THROW(Poisson(mesh, d).solve(Vector::Ones(mesh.n_vertices())), SolverFailure);
}

TEST_F(PoissonTest, loose_vertices_keep_their_value) {
  const PolygonMesh loose = two_components_with_loose_vertices();
  const Discretization dl = discretize(loose);
  BoundaryConditions conditions;
  conditions.dirichlet_vertices = {0, 3};
  conditions.dirichlet_values = {5, 8};
  const PoissonSolution s = Poisson(loose, dl, conditions).solve(Vector::Zero(9));
  EXPECT_EQ(s.values[3], 8);
  EXPECT_EQ(s.values[4], 0);
  EXPECT_NEAR(s.values[1], 5, 1e-13);
  EXPECT_EQ(s.floating_components, 1);
}

TEST_F(PoissonTest, bad_data_are_refused) {
  const auto refused = [&](const BoundaryConditions& c) {
    EXPECT_THROW(Poisson(mesh, d, c), InvalidOption);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BoundaryConditions c;
  c.dirichlet_vertices = {1};
  refused(c);
  c.dirichlet_values = {nan};
  refused(c);
  c.dirichlet_vertices = {mesh.n_vertices()};
  c.dirichlet_values = {0};
  refused(c);
  c.dirichlet_vertices = {1, 1};
  c.dirichlet_values = {0, 1};
  refused(c);
  c = {};
  c.neumann_sides = {mesh.n_edges()};
  c.neumann_flux = {0};
  refused(c);
  for (Index e = 0; e < mesh.n_edges(); ++e)
    if (mesh.edges().corners.size(e) == 2) c.neumann_sides = {e};
  refused(c);
  c = {};
  c.robin_sides = {0};
  c.robin_g = {0};
  c.robin_alpha = {-1};
  refused(c);
  EXPECT_THROW(Poisson(mesh, discretize(quad_grid(1, 1))), InvalidOption);
  BoundaryConditions one;
  one.dirichlet_vertices = {0};
  one.dirichlet_values = {0};
  const Poisson poisson(mesh, d, one);
  EXPECT_THROW(poisson.solve(Vector::Zero(3)), InvalidOption);
  EXPECT_THROW(poisson.solve_integrated(Vector::Constant(mesh.n_vertices(), nan)), InvalidOption);
}

TEST_F(PoissonTest, other_data_reuse_what_solves) {
  const BoundaryEdges edges = boundary_edges(mesh, 6);
  const auto conditions = [&](double value) {
    BoundaryConditions result{.dirichlet_vertices = {0, 5}, .dirichlet_values = {value, -value}};
    for (std::size_t k = 0; k < edges.edges.size(); ++k) {
      (edges.sides[k] == 1 ? result.neumann_sides : result.robin_sides).push_back(edges.edges[k]);
      if (edges.sides[k] == 1) {
        result.neumann_flux.push_back(value);
      } else {
        result.robin_alpha.push_back(2);
        result.robin_g.push_back(value + 1);
      }
    }
    return result;
  };
  const auto shared = std::make_shared<const Discretization>(d);
  const Poisson one(mesh, shared, conditions(1));
  for (const double value : {1.0, -3.0}) {
    const Poisson fresh(mesh, d, conditions(value));
    const Vector u = one.with_data(mesh, conditions(value)).solve(x).values;
    EXPECT_EQ((u - fresh.solve(x).values).cwiseAbs().maxCoeff(), 0);
  }
  BoundaryConditions other = conditions(1);
  other.dirichlet_vertices[1] = 6;
  EXPECT_THROW(one.with_data(mesh, other), InvalidOption);
  other = conditions(1);
  other.robin_alpha[0] = 3;
  EXPECT_THROW(one.with_data(mesh, other), InvalidOption);
  EXPECT_THROW(one.with_data(quad_grid(2, 2), {}), InvalidOption);
}

TEST_F(PoissonTest, error_norms_of_a_known_deviation) {
  const Vector e = Vector::Constant(mesh.n_vertices(), 0.5);
  const ErrorNorms norms = error_norms(d.mass, x + e, x);
  EXPECT_NEAR(norms.rmse, 0.5, 1e-14);
  EXPECT_NEAR(norms.l2, 0.5 * std::sqrt(24.0), 1e-13);
  EXPECT_NEAR(norms.max, 0.5, 1e-14);
  EXPECT_NEAR(error_norms(d.mass, x + e, x, true).max, 0, 1e-14);
  EXPECT_THROW(error_norms(d.mass, x, Vector::Zero(2)), InvalidOption);
}

}  // namespace
}  // namespace carat::test
