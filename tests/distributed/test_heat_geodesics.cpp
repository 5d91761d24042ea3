#include "carat/distributed/heat_geodesics.h"
#include "parts.h"

namespace carat::test {
namespace {

template <class Mesh>
void check(const Mesh& mesh, const MeshPart<Mesh>& part, const std::string& name,
           const std::vector<GeodesicSource>& sources, const HeatGeodesicsOptions& options = {}) {
  const DiscretizationOptions frames{.parts = DiscretizationParts::Frames};
  const HeatGeodesics whole_geodesics(mesh, discretize(mesh, name, frames), options);
  const GeodesicDistance expected = whole_geodesics.distance(sources);
  const DistributedGeodesics geodesics(part, discretize_part(part, name, frames), options);
  EXPECT_NEAR(geodesics.time_step(), whole_geodesics.time_step(),
              1e-13 * whole_geodesics.time_step());
  GeodesicDistance distance = geodesics.distance(sources);
  EXPECT_EQ(distance.unresolved_samples, expected.unresolved_samples);
  Vector whole = expected.values;
  std::vector<Index> unreachable;
  for (const Index v : part.numbers.vertices)
    if (std::isinf(whole[v])) unreachable.push_back(v);
  EXPECT_EQ(distance.unreachable_vertices, unreachable);
  for (double& value : whole) value = std::isinf(value) ? -1 : value;
  for (double& value : distance.values) value = std::isinf(value) ? -1 : value;
  // Heat is accurate to 1e-10 in every component.
  EXPECT_LT(difference(distance.values, whole, part.numbers), 1e-9);
}

TEST(DistributedGeodesics, surfaces_as_in_one_process) {
  for (const char* family : {"plane-triangles", "sphere-hexagons", "plane-concave"}) {
    SCOPED_TRACE(family);
    const PolygonMesh mesh = generate_mesh(family, {.level = 2, .jitter = 0.1});
    for (const char* name : {"diamond", "stabilized_diamond", "bunge"})
      check(mesh, own_block(mesh), name, {{3}, {mesh.n_vertices() - 1, 0.5}});
  }
}

TEST(DistributedGeodesics, volumes_as_in_one_process) {
  for (const char* family : {"cube-tets", "ball-voronoi"}) {
    SCOPED_TRACE(family);
    const PolyhedralMesh mesh = generate_volume(family, {.level = 1, .jitter = 0.1});
    for (const char* name : {"diamond", "stabilized_diamond"})
      check(mesh, own_block(mesh), name, {{3}});
  }
}

TEST(DistributedGeodesics, mean_edges_and_directions_of_elements) {
  const HeatGeodesicsOptions options{
      .t_coef = 2, .length = TimeStepLength::MeanEdge, .directions = HeatDirections::Elements};
  const PolygonMesh mesh = generate_mesh("plane-concave", {.level = 2});
  for (const char* name : {"stabilized_diamond", "bunge"})
    check(mesh, own_block(mesh), name, {{3}}, options);
  const PolyhedralMesh volume = generate_volume("ball-voronoi", {.level = 1});
  check(volume, own_block(volume), "diamond", {{3}}, {.length = TimeStepLength::MeanEdge});
  const DiscretizationOptions frames{.parts = DiscretizationParts::Frames};
  EXPECT_THROW(DistributedGeodesics(own_block(volume),
                                    discretize_part(own_block(volume), "diamond", frames), options),
               Shared<InvalidOption>);
}

TEST(DistributedGeodesics, components_without_a_source_are_infinitely_far) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  check(mesh, own_part(mesh, scattered(2, n_processes())), "diamond", {{6}});
}

TEST(DistributedGeodesics, all_processes_refuse_bad_input) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const auto part = own_part(mesh, in_blocks(2, n_processes()));
  const DistributedGeodesics geodesics(part, discretize_part(part, "diamond"));
  EXPECT_THROW(geodesics.distance({}), Shared<InvalidOption>);
  EXPECT_THROW(geodesics.distance({{99}}), Shared<InvalidOption>);
  EXPECT_THROW(geodesics.distance({{3}}), Shared<InvalidOption>);  // without a face
  EXPECT_THROW(geodesics.distance({{0, -1}}), Shared<InvalidOption>);
}

}  // namespace
}  // namespace carat::test
