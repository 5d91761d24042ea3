// Orders of convergence: slopes of log(error) over log(mean edge length) of the last three of four
// levels, on regular and jittered meshes. Every case prints one line and records its values.

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "carat/apps/heat_geodesics.h"
#include "carat/apps/mean_curvature.h"
#include "carat/apps/poisson.h"
#include "claims/convergence_bounds.h"
#include "support/claim_cases.h"
#include "support/franke.h"
#include "support/measures.h"

namespace carat::test {
namespace {

constexpr int kFirstLevel = 1, kLastLevel = 4;
// Jitter makes another random mesh of every level: slopes scatter by about 0.1.
constexpr double kSecondOrder = 1.8, kSecondOrderJittered = 1.7;

double mean_edge_length(const PolygonMesh& mesh) { return mesh_statistics(mesh).edge_length.mean; }

class Convergence : public testing::TestWithParam<ClaimCase> {
 protected:
  /// Errors over the levels; `error_of(mesh, discretization)` gives one.
  template <class ErrorOf>
  void measure(const ErrorOf& error_of) {
    for (int level = kFirstLevel; level <= kLastLevel; ++level) {
      FamilyOptions options = GetParam().options;
      options.level = level;
      const PolygonMesh mesh = generate_mesh(GetParam().family, options);
      h.push_back(mean_edge_length(mesh));
      error.push_back(error_of(mesh, discretize(mesh, GetParam().entry->name)));
      ASSERT_TRUE(std::isfinite(error.back()));
    }
    slope = log_slope({h.end() - 3, h.end()}, {error.end() - 3, error.end()});
  }
  void report(const char* problem, double bound) {
    const bool jittered = GetParam().options.jitter > 0;
    RecordProperty("slope", std::to_string(slope));
    RecordProperty("bound", std::to_string(bound));
    RecordProperty("last_error", std::to_string(error.back()));
    std::printf("%-10s %-8s %-17s %-8s  errors %.2e %.2e %.2e %.2e  slope %.2f  bound %.2f\n",
                problem, GetParam().entry->name, GetParam().family.c_str(),
                jittered ? "jittered" : "regular", error[0], error[1], error[2], error[3], slope,
                bound);
  }
  void expect_second_order(const char* problem) {
    const double bound = GetParam().options.jitter > 0 ? kSecondOrderJittered : kSecondOrder;
    report(problem, bound);
    EXPECT_GE(slope, bound);
  }
  std::string key() const {
    return std::string(GetParam().entry->name) + " " + GetParam().family +
           (GetParam().options.jitter > 0 ? " jittered" : "");
  }
  void expect_recorded_bound(const char* problem) {
    for (const ConvergenceBound& bound : kConvergenceBounds) {
      if (bound.problem != std::string(problem) || bound.key != key()) continue;
      report(problem, bound.least_slope);
      RecordProperty("reason", bound.reason);
      EXPECT_GE(slope, bound.least_slope);
      EXPECT_LE(error.back(), bound.largest_error) << bound.reason;
      return;
    }
    ADD_FAILURE() << problem << ": no bound is recorded for '" << key() << "'";
  }
  std::vector<double> h, error;
  double slope = 0;
};

std::vector<ClaimCase> convergence_cases(const char* domain) {
  std::vector<ClaimCase> cases;
  for (const SurfaceOperator* entry : surface_operators())
    for (const FamilyEntry& family : mesh_families()) {
      if (std::string(family.domain) != domain || !defined_on(*entry, family.name)) continue;
      cases.push_back({entry, family.name, {.level = kLastLevel}});
      cases.push_back({entry, family.name, {.level = kLastLevel, .jitter = kJitter}});
    }
  return cases;
}

/// Those for which convergence_bounds.h records orders: curvature and geodesics converge as they
/// may, not at an order that somebody promises.
std::vector<ClaimCase> bounded_cases() {
  std::vector<ClaimCase> cases;
  for (const ClaimCase& c : convergence_cases("unit sphere"))
    for (const char* name : {"diamond", "bunge", "cotan"})
      if (c.entry->name == std::string(name)) cases.push_back(c);
  return cases;
}

Vector values_at(const PolygonMesh& mesh, double (*function)(const Vec3&)) {
  Vector values(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v) values[v] = function(mesh.point(v));
  return values;
}

class PoissonFull : public Convergence {};

TEST_P(PoissonFull, franke_on_the_square) {
  measure([](const PolygonMesh& mesh, const Discretization& d) {
    const Vector exact = values_at(mesh, franke);
    BoundaryConditions conditions;
    const std::vector<bool> boundary = boundary_vertices(mesh);
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      if (boundary[v]) {
        conditions.dirichlet_vertices.push_back(v);
        conditions.dirichlet_values.push_back(exact[v]);
      }
    const PoissonSolution solution =
        Poisson(mesh, d, conditions).solve(-values_at(mesh, franke_laplacian));
    return error_norms(d.mass, solution.values, exact).rmse;
  });
  expect_second_order("poisson");
}

INSTANTIATE_TEST_SUITE_P(Claims, PoissonFull, testing::ValuesIn(convergence_cases("unit square")),
                         case_name);

double third_harmonic(const Vec3& x) {
  return x.y() * (4 * x.z() * x.z() - x.x() * x.x() - x.y() * x.y());
}
constexpr double kThirdEigenvalue = 12;

class HarmonicsFull : public Convergence {};

TEST_P(HarmonicsFull, third_degree_on_the_sphere) {
  measure([](const PolygonMesh& mesh, const Discretization& d) {
    const Vector y = values_at(mesh, third_harmonic);
    const PoissonSolution solution = Poisson(mesh, d).solve(y);
    Vector e = solution.values - y / kThirdEigenvalue;
    e.array() -= e.mean();
    return std::sqrt(e.squaredNorm() / mesh.n_vertices());
  });
  expect_second_order("harmonic");
}

INSTANTIATE_TEST_SUITE_P(Claims, HarmonicsFull, testing::ValuesIn(convergence_cases("unit sphere")),
                         case_name);

class CurvatureFull : public Convergence {};

TEST_P(CurvatureFull, unit_sphere) {
  measure([](const PolygonMesh& mesh, const Discretization& d) {
    const Vector e = mean_curvature(mesh, d, true).values - Vector::Ones(mesh.n_vertices());
    return std::sqrt(e.squaredNorm() / mesh.n_vertices());
  });
  expect_recorded_bound("curvature");
}

INSTANTIATE_TEST_SUITE_P(Claims, CurvatureFull, testing::ValuesIn(bounded_cases()), case_name);

class GeodesicsFull : public Convergence {
 protected:
  void measure_distances(double t_coef) {
    measure([t_coef](const PolygonMesh& mesh, const Discretization& d) {
      const Vector distance = HeatGeodesics(mesh, d, {.t_coef = t_coef}).distance(0).values;
      double sum = 0;
      for (Index v = 0; v < mesh.n_vertices(); ++v) {
        const Vec3 source = mesh.point(0), x = mesh.point(v);
        const double exact = std::atan2(source.cross(x).norm(), source.dot(x));
        sum += (distance[v] - exact) * (distance[v] - exact);
      }
      return std::sqrt(sum / mesh.n_vertices());
    });
  }
};

TEST_P(GeodesicsFull, unit_sphere) {
  measure_distances(1);
  expect_recorded_bound("geodesics");
}

TEST_P(GeodesicsFull, unit_sphere_with_a_long_time_step) {
  // The smoothing of a time t costs an error of the order sqrt(t), h here: first order.
  constexpr double kFirstOrder = 0.6;
  measure_distances(16);
  report("geodes.16", kFirstOrder);
  EXPECT_GE(slope, kFirstOrder);
  EXPECT_TRUE(std::is_sorted(error.rbegin(), error.rend()));
}

INSTANTIATE_TEST_SUITE_P(Claims, GeodesicsFull, testing::ValuesIn(bounded_cases()), case_name);

TEST(Franke, laplacian_agrees_with_finite_differences) {
  // Central differences of step s are exact to s^2 f''''/12 ~ 1e-4 * 1e4 / 12 relative to f'' ~
  // 100.
  const double s = 1e-3;
  for (double x = 0.05; x < 1; x += 0.1)
    for (double y = 0.05; y < 1; y += 0.1) {
      const auto f = [&](double dx, double dy) { return franke(Vec3(x + dx, y + dy, 0)); };
      const double estimate = (f(s, 0) + f(-s, 0) + f(0, s) + f(0, -s) - 4 * f(0, 0)) / (s * s);
      EXPECT_NEAR(franke_laplacian(Vec3(x, y, 0)), estimate, 0.01);
    }
  EXPECT_NEAR(franke(Vec3(0.5, 0.5, 0)),
              0.75 * std::exp(-(2.5 * 2.5 + 2.5 * 2.5) / 4) +
                  0.75 * std::exp(-5.5 * 5.5 / 49 - 0.55) +
                  0.5 * std::exp(-(2.5 * 2.5 + 1.5 * 1.5) / 4) - 0.2 * std::exp(-0.25 - 6.25),
              1e-15);
}

}  // namespace
}  // namespace carat::test
