// Results in volumes do not depend on where the mesh lies, on its unit of length, nor on how it is
// numbered or which of two cells of a face comes first.

#include "support/volume_claim_cases.h"
#include "support/volume_measures.h"
#include "support/volume_transforms.h"

namespace carat::test {
namespace {

const DiscretizationOptions kMatrices{.parts = DiscretizationParts::Matrices};

class VolumeInvariance : public VolumeClaimTest {
 protected:
  void expect_same(const Discretization& a, const Discretization& b, double tolerance) const {
    EXPECT_LT(difference(a.stiffness, b.stiffness), tolerance);
    EXPECT_LT(difference(a.mass, b.mass), tolerance);
  }
};

// Other rounding of sums of some tens of terms, magnified by the worst tetrahedron.
double rounding(const PolyhedralMesh& mesh) { return 200 * kEps * condition(mesh); }

TEST_P(VolumeInvariance, rigid_motion) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization moved = discretization(move_rigidly(mesh)), d = discretization(mesh);
  expect_same(moved, d, rounding(mesh));
  // Gradients are vectors in space: they turn along.
  const Vector u = (mesh.points() * Vec3(1, -2, 0.5)).array().sin();
  const Vector g = moved.gradient * u, expected = d.gradient * u;
  double worst = 0;
  for (Index s = 0; s < d.n_samples(); ++s) {
    const Eigen::Index row = d.first_row(s);
    worst = std::max(
        worst, (some_rotation().transpose() * g.segment<3>(row) - expected.segment<3>(row)).norm());
    // Jumps are scalars.
    for (Index k = 3; k < d.gradient_dimension; ++k)
      worst = std::max(worst, std::abs(g[row + k] - expected[row + k]));
  }
  EXPECT_LT(worst, rounding(mesh) * expected.cwiseAbs().maxCoeff());
}

TEST_P(VolumeInvariance, translation_by_a_million_diameters) {
  const PolyhedralMesh mesh = GetParam().mesh();
  // The distant coordinates lose digits; taking the shift off again is exact, so that both meshes
  // have the same shape to the last bit.
  const Eigen::RowVector3d shift(2e6, -1e6, 3e6);
  const PolyhedralMesh distant = mesh.with_points(mesh.points().rowwise() + shift);
  const PolyhedralMesh near = mesh.with_points(distant.points().rowwise() - shift);
  const Discretization a = discretization(distant, kMatrices), b = discretization(near, kMatrices);
  expect_same(a, b, rounding(mesh));
  EXPECT_LT(row_sum_defect(a.stiffness), 200 * kEps);
}

TEST_P(VolumeInvariance, scale_by_powers_of_two_to_the_last_bit) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh);
  for (const int exponent : {-30, 30}) {
    const double scale = std::ldexp(1.0, exponent);
    const Discretization d = discretization(mesh.with_points(mesh.points() * scale));
    EXPECT_TRUE(same_bits(d.stiffness, SparseMatrix(reference.stiffness * scale)));
    EXPECT_TRUE(same_bits(d.mass, SparseMatrix(reference.mass * (scale * scale * scale))));
    EXPECT_TRUE(same_bits(d.gradient, SparseMatrix(reference.gradient / scale)));
  }
}

TEST_P(VolumeInvariance, scale_by_1e9_and_its_inverse) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh, kMatrices);
  for (const double scale : {1e-9, 1e9}) {
    Discretization d = discretization(mesh.with_points(mesh.points() * scale), kMatrices);
    d.stiffness /= scale;
    d.mass /= scale * scale * scale;
    expect_same(d, reference, rounding(mesh));
    EXPECT_EQ(d.diagnostics.count("excluded_samples"), 0);
  }
}

TEST_P(VolumeInvariance, vertex_numbers) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const std::vector<Index> number = permutation(mesh.n_vertices(), 3);
  Discretization d = discretization(renumber(mesh, number), kMatrices);
  d.stiffness = restore_numbers(d.stiffness, number);
  d.mass = restore_numbers(d.mass, number);
  expect_same(d, discretization(mesh, kMatrices), rounding(mesh));
}

TEST_P(VolumeInvariance, numbers_starts_and_orders_of_faces_and_cells) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh, kMatrices);
  for (const PolyhedralMesh& other :
       {permute_faces_and_cells(mesh, 5), rotate_faces_and_cells(mesh)})
    expect_same(discretization(other, kMatrices), reference, rounding(mesh));
}

TEST_P(VolumeInvariance, which_cell_of_a_face_comes_first) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization reference = discretization(mesh, kMatrices);
  for (const std::size_t step : {1, 3}) {
    const PolyhedralMesh flipped = flip_faces(mesh, step);
    ASSERT_EQ(flipped.face_cells()[0].below, mesh.face_cells()[0].above);
    expect_same(discretization(flipped, kMatrices), reference, rounding(mesh));
  }
}

TEST_P(VolumeInvariance, moved_vertices_and_repetition_give_the_bits_of_a_fresh_start) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const PolyhedralMesh moved = move_rigidly(mesh);
  const auto assembly = GetParam().entry->prepare(mesh, {});
  for (const PolyhedralMesh& at : {mesh, moved, mesh}) {
    assembly->reassemble(at.points());
    const Discretization fresh = discretization(at);
    EXPECT_TRUE(same_bits(assembly->discretization().stiffness, fresh.stiffness));
    EXPECT_TRUE(same_bits(assembly->discretization().mass, fresh.mass));
    EXPECT_TRUE(same_bits(assembly->discretization().gradient, fresh.gradient));
  }
}

std::vector<VolumeClaimCase> invariance_cases() {
  return volume_claim_cases({0, 1}, [](const VolumeClaimCase& c) {
    return c.options.level == 0 || c.options.jitter > 0;
  });
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeInvariance, testing::ValuesIn(invariance_cases()),
                         volume_case_name);

/// Large enough that every loop is split among the threads.
class VolumeThreads : public VolumeClaimTest {
 protected:
  void expect_same_bits_on_all() const {
    const PolyhedralMesh mesh = GetParam().mesh();
    ASSERT_GT(std::min(mesh.n_cells(), mesh.n_vertices()), 2048)
        << "shorter loops run on one thread";
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
};

TEST_P(VolumeThreads, any_number_gives_the_same_bits) { expect_same_bits_on_all(); }

std::vector<VolumeClaimCase> one_large_case_an_operator() {
  return volume_claim_cases({2}, [](const VolumeClaimCase& c) {
    return c.options.jitter > 0 &&
           c.family == (c.entry->claims.simplices_only ? "ball-tets" : "cube-pyramids");
  });
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeThreads, testing::ValuesIn(one_large_case_an_operator()),
                         volume_case_name);

class VolumeThreadsFull : public VolumeThreads {};

TEST_P(VolumeThreadsFull, any_number_gives_the_same_bits) { expect_same_bits_on_all(); }

/// Level 2, or 3 where a cell has so many vertices that level 2 has few cells.
std::vector<VolumeClaimCase> large_cases() {
  std::vector<VolumeClaimCase> cases =
      volume_claim_cases({2}, [](const VolumeClaimCase& c) { return c.options.jitter > 0; });
  for (VolumeClaimCase& c : cases)
    if (c.family.find("truncated") != std::string::npos ||
        c.family.find("voronoi") != std::string::npos)
      c.options.level = 3;
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeThreadsFull, testing::ValuesIn(large_cases()),
                         volume_case_name);

}  // namespace
}  // namespace carat::test
