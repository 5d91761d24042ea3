#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carat/apps/heat_geodesics.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"

namespace carat::test {
namespace {

/// The vertex next to a point.
Index nearest(const PolyhedralMesh& mesh, const Vec3& x) {
  Index v = 0;
  (mesh.points().rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff(&v);
  return v;
}

TEST(HeatGeodesicsVolume, error_in_a_cube_falls_with_refinement) {
  for (const char* const family : {"cube-hexahedra", "cube-tets", "cube-truncated"}) {
    double before = 0;
    for (const int level : {0, 1, 2}) {
      const PolyhedralMesh mesh = generate_volume(family, {.level = level});
      const Vec3 lower = mesh.points().colwise().minCoeff();
      const Index source = nearest(mesh, lower);
      const GeodesicDistance distance = HeatGeodesics(mesh, discretize(mesh)).distance(source);
      EXPECT_TRUE(distance.unreachable_vertices.empty());
      EXPECT_EQ(distance.unresolved_samples, 0);
      const Vector exact = (mesh.points().rowwise() - mesh.points().row(source)).rowwise().norm();
      const double rmse =
          std::sqrt((distance.values - exact).squaredNorm() / static_cast<double>(exact.size()));
      RecordProperty(std::string(family) + "_" + std::to_string(level), std::to_string(rmse));
      EXPECT_LT(rmse, level == 0 ? 0.5 : 0.75 * before) << family << " level " << level;
      before = rmse;
    }
    EXPECT_LT(before, 0.1) << family;
  }
}

TEST(HeatGeodesicsVolume, time_step_is_that_of_the_longest_edge) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 1, .jitter = 0.2});
  const Discretization d = discretize(mesh);
  double longest = 0;
  for (const auto& [a, b] : mesh.face_mesh().edges().vertices)
    longest = std::max(longest, (mesh.point(b) - mesh.point(a)).norm());
  EXPECT_DOUBLE_EQ(HeatGeodesics(mesh, d).time_step(), longest * longest);
  EXPECT_LT(HeatGeodesics(mesh, d, {.length = TimeStepLength::MeanEdge}).time_step(),
            longest * longest);
}

TEST(HeatGeodesicsVolume, other_parts_and_loose_vertices_are_unreachable) {
  Points points(9, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1,  //
      5, 0, 0, 6, 0, 0, 5, 1, 0, 5, 0, 1, 9, 9, 9;
  Eigen::Matrix<Index, 2, 4, Eigen::RowMajor> tets;
  tets << 0, 1, 2, 3, 4, 5, 6, 7;
  const PolyhedralMesh mesh = PolyhedralMesh::from_tets(points, tets);
  const GeodesicDistance distance = HeatGeodesics(mesh, discretize(mesh)).distance(4);
  EXPECT_EQ(distance.unreachable_vertices, (std::vector<Index>{0, 1, 2, 3, 8}));
  for (const Index v : distance.unreachable_vertices)
    EXPECT_EQ(distance.values[v], std::numeric_limits<double>::infinity());
  EXPECT_GT(distance.values[5], 0);
}

TEST(HeatGeodesicsVolume, distances_by_iteration_scale_with_the_mesh) {
  for (const char* family : {"cube-hexahedra", "ball-tets-adaptive"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 1, .jitter = 0.1});
    const auto distance = [&](double scale) {
      const PolyhedralMesh scaled(scale * mesh.points(), mesh.face_mesh().faces(), mesh.cells());
      const HeatGeodesics geodesics(scaled, discretize(scaled),
                                    {.solver = {.kind = SolverKind::Multigrid}});
      EXPECT_EQ(geodesics.heat_info().kind, SolverKind::Auto);  // no factorisation
      const GeodesicDistance result = geodesics.distance(0);
      EXPECT_EQ(result.unresolved_samples, 0);
      return Vector(result.values / scale);
    };
    const Vector expected = distance(1);
    for (const double scale : {1e-9, 1e-6, 1e6, 1e9})
      EXPECT_LT((distance(scale) - expected).cwiseAbs().maxCoeff(), 1e-8) << family << scale;
  }
}

TEST(HeatGeodesicsVolume, iterations_give_what_factorisations_give) {
  for (const char* family : {"cube-hexahedra", "ball-tets-adaptive", "cube-voronoi"}) {
    SCOPED_TRACE(family);
    const PolyhedralMesh mesh = generate_volume(family, {.level = 1, .jitter = 0.1});
    const Discretization d = discretize(mesh);
    const HeatGeodesics by_factor(mesh, d, {.solver = {.kind = SolverKind::Cholesky}});
    const HeatGeodesics by_iteration(mesh, d, {.solver = {.kind = SolverKind::Multigrid}});
    EXPECT_EQ(by_factor.heat_info().kind, SolverKind::Cholesky);
    EXPECT_NE(by_iteration.heat_info().method, by_factor.heat_info().method);
    const std::vector<std::vector<GeodesicSource>> sets{{{0}}, {{17}}, {{3}, {40, 2.0}}};
    by_iteration.distances(sets, [&](Index set, GeodesicDistance&& distance) {
      const GeodesicDistance expected = by_factor.distance(sets[set]);
      EXPECT_EQ(distance.unresolved_samples, expected.unresolved_samples);
      EXPECT_LT((distance.values - expected.values).cwiseAbs().maxCoeff(), 1e-8);
      return true;
    });
  }
}

}  // namespace
}  // namespace carat::test
