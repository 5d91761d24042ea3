// Structure that the paper's section 7 promises of every volume operator, on every family:
// symmetry, semidefiniteness, kernel, linear precision, D = -G^T M_s, L = D G, total mass.
// Tolerances are multiples of the rounding unit times the row length or condition that they sum.

#include <cstdio>

#include "carat/base/error.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/semidefinite_solver.h"
#include "support/volume_claim_cases.h"
#include "support/volume_measures.h"

namespace carat::test {
namespace {

// A row adds up to some hundreds of terms.
constexpr double kRounding = 200 * kEps;

constexpr VirtualPoint kPoints[] = {VirtualPoint::AreaMinimizer, VirtualPoint::Centroid};

/// Where virtual vertices may lie, for operators that have them.
std::span<const VirtualPoint> virtual_points_of(const VolumeOperator& entry) {
  return std::span(kPoints).first(entry.options.virtual_vertex ? 2 : 1);
}

class VolumeStructure : public VolumeClaimTest {
 protected:
  /// Positive definite once a single vertex is held: semidefinite with a kernel of dimension one.
  void expect_factorisable(const Discretization& d) const {
    const SemidefiniteSolver solver(d.stiffness);
    EXPECT_EQ(solver.n_components(), 1);
    Vector rhs = Vector::Zero(d.n_vertices());
    rhs[0] = 1;
    rhs[d.n_vertices() - 1] = -1;
    const Vector u = solver.solve(rhs);
    EXPECT_LT((d.stiffness * u - rhs).lpNorm<Eigen::Infinity>(), 1e-10);
  }
  void expect_symmetric(const Discretization& d) const {
    EXPECT_LT(asymmetry(d.stiffness), kRounding);
    EXPECT_LT(asymmetry(d.mass), kRounding);
    EXPECT_LT(row_sum_defect(d.stiffness), kRounding);
  }
  void expect_volume(const PolyhedralMesh& mesh, const Discretization& d) const {
    const double volume = refinement_volume(mesh);
    EXPECT_NEAR(total(d.mass), volume, 1e-12 * volume);
    EXPECT_NEAR(accurate_sum(d.sample_measure), volume, 1e-12 * volume);
    if (GetParam().cube()) {
      EXPECT_NEAR(volume, 1, 1e-12);
    }
  }
  void expect_factorisation(const PolyhedralMesh& mesh, const Discretization& d,
                            const SparseMatrix& divergence) const {
    const double defect = factorisation_defect(d.stiffness, divergence, d.gradient);
    // A stabilising term has nothing to do on tetrahedra.
    if (GetParam().entry->claims.divergence_of_gradient || tetrahedral(GetParam().family)) {
      EXPECT_LT(defect, kRounding * condition(mesh));
    } else {
      EXPECT_GT(defect, 1e-3);
    }
  }
  void expect_linear_precision(const PolyhedralMesh& mesh, const Discretization& d) const {
    EXPECT_EQ(d.diagnostics.count("excluded_samples"), 0);
    EXPECT_LT(linear_precision_defect(d.stiffness, mesh.points(), inner_vertices(mesh)), 1e-11);
  }
};

TEST_P(VolumeStructure, stiffness_and_mass_are_symmetric) {
  expect_symmetric(discretization(GetParam().mesh(), {.parts = DiscretizationParts::Matrices}));
}

TEST_P(VolumeStructure, stiffness_is_semidefinite_with_the_constants_as_kernel) {
  const Discretization d =
      discretization(GetParam().mesh(), {.parts = DiscretizationParts::Matrices});
  ASSERT_TRUE(GetParam().entry->claims.semidefinite);
  if (GetParam().options.level > 0) return expect_factorisable(d);
  const Vector values = relative_eigenvalues(d.stiffness);
  EXPECT_GT(values[0], -kRounding);
  EXPECT_LT(values[0], kRounding);
  // The next one is of the order of (h / diameter)^2 on these meshes of some 100 vertices.
  EXPECT_GT(values[1], 5e-3);
}

TEST_P(VolumeStructure, mass_is_positive_definite_and_sums_to_the_volume) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh, {.parts = DiscretizationParts::Matrices});
  expect_volume(mesh, d);
  EXPECT_NO_THROW(Cholesky{d.mass});
}

TEST_P(VolumeStructure, lumped_mass_holds_the_row_sums) {
  const PolyhedralMesh mesh = GetParam().mesh();
  ASSERT_TRUE(GetParam().full_and_lumped());
  const Discretization d =
      discretization(mesh, {.mass = MassKind::Full, .parts = DiscretizationParts::Matrices});
  const Discretization lumped =
      discretization(mesh, {.mass = MassKind::Lumped, .parts = DiscretizationParts::Matrices});
  EXPECT_EQ(lumped.mass.nonZeros(), mesh.n_vertices());
  const Vector sums = d.mass * Vector::Ones(mesh.n_vertices());
  const double scale = sums.cwiseAbs().maxCoeff();
  EXPECT_LT((Vector(lumped.mass.diagonal()) - sums).cwiseAbs().maxCoeff(), kRounding * scale);
  EXPECT_LT((d.lumped_mass() - sums).cwiseAbs().maxCoeff(), kRounding * scale);
  EXPECT_TRUE(same_bits(lumped.stiffness, d.stiffness));
}

TEST_P(VolumeStructure, laplacian_is_divergence_of_gradient_and_one_the_adjoint_of_the_other) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  const SparseMatrix divergence = d.divergence();
  expect_factorisation(mesh, d, divergence);
  EXPECT_LT(adjointness_defect(d, divergence), kRounding);
  const Vector x = Vector::LinSpaced(d.gradient.rows(), -1, 2);
  const Vector expected = divergence * x;
  EXPECT_LT((d.apply_divergence(x) - expected).cwiseAbs().maxCoeff(),
            kRounding * expected.cwiseAbs().maxCoeff());
  EXPECT_LT(row_sum_defect(d.gradient), kRounding);
  EXPECT_TRUE(same_bits(SparseMatrix(-d.laplacian()), d.stiffness));
}

TEST_P(VolumeStructure, linear_functions_are_in_the_kernel_at_inner_vertices) {
  const PolyhedralMesh mesh = GetParam().mesh();
  for (const VirtualPoint point : virtual_points_of(*GetParam().entry))
    expect_linear_precision(mesh, discretization(mesh, {.virtual_vertex = {point},
                                                        .parts = DiscretizationParts::Matrices}));
}

TEST_P(VolumeStructure, gradients_of_linear_functions_are_exact) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Vec3 c(0.6, -1.3, 0.4);
  const Discretization d = discretization(mesh, {.parts = DiscretizationParts::Frames});
  // Values of size 1 differ over heights of h / condition, h > 0.01 here.
  const double tolerance = 10 * kEps / 0.01 * condition(mesh);
  EXPECT_LT(gradient_defect(d, mesh.points(), c), tolerance);
  const Vector g = d.gradient * Vector((mesh.points().rowwise() - mesh.points().row(0)) * c);
  const Points cells = d.element_vectors(g, mesh.n_cells());
  EXPECT_LT((cells.rowwise() - c.transpose()).rowwise().norm().maxCoeff(), tolerance);
  const Points vertices = d.vertex_vectors(g);
  EXPECT_LT((vertices.rowwise() - c.transpose()).rowwise().norm().maxCoeff(), tolerance);
}

TEST_P(VolumeStructure, parts_of_the_samples_fill_the_cells) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh, {.parts = DiscretizationParts::Frames});
  Vector of_samples = Vector::Zero(d.n_samples()), of_cells = Vector::Zero(mesh.n_cells());
  for (const GradientFrames::Part& part : d.frames.parts) {
    of_samples[part.sample] += part.measure;
    of_cells[part.element] += part.measure;
  }
  EXPECT_LT((of_samples - d.sample_measure).cwiseAbs().maxCoeff(),
            kRounding * d.sample_measure.maxCoeff());
  Vector expected = Vector::Zero(mesh.n_cells());
  const VirtualCells virtuals = virtual_cells(mesh);
  Index cell = 0, left = 0;
  for_virtual_tets(mesh, virtuals, [&](double volume, double) {
    if (left == 0)
      for (const Index f : mesh.cell(cell)) left += static_cast<Index>(mesh.face(f).size());
    expected[cell] += volume;
    if (--left == 0) ++cell;
  });
  EXPECT_LT((of_cells - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeStructure, testing::ValuesIn(volume_claim_cases({0, 1})),
                         volume_case_name);

/// The same on larger meshes, everything of one case at once.
class VolumeStructureFull : public VolumeStructure {};

TEST_P(VolumeStructureFull, all_claims) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  expect_symmetric(d);
  expect_factorisable(d);
  expect_volume(mesh, d);
  expect_linear_precision(mesh, d);
  expect_factorisation(mesh, d, d.divergence());
  EXPECT_LT(gradient_defect(d, mesh.points(), Vec3(0.6, -1.3, 0.4)), 1e-13 * condition(mesh) * 2);
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeStructureFull, testing::ValuesIn(volume_claim_cases({2})),
                         volume_case_name);

class TetStructure : public VolumeClaimTest {};

TEST_P(TetStructure, equals_linear_elements_exactly_where_claimed) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh), primal = discretize(mesh, "primal_tet");
  const double measured = difference(d.stiffness, primal.stiffness);
  if (GetParam().entry->claims.equals_cotan_on_simplices) {
    EXPECT_LT(measured, 1e-12);
    EXPECT_LT((d.lumped_mass() - primal.lumped_mass()).cwiseAbs().maxCoeff(),
              1e-12 * d.lumped_mass().maxCoeff());
  } else {
    EXPECT_GT(measured, 1e-2) << "the diamond is not made of linear elements";
  }
}

INSTANTIATE_TEST_SUITE_P(Volumes, TetStructure,
                         testing::ValuesIn(volume_claim_cases({0, 1},
                                                              [](const VolumeClaimCase& c) {
                                                                return tetrahedral(c.family);
                                                              })),
                         volume_case_name);

/// What does not depend on the operator.
class VolumeProlongation : public VolumeClaimTest {};

TEST_P(VolumeProlongation, is_a_partition_of_unity) {
  const PolyhedralMesh mesh = GetParam().mesh();
  for (const VirtualPoint point : kPoints)
    for (const AffineWeights weights : {AffineWeights::InPlane, AffineWeights::MinimumNorm}) {
      // Weights of least norm in space divide by what keeps a face from being planar, down to the
      // noise of its vertices.
      const double tolerance = weights == AffineWeights::InPlane ? kRounding : 1e5 * kEps;
      const VirtualCells virtuals = virtual_cells(mesh, {point, weights});
      const SparseMatrix p = prolongation_matrix(mesh, virtuals);
      EXPECT_EQ(p.rows(), mesh.n_vertices() + mesh.n_faces() + mesh.n_cells());
      EXPECT_LT((p * Vector::Ones(p.cols()) - Vector::Ones(p.rows())).cwiseAbs().maxCoeff(),
                tolerance);
      // The virtual vertices lie where their weights say.
      const Points all = p * mesh.points();
      EXPECT_LT((all.bottomRows(mesh.n_cells()) - virtuals.cell_points).cwiseAbs().maxCoeff(),
                tolerance);
      EXPECT_LT((all.middleRows(mesh.n_vertices(), mesh.n_faces()) - virtuals.face_points)
                    .cwiseAbs()
                    .maxCoeff(),
                tolerance);
    }
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeProlongation,
                         testing::ValuesIn(volume_claim_cases({0, 1},
                                                              [](const VolumeClaimCase& c) {
                                                                return c.entry ==
                                                                       volume_operators()[0];
                                                              })),
                         volume_case_name);

/// Meshes with a two-colouring, where schemes with one value a cell and a vertex have a spurious
/// kernel: the +1/-1 checkerboard.
class Checkerboard : public VolumeClaimTest {};

TEST_P(Checkerboard, is_not_in_the_kernel) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh, {.parts = DiscretizationParts::Matrices});
  const Vector u = checkerboard(mesh);
  ASSERT_EQ(u.size(), mesh.n_vertices());
  const double energy = u.dot(d.stiffness * u);
  const double scale = u.cwiseAbs().dot(Vector(d.stiffness.diagonal()));
  EXPECT_GT(energy, 0.01 * scale);
}

INSTANTIATE_TEST_SUITE_P(Volumes, Checkerboard,
                         testing::ValuesIn(volume_claim_cases({0, 1},
                                                              [](const VolumeClaimCase& c) {
                                                                return c.family.find("hex") !=
                                                                       std::string::npos;
                                                              })),
                         volume_case_name);

}  // namespace
}  // namespace carat::test
