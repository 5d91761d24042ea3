// -div(K grad u) with a scalar K.

#include <gtest/gtest.h>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "support/claim_cases.h"
#include "support/measures.h"

namespace carat::test {
namespace {

DiscretizationOptions with_coefficient(std::function<double(const Vec3&)> k) {
  DiscretizationOptions options;
  options.coefficient = std::move(k);
  return options;
}

class Coefficient : public testing::TestWithParam<const SurfaceOperator*> {
 protected:
  PolygonMesh mesh(int level) const {
    return generate_mesh(GetParam()->claims.simplices_only ? "plane-triangles" : "plane-voronoi",
                         {.level = level, .jitter = 0.2});
  }
};

TEST_P(Coefficient, a_constant_of_two_doubles_the_stiffness_to_the_last_bit) {
  const PolygonMesh m = mesh(0);
  const Discretization one = discretize(m, GetParam()->name);
  const Discretization two =
      discretize(m, GetParam()->name, with_coefficient([](const Vec3&) { return 2.0; }));
  EXPECT_TRUE(same_bits(two.stiffness, SparseMatrix(one.stiffness * 2)));
  EXPECT_TRUE(same_bits(two.mass, one.mass));
  EXPECT_TRUE(same_bits(two.gradient, one.gradient));
}

TEST_P(Coefficient, a_variable_one_converges_at_second_order) {
  // u = sin 2x cos y with K = 1 + x + y^2 / 2: -div(K grad u) = 5 K u - K_x u_x - K_y u_y.
  const auto k = [](const Vec3& p) { return 1 + p.x() + p.y() * p.y() / 2; };
  std::vector<double> h, error;
  for (const int level : {1, 2, 3}) {
    const PolygonMesh m = mesh(level);
    const Discretization d = discretize(m, GetParam()->name, with_coefficient(k));
    Vector exact(m.n_vertices()), f(m.n_vertices());
    BoundaryConditions conditions;
    const std::vector<bool> boundary = boundary_vertices(m);
    for (Index v = 0; v < m.n_vertices(); ++v) {
      const Vec3 p = m.point(v);
      exact[v] = std::sin(2 * p.x()) * std::cos(p.y());
      f[v] = 5 * k(p) * exact[v] - 2 * std::cos(2 * p.x()) * std::cos(p.y()) +
             p.y() * std::sin(2 * p.x()) * std::sin(p.y());
      if (!boundary[v]) continue;
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(exact[v]);
    }
    const Vector u = Poisson(m, d, conditions).solve(f).values;
    h.push_back(mesh_statistics(m).edge_length.mean);
    error.push_back(error_norms(d.mass, u, exact).rmse);
  }
  RecordProperty("slope", std::to_string(log_slope(h, error)));
  EXPECT_GE(log_slope(h, error), 1.8);
}

TEST_P(Coefficient, values_that_are_not_positive_and_finite_are_refused) {
  const PolygonMesh m = mesh(0);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()})
    EXPECT_THROW(discretize(m, GetParam()->name, with_coefficient([bad](const Vec3& p) {
                              return p.x() > 0.5 ? bad : 1.0;
                            })),
                 InvalidOption)
        << bad;
}

INSTANTIATE_TEST_SUITE_P(Operators, Coefficient, testing::ValuesIn(surface_operators()),
                         [](const testing::TestParamInfo<const SurfaceOperator*>& entry) {
                           return std::string(entry.param->name);
                         });

}  // namespace
}  // namespace carat::test
