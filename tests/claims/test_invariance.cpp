// Results do not depend on where the mesh lies, on its unit of length, nor on how it is numbered.

#include "support/claim_cases.h"
#include "support/measures.h"
#include "support/transforms.h"

namespace carat::test {
namespace {

class Invariance : public ClaimTest {
 protected:
  void expect_same(const Discretization& a, const Discretization& b, double tolerance) const {
    EXPECT_LT(difference(a.stiffness, b.stiffness), tolerance);
    EXPECT_LT(difference(a.mass, b.mass), tolerance);
  }
};

// Other rounding of sums of some tens of terms, magnified by the worst triangle.
double rounding(const PolygonMesh& mesh) { return 200 * kEps * condition(mesh); }

TEST_P(Invariance, rigid_motion) {
  const PolygonMesh mesh = GetParam().mesh();
  expect_same(discretization(move_rigidly(mesh)), discretization(mesh), rounding(mesh));
}

TEST_P(Invariance, translation_by_a_million_diameters) {
  const PolygonMesh mesh = GetParam().mesh();
  // The distant coordinates lose digits; taking the shift off again is exact, so that both meshes
  // have the same shape to the last bit.
  const Eigen::RowVector3d shift(2e6, -1e6, 3e6);
  const PolygonMesh distant = mesh.with_points(mesh.points().rowwise() + shift);
  const PolygonMesh near = mesh.with_points(distant.points().rowwise() - shift);
  const Discretization a = discretization(distant), b = discretization(near);
  expect_same(a, b, rounding(mesh));
  EXPECT_LT(row_sum_defect(a.stiffness), 100 * kEps);
}

TEST_P(Invariance, scale_by_powers_of_two_to_the_last_bit) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh);
  for (const int exponent : {-30, 30}) {
    const double scale = std::ldexp(1.0, exponent);
    const Discretization d = discretization(mesh.with_points(mesh.points() * scale));
    EXPECT_TRUE(same_bits(d.stiffness, reference.stiffness));
    EXPECT_TRUE(same_bits(d.mass, SparseMatrix(reference.mass * (scale * scale))));
    // Differences have no unit.
    const double factor = reference.is_one_form() ? 1 : 1 / scale;
    EXPECT_TRUE(same_bits(d.gradient, SparseMatrix(reference.gradient * factor)));
  }
}

TEST_P(Invariance, scale_by_1e9_and_its_inverse) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh);
  for (const double scale : {1e-9, 1e9}) {
    const Discretization d = discretization(mesh.with_points(mesh.points() * scale));
    EXPECT_LT(difference(d.stiffness, reference.stiffness), rounding(mesh));
    EXPECT_LT(difference(SparseMatrix(d.mass / (scale * scale)), reference.mass), rounding(mesh));
    EXPECT_EQ(d.diagnostics.count("excluded_samples"), 0);
  }
}

TEST_P(Invariance, vertex_numbers) {
  const PolygonMesh mesh = GetParam().mesh();
  const std::vector<Index> number = permutation(mesh.n_vertices(), 3);
  Discretization d = discretization(renumber(mesh, number));
  d.stiffness = restore_numbers(d.stiffness, number);
  d.mass = restore_numbers(d.mass, number);
  expect_same(d, discretization(mesh), rounding(mesh));
}

TEST_P(Invariance, face_order_start_and_orientation) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh);
  expect_same(discretization(permute_faces(mesh, 5)), reference, rounding(mesh));
  expect_same(discretization(rotate_faces(mesh)), reference, rounding(mesh));
  expect_same(discretization(flip_faces(mesh, 1)), reference, rounding(mesh));
  expect_same(discretization(flip_faces(mesh, 3)), reference, rounding(mesh));
}

TEST_P(Invariance, moved_vertices_and_repetition_give_the_bits_of_a_fresh_start) {
  const PolygonMesh mesh = GetParam().mesh();
  const PolygonMesh moved = move_rigidly(mesh);
  const auto assembly = GetParam().entry->prepare(mesh, {});
  for (const PolygonMesh& at : {mesh, moved, mesh}) {
    assembly->reassemble(at.points());
    const Discretization fresh = discretization(at);
    EXPECT_TRUE(same_bits(assembly->discretization().stiffness, fresh.stiffness));
    EXPECT_TRUE(same_bits(assembly->discretization().mass, fresh.mass));
    EXPECT_TRUE(same_bits(assembly->discretization().gradient, fresh.gradient));
  }
}

INSTANTIATE_TEST_SUITE_P(Claims, Invariance, testing::ValuesIn(claim_cases()), case_name);

/// Large enough that every loop is split among the threads.
class Threads : public ClaimTest {};

TEST_P(Threads, any_number_gives_the_same_bits) {
  const PolygonMesh mesh = GetParam().mesh();
  ASSERT_GT(mesh.n_faces(), 2048) << "shorter loops run on one thread";
  DiscretizationOptions options{.threads = 1};
  const Discretization one = discretization(mesh, options);
  for (const int threads : {2, 3, 8}) {
    options.threads = threads;
    const Discretization d = discretization(mesh, options);
    EXPECT_TRUE(same_bits(d.stiffness, one.stiffness));
    EXPECT_TRUE(same_bits(d.mass, one.mass));
    EXPECT_TRUE(same_bits(d.gradient, one.gradient));
    EXPECT_TRUE((d.sample_measure.array() == one.sample_measure.array()).all());
  }
}

std::vector<ClaimCase> large_cases() {
  std::vector<ClaimCase> cases;
  for (const SurfaceOperator* entry : surface_operators())
    for (const FamilyEntry& family : mesh_families())
      if (defined_on(*entry, family.name))
        cases.push_back({entry, family.name, {.level = 4, .jitter = kJitter}});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Claims, Threads, testing::ValuesIn(large_cases()), case_name);

}  // namespace
}  // namespace carat::test
