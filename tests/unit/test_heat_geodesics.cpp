#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <limits>

#include "carat/apps/heat_geodesics.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
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

TEST(HeatGeodesics, directions_of_elements_need_to_know_the_jumps) {
  const PolygonMesh mesh = quad_grid(3, 3);
  const auto make = [&](const char* name, DiscretizationParts parts) {
    return HeatGeodesics(mesh, discretize(mesh, name, {.parts = parts}),
                         {.directions = HeatDirections::Elements});
  };
  EXPECT_THROW(make("diamond", DiscretizationParts::Frames), InvalidOption);
  EXPECT_THROW(make("alexa_wardetzky", DiscretizationParts::Frames), InvalidOption);
  EXPECT_THROW(make("stabilized_diamond", DiscretizationParts::Gradient), InvalidOption);
  EXPECT_NO_THROW(make("stabilized_diamond", DiscretizationParts::Frames));
  EXPECT_NO_THROW(make("bunge", DiscretizationParts::Frames));
}

TEST(HeatGeodesics, divergence_of_element_directions_is_that_on_virtual_triangles) {
  // bunge's samples are the virtual triangles themselves: the same field has the same divergence
  // there, whatever theta is.
  for (const char* family : {"plane-concave", "sphere-hexagons", "sphere-concave"}) {
    const PolygonMesh mesh = generate_mesh(family, {.level = 1, .jitter = 0.2});
    const Vector u = (mesh.points() * Vec3(1, -2, 0.5)).array().sin();
    const Discretization bunge = discretize(mesh, "bunge", {.parts = DiscretizationParts::Frames});
    for (const double theta : {0.0, 0.6}) {
      const Discretization d = discretize(mesh, "stabilized_diamond",
                                          {.theta = theta, .parts = DiscretizationParts::Frames});
      const Vector directions = d.element_directions(d.gradient * u);
      const Points field = [&] {
        Points x = d.element_vectors(d.gradient * u, mesh.n_faces());
        x.rowwise().normalize();
        return x;
      }();
      Vector on_triangles(bunge.gradient.rows());
      for (std::size_t k = 0; k < bunge.frames.parts.size(); ++k) {
        const GradientFrames::Part& part = bunge.frames.parts[k];
        on_triangles.segment<3>(bunge.first_row(part.sample)) = field.row(part.element).transpose();
      }
      const Vector expected = bunge.apply_divergence(on_triangles);
      EXPECT_LT((d.apply_divergence(directions) - expected).lpNorm<Eigen::Infinity>(),
                1e-12 * expected.lpNorm<Eigen::Infinity>())
          << family << " theta " << theta;
    }
  }
}

TEST(HeatGeodesics, directions_of_elements_keep_converging_on_concave_faces) {
  // Directions of samples stall there: their error falls by a factor of .95 in this step.
  double previous = 0;
  for (const int level : {3, 4}) {
    const PolygonMesh mesh = generate_mesh("sphere-concave", {.level = level});
    const HeatGeodesics geodesics(mesh,
                                  discretize(mesh, "stabilized_diamond",
                                             {.theta = 0.6, .parts = DiscretizationParts::Frames}),
                                  {.directions = HeatDirections::Elements});
    const Vector distance = geodesics.distance(0).values;
    double sum = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const Vec3 a = mesh.point(0), b = mesh.point(v);
      sum += std::pow(distance[v] - std::atan2(a.cross(b).norm(), a.dot(b)), 2);
    }
    const double error = std::sqrt(sum / mesh.n_vertices());
    std::printf("sphere-concave level %d: %.2e\n", level, error);
    if (previous > 0) {
      EXPECT_LT(error, 0.75 * previous);
    }
    previous = error;
  }
}

TEST(HeatGeodesics, distances_scale_with_the_mesh) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 2, .jitter = 0.2});
  const auto distance = [&](double scale) {
    const PolygonMesh scaled(scale * mesh.points(), mesh.faces());
    return Vector(HeatGeodesics(scaled, discretize(scaled)).distance(0).values / scale);
  };
  const Vector expected = distance(1);
  for (const double scale : {1e-9, 1e-6, 1e6, 1e9})
    EXPECT_LT((distance(scale) - expected).cwiseAbs().maxCoeff(), 1e-8) << scale;
}

TEST(HeatGeodesics, mean_edge_length_shortens_the_time_step) {
  const PolygonMesh mesh = l_shaped_grid(3);
  const Discretization d = discretize(mesh);
  const double longest = HeatGeodesics(mesh, d).time_step();
  EXPECT_NEAR(longest, 0.64, 1e-12);
  EXPECT_LT(HeatGeodesics(mesh, d, {.length = TimeStepLength::MeanEdge}).time_step(), longest);
}

/// Sources of all kinds on the first vertices of a mesh.
std::vector<std::vector<GeodesicSource>> source_sets(Index n, Index stride) {
  std::vector<std::vector<GeodesicSource>> sets;
  for (Index k = 0; k < n; ++k) sets.push_back({{stride * k}});
  sets[2].push_back({stride * 7, 3.0});
  sets[5] = sets[2];
  return sets;
}

void expect_same(const GeodesicDistance& a, const GeodesicDistance& b, double tolerance) {
  EXPECT_EQ(a.unreachable_vertices, b.unreachable_vertices);
  EXPECT_EQ(a.unresolved_samples, b.unresolved_samples);
  ASSERT_EQ(a.values.size(), b.values.size());
  for (Index v = 0; v < a.values.size(); ++v) {
    if (std::isinf(a.values[v])) {
      EXPECT_EQ(a.values[v], b.values[v]);
    } else {
      EXPECT_NEAR(a.values[v], b.values[v], tolerance);
    }
  }
}

TEST(HeatGeodesics, many_source_sets_give_what_each_gives_by_itself) {
  const PolygonMesh mesh = generate_mesh("sphere-concave", {.level = 1});
  for (const HeatDirections directions : {HeatDirections::Samples, HeatDirections::Elements})
    for (const SolverKind kind : {SolverKind::Auto, SolverKind::Multigrid}) {
      const HeatGeodesics geodesics(
          mesh, discretize(mesh, "stabilized_diamond", {.parts = DiscretizationParts::Frames}),
          {.directions = directions, .solver = {.kind = kind, .threads = 2}});
      const auto sets = source_sets(21, 3);
      Index next = 0;
      geodesics.distances(sets, [&](Index set, GeodesicDistance&& distance) {
        EXPECT_EQ(set, next++);
        expect_same(distance, geodesics.distance(sets[set]), 1e-9);
        return true;
      });
      EXPECT_EQ(next, 21);
    }
}

TEST(HeatGeodesics, many_source_sets_reach_their_own_components) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const HeatGeodesics geodesics(mesh, discretize(mesh));
  std::vector<std::vector<GeodesicSource>> sets{{{0}}, {{6}}, {{1}, {8, 2.0}}};
  geodesics.distances(sets, [&](Index set, GeodesicDistance&& distance) {
    expect_same(distance, geodesics.distance(sets[set]), 1e-12);
    EXPECT_EQ(distance.unreachable_vertices.size(), set == 0 ? 6u : set == 1 ? 5u : 2u);
    return true;
  });
  sets[1].clear();
  const auto none = [](Index, GeodesicDistance&&) {
    ADD_FAILURE() << "solved before the sources are checked";
    return true;
  };
  EXPECT_THROW(geodesics.distances(sets, none), InvalidOption);
  sets[1] = {{3}};
  try {
    geodesics.distances(sets, none);
    ADD_FAILURE();
  } catch (const InvalidOption& error) {
    EXPECT_NE(std::string(error.what()).find("source set 1: source vertex 3"), std::string::npos)
        << error.what();
  }
}

TEST(HeatGeodesics, many_source_sets_do_not_depend_on_threads_and_can_be_ended) {
  const PolygonMesh mesh = quad_grid(25, 25);
  const auto sets = source_sets(30, 11);
  std::vector<Vector> one;
  for (const int threads : {1, 2, 3}) {
    const HeatGeodesics geodesics(mesh, discretize(mesh), {.solver = {.threads = threads}});
    geodesics.distances(sets, [&](Index set, GeodesicDistance&& distance) {
      if (threads == 1) {
        one.push_back(distance.values);
      } else {
        EXPECT_EQ(distance.values, one[static_cast<std::size_t>(set)]);
      }
      return true;
    });
    Index calls = 0;
    geodesics.distances(sets, [&](Index, GeodesicDistance&&) { return ++calls < 10; });
    EXPECT_EQ(calls, 10);
  }
}

}  // namespace
}  // namespace carat::test
