// The claim checks in volumes can fail: operators with one deliberate mistake each are caught by
// them, and the same slow code without mistake passes and agrees with the library.

#include "support/dense_volume_diamond.h"
#include "support/volume_claim_cases.h"
#include "support/volume_measures.h"
#include "support/volume_transforms.h"

namespace carat::test {
namespace {

SparseMatrix sparse(const Matrix& a) { return a.sparseView(1, 0); }

/// By how much each claim is missed; limits as in the tests of the operators.
struct Defects {
  double symmetry, constants, linear_precision, mass, second_eigenvalue, numbering;
};

Defects defects(const PolyhedralMesh& mesh, VolumeMutation mutation) {
  const DenseDiamond d = dense_volume_diamond(mesh, mutation);
  const SparseMatrix stiffness = sparse(d.stiffness);
  const PolyhedralMesh other = rotate_faces_and_cells(mesh);
  return {asymmetry(stiffness),
          row_sum_defect(stiffness),
          linear_precision_defect(stiffness, mesh.points(), inner_vertices(mesh)),
          mass_defect(sparse(d.mass), refinement_volume(mesh)),
          relative_eigenvalues(stiffness)[1],
          difference(sparse(dense_volume_diamond(other, mutation).stiffness), stiffness)};
}

PolyhedralMesh cube() { return generate_volume("cube-prisms", {.level = 0, .jitter = 0.2}); }

constexpr double kLimit = 1e-11;  // what the operators keep
constexpr double kCaught = 1e-3;  // a mistake is far above it

TEST(VolumeMutations, none_keeps_every_claim) {
  const Defects d = defects(cube(), VolumeMutation::None);
  EXPECT_LT(d.symmetry, kLimit);
  EXPECT_LT(d.constants, kLimit);
  EXPECT_LT(d.linear_precision, kLimit);
  EXPECT_LT(d.mass, kLimit);
  EXPECT_LT(d.numbering, kLimit);
  EXPECT_GT(d.second_eigenvalue, 5e-3);
}

TEST(VolumeMutations, swapped_tips_are_caught_by_linear_precision) {
  EXPECT_GT(defects(cube(), VolumeMutation::TipsSwapped).linear_precision, kCaught);
}

TEST(VolumeMutations, dropped_boundary_is_caught_by_the_volume) {
  EXPECT_GT(defects(cube(), VolumeMutation::BoundaryDropped).mass, kCaught);
}

TEST(VolumeMutations, weights_that_are_not_affine_are_caught_by_the_constants) {
  EXPECT_GT(defects(cube(), VolumeMutation::WeightsNotAffine).constants, kCaught);
}

TEST(VolumeMutations, the_boundary_mass_to_the_letter_is_caught_by_the_volume) {
  EXPECT_GT(defects(cube(), VolumeMutation::BoundaryMassLiteral).mass, kCaught);
}

TEST(VolumeMutations, weights_with_the_last_eliminated_are_caught_by_the_order_of_faces) {
  EXPECT_GT(defects(cube(), VolumeMutation::LastWeightEliminated).numbering, kCaught);
}

TEST(VolumeMutations, one_diamond_a_face_is_caught_by_the_kernel) {
  // The faces of hexahedra are even: the checkerboard is a second kernel vector, as [BBA21 section
  // 6.2] warns. Exactly so if all weights are the same.
  const PolyhedralMesh regular = generate_volume("cube-hexahedra");
  const PolyhedralMesh jittered = generate_volume("cube-hexahedra", {.jitter = 0.2});
  constexpr VolumeMutation kMistake = VolumeMutation::OneDiamondAFace;
  EXPECT_LT(std::abs(defects(regular, kMistake).second_eigenvalue), 1e-13);
  EXPECT_LT(defects(jittered, kMistake).second_eigenvalue, 1e-4);
  EXPECT_GT(defects(jittered, VolumeMutation::None).second_eigenvalue, 5e-3);
  const Vector u = checkerboard(regular);
  const Matrix s = dense_volume_diamond(regular, kMistake).stiffness;
  EXPECT_LT(u.dot(s * u), 1e-13 * s.diagonal().sum());
}

TEST(VolumeMutations, every_mistake_changes_the_matrices) {
  // Otherwise the switches above would test nothing.
  const DenseDiamond right = dense_volume_diamond(cube());
  for (const VolumeMutation m :
       {VolumeMutation::TipsSwapped, VolumeMutation::BoundaryDropped,
        VolumeMutation::WeightsNotAffine, VolumeMutation::LastWeightEliminated,
        VolumeMutation::OneDiamondAFace})
    EXPECT_GT((dense_volume_diamond(cube(), m).stiffness - right.stiffness).cwiseAbs().maxCoeff(),
              kCaught * right.stiffness.cwiseAbs().maxCoeff());
  EXPECT_GT((dense_volume_diamond(cube(), VolumeMutation::BoundaryMassLiteral).mass - right.mass)
                .cwiseAbs()
                .maxCoeff(),
            kCaught * right.mass.cwiseAbs().maxCoeff());
}

class VolumeDenseAgreement : public testing::TestWithParam<std::string> {};

TEST_P(VolumeDenseAgreement, library_equals_the_slow_code) {
  for (const double jitter : {0.0, 0.2}) {
    const PolyhedralMesh mesh = generate_volume(GetParam(), {.level = 0, .jitter = jitter});
    const Discretization d = discretize(mesh);
    // Moving points into kernels is the library's own.
    ASSERT_EQ(d.diagnostics.count("moved_cell_points"), 0);
    ASSERT_EQ(d.diagnostics.count("moved_virtual_vertices"), 0);
    const DenseDiamond expected = dense_volume_diamond(mesh);
    const double tolerance = 100 * kEps * condition(mesh);
    EXPECT_LT(
        difference(prolongation_matrix(mesh, virtual_cells(mesh)), sparse(expected.prolongation)),
        tolerance);
    EXPECT_LT(difference(d.stiffness, sparse(expected.stiffness)), tolerance);
    EXPECT_LT(difference(d.mass, sparse(expected.mass)), tolerance);
    EXPECT_LT(difference(d.gradient, sparse(expected.gradient)), tolerance);
    EXPECT_LT(difference(d.divergence(), sparse(expected.divergence)), tolerance);
  }
}

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (const VolumeFamilyEntry& family : volume_families()) names.emplace_back(family.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeDenseAgreement, testing::ValuesIn(all_families()),
                         [](const testing::TestParamInfo<std::string>& family) {
                           std::string name = family.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace carat::test
