#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carat/apps/heat_geodesics.h"
#include "carat/base/error.h"
#include "carat/operators/registry.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

TEST(HeatGeodesics, distance_on_a_flat_grid) {
  const PolygonMesh mesh = quad_grid(30, 30);
  const HeatGeodesics geodesics(mesh, discretize(mesh));
  EXPECT_DOUBLE_EQ(geodesics.time_step(), 1);
  const Index source = 15 * 31 + 15;
  const GeodesicDistance distance = geodesics.distance(source);
  EXPECT_EQ(distance.values[source], 0);
  EXPECT_TRUE(distance.unreachable_vertices.empty());
  double worst = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    worst =
        std::max(worst, std::abs(distance.values[v] - (mesh.point(v) - mesh.point(source)).norm()));
  // The smoothing of t = h^2 and the natural boundary cost about an edge length.
  EXPECT_LT(worst, 1.5);
}

TEST(HeatGeodesics, several_sources_give_the_nearest) {
  const PolygonMesh mesh = quad_grid(40, 2);
  const HeatGeodesics geodesics(mesh, discretize(mesh));
  const Vector d = geodesics.distance({{0}, {40, 3.0}, {82}, {122}}).values;
  for (Index i = 5; i <= 35; ++i) EXPECT_NEAR(d[41 + i], std::min(i, 40 - i), 1.5);
}

TEST(HeatGeodesics, other_components_are_unreachable) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const HeatGeodesics geodesics(mesh, discretize(mesh));
  const GeodesicDistance distance = geodesics.distance(6);
  EXPECT_EQ(distance.unreachable_vertices, (std::vector<Index>{0, 1, 2, 3, 4}));
  for (const Index v : distance.unreachable_vertices)
    EXPECT_EQ(distance.values[v], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(distance.values[6], 0, 1e-14);
  EXPECT_GT(distance.values[8], distance.values[7]);
}

TEST(HeatGeodesics, options_and_sources_are_checked) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const Discretization d = discretize(mesh);
  EXPECT_THROW(HeatGeodesics(mesh, d, {.t_coef = 0}), InvalidOption);
  EXPECT_THROW(HeatGeodesics(mesh, d, {.t_coef = std::nan("")}), InvalidOption);
  EXPECT_THROW(HeatGeodesics(quad_grid(1, 1), d), InvalidOption);
  EXPECT_THROW(
      HeatGeodesics(mesh, discretize(mesh, "diamond", {.parts = DiscretizationParts::Matrices})),
      InvalidOption);
  const HeatGeodesics geodesics(mesh, d);
  for (const Index source : {-1, 9, 3}) EXPECT_THROW(geodesics.distance(source), InvalidOption);
  EXPECT_THROW(geodesics.distance(std::vector<GeodesicSource>{}), InvalidOption);
  EXPECT_THROW(geodesics.distance({{0, -1.0}}), InvalidOption);
}

TEST(HeatGeodesics, mean_edge_length_shortens_the_time_step) {
  const PolygonMesh mesh = l_shaped_grid(3);
  const Discretization d = discretize(mesh);
  const double longest = HeatGeodesics(mesh, d).time_step();
  EXPECT_NEAR(longest, 0.64, 1e-12);
  EXPECT_LT(HeatGeodesics(mesh, d, {.length = TimeStepLength::MeanEdge}).time_step(), longest);
}

}  // namespace
}  // namespace carat::test
