// The claim "serial = distributed": on every family the answers of several processes are those of
// one, to 1e-9. (Matrices of parts add up to those of the whole to 1e-13 in
// unit/test_part_discretization, on all families and operators.)

#include <iostream>

#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/poisson.h"
#include "carat/distributed/eigenmodes.h"
#include "carat/distributed/heat_geodesics.h"
#include "carat/distributed/poisson.h"
#include "carat/mesh/statistics.h"
#include "parts.h"

namespace carat::test {
namespace {

constexpr double kTolerance = 1e-9;
constexpr Index kModes = 5;
constexpr const char* kOperators[] = {"diamond", "stabilized_diamond", "bunge"};

Vector right_hand_side(const Points& points) {
  Vector f(points.rows());
  for (Index v = 0; v < f.size(); ++v)
    f[v] = std::sin(3 * points(v, 0)) + points(v, 1) * points(v, 2) + 0.3 * points(v, 1);
  return f;
}

/// Half of the boundary, or one vertex of a closed surface.
template <class Mesh>
BoundaryConditions held_on_one_side(const Mesh& mesh) {
  BoundaryConditions conditions;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[static_cast<std::size_t>(v)] && mesh.points()(v, 0) < 0.4)
      conditions.dirichlet_vertices.push_back(v);
  if (conditions.dirichlet_vertices.empty()) conditions.dirichlet_vertices = {0};
  conditions.dirichlet_values.assign(conditions.dirichlet_vertices.size(), 0.5);
  return conditions;
}

template <class Mesh>
void check_case(const Mesh& mesh, const MeshPart<Mesh>& part, const std::string& name) {
  const Discretization whole = discretize(mesh, name), own = discretize_part(part, name);
  const BoundaryConditions conditions = held_on_one_side(mesh);
  const Vector f = right_hand_side(mesh.points());
  EXPECT_LT(difference(DistributedPoisson(part, own, select(conditions, part.numbers))
                           .solve(select(f, part.numbers))
                           .values,
                       Poisson(mesh, whole, conditions).solve(f).values, part.numbers),
            kTolerance)
      << "Poisson";

  const std::vector<GeodesicSource> source{{mesh.n_vertices() / 3}};
  EXPECT_LT(difference(DistributedGeodesics(part, own).distance(source).values,
                       HeatGeodesics(mesh, whole).distance(source).values, part.numbers),
            kTolerance)
      << "geodesics";

  const EigenPairs one = eigenmodes(whole, kModes, {}),
                   many = distributed_eigenmodes(part, own, kModes, {});
  EXPECT_EQ(one.zero_modes, many.zero_modes);
  for (Index k = one.zero_modes; k < kModes; ++k)
    EXPECT_NEAR(many.values[k], one.values[k], kTolerance * one.values[k]) << "eigenvalue " << k;
}

template <class Families, class Generate>
void check_families(const Families& families, int level, const Generate& generate) {
  int n_cases = 0;
  for (const auto& family : families) {
    const auto mesh = generate(family.name, level);
    const auto part = own_block(mesh);
    for (const char* name : kOperators) {
      SCOPED_TRACE(std::string(family.name) + " " + name);
      check_case(mesh, part, name);
      ++n_cases;
    }
  }
  if (rank() == 0)
    std::cout << "serial = distributed: " << n_cases << " cases of " << families.size()
              << " families on " << n_processes() << " processes\n";
}

TEST(SerialDistributed, surfaces) {
  check_families(mesh_families(), 1, [](const char* name, int level) {
    return generate_mesh(name, {.level = level, .jitter = 0.1});
  });
}

TEST(SerialDistributed, volumes) {
  check_families(volume_families(), 0, [](const char* name, int level) {
    return generate_volume(name, {.level = level, .jitter = 0.1});
  });
}

}  // namespace
}  // namespace carat::test
