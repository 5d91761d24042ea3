// Structure that the paper's section 7 promises of every operator, on every family and level:
// symmetry, semidefiniteness, kernel, linear precision, D = -G^T M_s, L = D G, total mass.
// Tolerances are multiples of the rounding unit times the row length or condition that they sum.

#include "carat/solve/cholesky.h"
#include "carat/solve/semidefinite_solver.h"
#include "support/claim_cases.h"
#include "support/measures.h"

namespace carat::test {
namespace {

class Structure : public ClaimTest {};
class LumpedStructure : public ClaimTest {};

// A row adds up to about a hundred terms.
constexpr double kRounding = 100 * kEps;

TEST_P(Structure, stiffness_and_mass_are_symmetric) {
  const Discretization d = discretization(GetParam().mesh());
  EXPECT_LT(asymmetry(d.stiffness), kRounding);
  EXPECT_LT(asymmetry(d.mass), kRounding);
}

TEST_P(Structure, stiffness_is_semidefinite_with_the_constants_as_kernel) {
  const Discretization d = discretization(GetParam().mesh());
  ASSERT_TRUE(GetParam().entry->claims.semidefinite);
  EXPECT_LT(row_sum_defect(d.stiffness), kRounding);
  if (GetParam().options.level == 0) {
    const Vector values = relative_eigenvalues(d.stiffness);
    EXPECT_GT(values[0], -kRounding);
    EXPECT_LT(values[0], kRounding);
    // The next one is of the order of (h / diameter)^2 on these meshes of some 50 vertices.
    EXPECT_GT(values[1], 1e-3);
  } else {
    // Positive definite once a single vertex is held: semidefinite with a kernel of dimension one.
    const SemidefiniteSolver solver(d.stiffness);
    EXPECT_EQ(solver.n_components(), 1);
    Vector rhs = Vector::Zero(d.n_vertices());
    rhs[0] = 1;
    rhs[d.n_vertices() - 1] = -1;
    const Vector u = solver.solve(rhs);
    EXPECT_LT((d.stiffness * u - rhs).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

TEST_P(Structure, mass_is_positive_definite_and_sums_to_the_area) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  const double area =
      GetParam().entry->claims.total_mass ? refinement_area(mesh) : total_vector_area(mesh);
  EXPECT_LT(mass_defect(d.mass, area), 1e-13);
  if (GetParam().planar()) {
    EXPECT_LT(mass_defect(d.mass, 1.0), 1e-13);
  }
  EXPECT_NO_THROW(Cholesky{d.mass});
  EXPECT_NEAR(d.sample_measure.sum(), d.mass.sum(), 1e-13 * d.mass.sum());
}

TEST_P(LumpedStructure, lumped_mass_holds_the_row_sums) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh, {.mass = MassKind::Full});
  const Discretization lumped = discretization(mesh, {.mass = MassKind::Lumped});
  EXPECT_EQ(lumped.mass.nonZeros(), mesh.n_vertices());
  const Vector sums = d.mass * Vector::Ones(mesh.n_vertices());
  const double scale = sums.cwiseAbs().maxCoeff();
  EXPECT_LT((Vector(lumped.mass.diagonal()) - sums).cwiseAbs().maxCoeff(), kRounding * scale);
  EXPECT_LT((d.lumped_mass() - sums).cwiseAbs().maxCoeff(), kRounding * scale);
}

TEST_P(Structure, divergence_is_the_adjoint_of_the_gradient) {
  const Discretization d = discretization(GetParam().mesh());
  const SparseMatrix divergence = d.divergence();
  EXPECT_LT(adjointness_defect(d, divergence), kRounding);
  const Vector x = Vector::LinSpaced(d.gradient.rows(), -1, 2);
  const Vector expected = divergence * x;
  // Beside the terms before they cancel.
  const double terms = (divergence.cwiseAbs() * x.cwiseAbs()).maxCoeff();
  EXPECT_LT((d.apply_divergence(x) - expected).cwiseAbs().maxCoeff(), kRounding * terms);
}

TEST_P(Structure, laplacian_is_divergence_of_gradient) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  const double defect = factorisation_defect(d.stiffness, d.divergence(), d.gradient);
  // A stabilising term has nothing to do on triangles.
  if (GetParam().entry->claims.divergence_of_gradient || GetParam().triangles()) {
    EXPECT_LT(defect, kRounding * condition(mesh));
  } else {
    EXPECT_GT(defect, 1e-3);
  }
  EXPECT_LT(row_sum_defect(d.gradient), kRounding);
  EXPECT_TRUE(same_bits(SparseMatrix(-d.laplacian()), d.stiffness));
}

TEST_P(Structure, prolongation_is_a_partition_of_unity) {
  const PolygonMesh mesh = GetParam().mesh();
  for (const VirtualPoint point :
       {VirtualPoint::AreaMinimizer, VirtualPoint::Centroid, VirtualPoint::TraceMinimizer}) {
    const VirtualVertices virtuals = virtual_vertices(mesh, mesh.points(), {point});
    const SparseMatrix p = prolongation_matrix(mesh, virtuals.weights);
    EXPECT_EQ(p.rows(), mesh.n_vertices() + mesh.n_faces());
    EXPECT_LT((p * Vector::Ones(p.cols()) - Vector::Ones(p.rows())).cwiseAbs().maxCoeff(),
              kRounding);
  }
}

INSTANTIATE_TEST_SUITE_P(Claims, Structure, testing::ValuesIn(claim_cases()), case_name);

INSTANTIATE_TEST_SUITE_P(Claims, LumpedStructure,
                         testing::ValuesIn(claim_cases([](const ClaimCase& c) {
                           return c.full_and_lumped();
                         })),
                         case_name);

class PlaneStructure : public ClaimTest {};

TEST_P(PlaneStructure, linear_functions_are_in_the_kernel_at_inner_vertices) {
  const PolygonMesh mesh = GetParam().mesh();
  for (const VirtualPoint point : virtual_points_of(GetParam().entry->options)) {
    const Discretization d = discretization(mesh, {.virtual_vertex = {point}});
    EXPECT_EQ(d.diagnostics.count("flipped_virtual_vertices"), 0);
    EXPECT_LT(linear_precision_defect(d.stiffness, mesh.points(), inner_vertices(mesh)), 1e-12);
  }
}

TEST_P(PlaneStructure, gradients_of_linear_functions_are_exact) {
  const PolygonMesh mesh = GetParam().mesh();
  const Vec3 c(0.6, -1.3, 0);
  for (const VirtualPoint point : virtual_points_of(GetParam().entry->options)) {
    const Discretization d =
        discretization(mesh, {.virtual_vertex = {point}, .parts = DiscretizationParts::Frames});
    // Values of size 1 differ over heights of h / condition, h > 0.01 here.
    const double tolerance = 10 * kEps / 0.01 * condition(mesh, {point});
    if (!d.is_one_form()) {
      EXPECT_LT(gradient_defect(d, mesh.points(), c), tolerance);
    }
    const Vector g = d.gradient * Vector((mesh.points().rowwise() - mesh.points().row(0)) * c);
    const Points faces = d.element_vectors(g, mesh.n_faces());
    EXPECT_LT((faces.rowwise() - c.transpose()).rowwise().norm().maxCoeff(), tolerance);
    const Points vertices = d.vertex_vectors(g);
    EXPECT_LT((vertices.rowwise() - c.transpose()).rowwise().norm().maxCoeff(), tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Claims, PlaneStructure,
    testing::ValuesIn(claim_cases([](const ClaimCase& c) { return c.planar(); })), case_name);

class TriangleStructure : public ClaimTest {};

TEST_P(TriangleStructure, equals_cotan_exactly_where_claimed) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh), cotan = discretize(mesh, "cotan");
  const double measured = difference(d.stiffness, cotan.stiffness);
  if (GetParam().entry->claims.equals_cotan_on_simplices) {
    EXPECT_LT(measured, 1e-12);
  } else {
    EXPECT_GT(measured, 1e-2) << "the diamond is not cotan";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Claims, TriangleStructure,
    testing::ValuesIn(claim_cases([](const ClaimCase& c) { return c.triangles(); })), case_name);

}  // namespace
}  // namespace carat::test
