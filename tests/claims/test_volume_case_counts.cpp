// No claim about volumes runs on fewer cases than it should: the registered cases are counted
// against the registries.

#include <cstdio>

#include "support/registered_cases.h"
#include "support/volume_claim_cases.h"

namespace carat::test {
namespace {

TEST(VolumeCaseCounts, families_and_operators_are_the_known_ones) {
  const char* const kinds[] = {"hexahedra", "pyramids",      "truncated", "voronoi",
                               "tets",      "tets-adaptive", "prisms",    "random-hex"};
  std::set<std::string> known, found, excluded;
  for (const char* kind : kinds)
    for (const char* domain : {"cube-", "ball-"}) known.insert(std::string(domain) + kind);
  for (const VolumeFamilyEntry& family : volume_families()) found.insert(family.name);
  EXPECT_EQ(found, known);
  // Crane 2019 defines the primal operator on tetrahedra. Those with unknowns beyond the vertices
  // or negative eigenvalues have tests of their own. Nothing else is left out anywhere.
  for (const VolumeOperator* entry : volume_operators())
    for (const std::string& family : found)
      if (!defined_on(*entry, family)) excluded.insert(std::string(entry->name) + " " + family);
  std::set<std::string> not_tets;
  for (const std::string& family : known)
    if (family.find("tets") == std::string::npos) not_tets.insert("primal_tet " + family);
  for (const char* name : {"dual_tet", "ceve", "cevefe"})
    for (const std::string& family : known) not_tets.insert(std::string(name) + " " + family);
  EXPECT_EQ(excluded, not_tets);
}

TEST(VolumeCaseCounts, every_claim_runs_on_every_case) {
  ASSERT_EQ(volume_operators().size(), 8u);
  const int operators = 5;  // both diamonds, bunge, vem, primal_tet
  const int families = 16, tet_families = 4, hex_families = 4, cube_families = 8;
  const int pairs = 4 * families + tet_families;  // both diamonds, bunge, vem; primal_tet
  const int cube_pairs = 4 * cube_families + tet_families / 2;
  const int levels = 2, variants = 2;  // regular, jittered
  const int all = pairs * levels * variants;
  const int invariance = pairs * 3;  // level 1 jittered only
  const std::map<std::string, int> expected{
      {"VolumeStructure.stiffness_and_mass_are_symmetric", all},
      {"VolumeStructure.stiffness_is_semidefinite_with_the_constants_as_kernel", all},
      {"VolumeStructure.mass_is_positive_definite_and_sums_to_the_volume", all},
      {"VolumeStructure.lumped_mass_holds_the_row_sums", all},
      {"VolumeStructure.laplacian_is_divergence_of_gradient_and_one_the_adjoint_of_the_other", all},
      {"VolumeStructure.linear_functions_are_in_the_kernel_at_inner_vertices", all},
      {"VolumeStructure.gradients_of_linear_functions_are_exact", all},
      {"VolumeStructure.parts_of_the_samples_fill_the_cells", all},
      {"VolumeStructureFull.all_claims", pairs * variants},
      {"VolumeProlongation.is_a_partition_of_unity", families * levels * variants},
      {"TetStructure.equals_linear_elements_exactly_where_claimed",
       operators * tet_families * levels * variants},
      {"Checkerboard.is_not_in_the_kernel", 4 * hex_families * levels * variants},
      {"VolumeInvariance.rigid_motion", invariance},
      {"VolumeInvariance.translation_by_a_million_diameters", invariance},
      {"VolumeInvariance.scale_by_powers_of_two_to_the_last_bit", invariance},
      {"VolumeInvariance.scale_by_1e9_and_its_inverse", invariance},
      {"VolumeInvariance.vertex_numbers", invariance},
      {"VolumeInvariance.numbers_starts_and_orders_of_faces_and_cells", invariance},
      {"VolumeInvariance.which_cell_of_a_face_comes_first", invariance},
      {"VolumeInvariance.moved_vertices_and_repetition_give_the_bits_of_a_fresh_start", invariance},
      {"VolumeThreads.any_number_gives_the_same_bits", operators},
      {"VolumeThreadsFull.any_number_gives_the_same_bits", pairs},
      {"VolumeLocality.entries_are_exactly_those_predicted", pairs * levels},
      {"VolumeDenseAgreement.library_equals_the_slow_code", families},
      {"VolumePoissonFull.franke_on_the_cube", cube_pairs * variants},
      {"VolumeGeodesicsFull.error_falls_towards_euclidean_distance", pairs},
      {"BallEigenvaluesFull.diamond_is_nearer_than_bunge_with_full_masses", families / 2},
  };
  EXPECT_EQ(registered_cases("Volumes"), expected);
  int total = 0;
  for (const auto& [claim, count] : expected) total += count;
  RecordProperty("claim_cases", total);
  std::printf("%d cases of %zu claims in volumes\n", total, expected.size());
}

}  // namespace
}  // namespace carat::test
