// No claim runs on fewer cases than it should: the registered cases are counted against the
// registries. Exclusions are listed with their reason.

#include <cstdio>

#include "support/claim_cases.h"
#include "support/registered_cases.h"

namespace carat::test {
namespace {

struct Exclusion {
  const char* operator_name;
  const char* family;
  const char* reason;
};

// Pinkall, Polthier 1993 and Desbrun et al. 1999 define the cotan operator on triangles.
constexpr const char* kTrianglesOnly = "defined on triangles only [PP93, MDSB99]";
constexpr Exclusion kExclusions[] = {
    {"cotan", "plane-quads", kTrianglesOnly},    {"cotan", "plane-voronoi", kTrianglesOnly},
    {"cotan", "plane-concave", kTrianglesOnly},  {"cotan", "plane-lshape", kTrianglesOnly},
    {"cotan", "sphere-quads", kTrianglesOnly},   {"cotan", "sphere-hexagons", kTrianglesOnly},
    {"cotan", "sphere-concave", kTrianglesOnly},
};

TEST(CaseCounts, exclusions_are_the_listed_ones) {
  std::set<std::pair<std::string, std::string>> listed, found;
  for (const Exclusion& e : kExclusions) listed.insert({e.operator_name, e.family});
  for (const SurfaceOperator* entry : surface_operators())
    for (const FamilyEntry& family : mesh_families())
      if (!defined_on(*entry, family.name)) found.insert({entry->name, family.name});
  EXPECT_EQ(found, listed);
}

TEST(CaseCounts, every_claim_runs_on_every_case) {
  const int operators = static_cast<int>(surface_operators().size());
  const int families = static_cast<int>(mesh_families().size());
  ASSERT_EQ(families, 10);
  ASSERT_EQ(operators, 7);
  const int excluded = static_cast<int>(std::size(kExclusions));
  const int pairs = operators * families - excluded;
  const int variants = kLevels + 2;  // jittered, anisotropic
  // Families by name: 5 in the plane, of which cotan knows 1; 3 of triangles.
  const int plane_pairs = 5 * operators - 4, triangle_pairs = 3 * operators;
  const int sphere_pairs = 4 * operators - 3;
  // Of both diamonds, bunge, vem, and on triangles cotan; the others have one mass.
  const int lumped_pairs = 4 * families + 3;
  // Bounds of their orders are recorded for diamond, bunge and, on triangles, cotan.
  const int bounded_sphere_pairs = 2 * 4 + 1;
  const std::map<std::string, int> expected{
      {"Structure.stiffness_and_mass_are_symmetric", pairs * variants},
      {"Structure.stiffness_is_semidefinite_with_the_constants_as_kernel", pairs * variants},
      {"Structure.mass_is_positive_definite_and_sums_to_the_area", pairs * variants},
      {"LumpedStructure.lumped_mass_holds_the_row_sums", lumped_pairs * variants},
      {"Structure.divergence_is_the_adjoint_of_the_gradient", pairs * variants},
      {"Structure.laplacian_is_divergence_of_gradient", pairs * variants},
      {"Structure.prolongation_is_a_partition_of_unity", pairs * variants},
      {"PlaneStructure.linear_functions_are_in_the_kernel_at_inner_vertices",
       plane_pairs * variants},
      {"PlaneStructure.gradients_of_linear_functions_are_exact", plane_pairs * variants},
      {"TriangleStructure.equals_cotan_exactly_where_claimed", triangle_pairs * variants},
      {"Invariance.rigid_motion", pairs * variants},
      {"Invariance.translation_by_a_million_diameters", pairs * variants},
      {"Invariance.scale_by_powers_of_two_to_the_last_bit", pairs * variants},
      {"Invariance.scale_by_1e9_and_its_inverse", pairs * variants},
      {"Invariance.vertex_numbers", pairs * variants},
      {"Invariance.face_order_start_and_orientation", pairs * variants},
      {"Invariance.moved_vertices_and_repetition_give_the_bits_of_a_fresh_start", pairs * variants},
      {"Threads.any_number_gives_the_same_bits", pairs},
      {"Locality.entries_are_exactly_those_predicted", pairs * variants},
      {"PoissonFull.franke_on_the_square", 2 * plane_pairs},
      {"HarmonicsFull.third_degree_on_the_sphere", 2 * sphere_pairs},
      {"CurvatureFull.unit_sphere", 2 * bounded_sphere_pairs},
      {"GeodesicsFull.unit_sphere", 2 * bounded_sphere_pairs},
      {"GeodesicsFull.unit_sphere_with_a_long_time_step", 2 * bounded_sphere_pairs},
  };
  EXPECT_EQ(registered_cases("Claims"), expected);
  int total = 0;
  for (const auto& [claim, count] : expected) total += count;
  RecordProperty("claim_cases", total);
  std::printf("%d cases of %zu claims\n", total, expected.size());
}

}  // namespace
}  // namespace carat::test
