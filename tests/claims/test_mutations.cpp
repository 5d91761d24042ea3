// The claim checks can fail: operators with one deliberate mistake each are caught by them, and the
// same slow code without mistake passes and agrees with the library.

#include "carat/generators/families.h"
#include "support/claim_cases.h"
#include "support/dense_diamond.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

SparseMatrix sparse(const Matrix& a) { return a.sparseView(1, 0); }

/// By how much each claim is missed; limits as in the tests of the operators.
struct Defects {
  double symmetry, constants, linear_precision, mass, adjointness, isometry;
};

PolygonMesh bent_strip(bool bent) {
  const PolygonMesh flat = quad_grid(4, 2);
  Points points = flat.points();
  if (bent)
    for (Index v = 0; v < points.rows(); ++v)
      if (points(v, 0) > 2) points.row(v) = Vec3(2, points(v, 1), points(v, 0) - 2).transpose();
  return flat.with_points(points);
}

Defects defects(const PolygonMesh& mesh, Mutation mutation) {
  const DenseDiamond d = dense_diamond(mesh, mutation);
  const SparseMatrix stiffness = sparse(d.stiffness), mass = sparse(d.mass);
  return {asymmetry(stiffness),
          row_sum_defect(stiffness),
          linear_precision_defect(stiffness, mesh.points(), inner_vertices(mesh)),
          mass_defect(mass, refinement_area(mesh)),
          adjointness_defect(sparse(d.divergence), sparse(d.gradient), d.measure, 2),
          difference(sparse(dense_diamond(bent_strip(true), mutation).stiffness),
                     sparse(dense_diamond(bent_strip(false), mutation).stiffness))};
}

PolygonMesh plane() {
  return generate_mesh("plane-voronoi", {.level = 0, .jitter = 0.2, .seed = 3});
}

constexpr double kLimit = 1e-12;  // what the operators keep
constexpr double kCaught = 1e-3;  // a mistake is far above it

TEST(Mutations, none_keeps_every_claim) {
  const Defects d = defects(plane(), Mutation::None);
  EXPECT_LT(d.symmetry, kLimit);
  EXPECT_LT(d.constants, kLimit);
  EXPECT_LT(d.linear_precision, kLimit);
  EXPECT_LT(d.mass, kLimit);
  EXPECT_LT(d.adjointness, kLimit);
  EXPECT_LT(d.isometry, kLimit);
}

TEST(Mutations, swapped_tips_are_caught_by_linear_precision) {
  EXPECT_GT(defects(plane(), Mutation::TipsSwapped).linear_precision, kCaught);
}

TEST(Mutations, dropped_boundary_is_caught_by_the_area) {
  EXPECT_GT(defects(plane(), Mutation::BoundaryDropped).mass, kCaught);
}

TEST(Mutations, projected_hinge_is_caught_by_bending) {
  EXPECT_GT(defects(plane(), Mutation::HingeProjected).isometry, kCaught);
}

TEST(Mutations, weights_that_are_not_affine_are_caught_by_the_constants) {
  EXPECT_GT(defects(plane(), Mutation::WeightsNotAffine).constants, kCaught);
}

TEST(Mutations, a_quarter_of_boundary_diamonds_is_caught_by_the_area) {
  EXPECT_GT(defects(plane(), Mutation::BoundaryMassQuarter).mass, kCaught);
}

TEST(Mutations, every_mistake_changes_the_matrices) {
  // Otherwise the switches above would test nothing.
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 0, .jitter = 0.2});
  const DenseDiamond right = dense_diamond(mesh), bent = dense_diamond(bent_strip(true));
  for (const Mutation m :
       {Mutation::TipsSwapped, Mutation::BoundaryDropped, Mutation::WeightsNotAffine})
    EXPECT_GT((dense_diamond(mesh, m).stiffness - right.stiffness).cwiseAbs().maxCoeff(), kCaught);
  EXPECT_GT((dense_diamond(bent_strip(true), Mutation::HingeProjected).stiffness - bent.stiffness)
                .cwiseAbs()
                .maxCoeff(),
            kCaught);
  EXPECT_GT(
      (dense_diamond(mesh, Mutation::BoundaryMassQuarter).mass - right.mass).cwiseAbs().maxCoeff(),
      1e-3 * right.mass.cwiseAbs().maxCoeff());
}

/// Families whose points need not be moved into the kernel: that step is the library's own.
class DenseAgreement : public testing::TestWithParam<std::string> {};

TEST_P(DenseAgreement, library_equals_the_slow_code) {
  for (const double jitter : {0.0, 0.2}) {
    const PolygonMesh mesh = generate_mesh(GetParam(), {.level = 0, .jitter = jitter});
    const Discretization d = discretize(mesh);
    ASSERT_EQ(d.diagnostics.count("moved_virtual_vertices"), 0);
    const DenseDiamond expected = dense_diamond(mesh);
    EXPECT_LT(difference(d.stiffness, sparse(expected.stiffness)), 1e-12);
    EXPECT_LT(difference(d.mass, sparse(expected.mass)), 1e-12);
    EXPECT_LT(difference(d.gradient, sparse(expected.gradient)), 1e-12);
    EXPECT_LT(difference(d.divergence(), sparse(expected.divergence)), 1e-12);
  }
}

std::string family_name(const testing::TestParamInfo<std::string>& family) {
  std::string name = family.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Families, DenseAgreement,
                         testing::Values("plane-triangles", "plane-quads", "plane-voronoi",
                                         "plane-concave", "sphere-triangles", "sphere-quads",
                                         "sphere-hexagons", "torus-triangles"),
                         family_name);

}  // namespace
}  // namespace carat::test
