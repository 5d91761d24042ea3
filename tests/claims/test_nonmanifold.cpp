// Edges of more than two faces, and other connectivity that is no surface in the narrow sense.

#include "carat/solve/semidefinite_solver.h"
#include "support/claim_cases.h"
#include "support/dense_diamond.h"
#include "support/measures.h"
#include "support/meshes.h"
#include "support/transforms.h"

namespace carat::test {
namespace {

TEST(Nonmanifold, unusual_meshes_keep_the_structural_claims) {
  for (const NamedMesh& named : unusual_meshes())
    for (const char* name : {"diamond", "bunge"}) {
      SCOPED_TRACE(std::string(name) + " " + named.name);
      const Discretization d = discretize(named.mesh, name);
      const double rounding = 200 * kEps * condition(named.mesh);
      EXPECT_TRUE(all_finite(d.stiffness) && all_finite(d.mass) && all_finite(d.gradient));
      EXPECT_LT(asymmetry(d.stiffness), rounding);
      EXPECT_LT(row_sum_defect(d.stiffness), rounding);
      EXPECT_LT(factorisation_defect(d.stiffness, d.divergence(), d.gradient), rounding);
      EXPECT_LT(mass_defect(d.mass, refinement_area(named.mesh)), 1e-13);
      EXPECT_LT(mass_defect(discretize(named.mesh, name, {.mass = MassKind::Lumped}).mass,
                            refinement_area(named.mesh)),
                1e-13);
      const Vector values = relative_eigenvalues(d.stiffness);
      EXPECT_GT(values[0], -rounding);
      // Kernel: a constant for each component and each vertex without a face.
      const auto components = vertex_components(named.mesh);
      const Index dimension =
          *std::max_element(components.begin(), components.end()) + 1 +
          static_cast<Index>(std::count(components.begin(), components.end(), -1));
      for (Index k = 0; k < values.size(); ++k) {
        if (k < dimension) {
          EXPECT_LT(std::abs(values[k]), rounding);
        } else {
          EXPECT_GT(values[k], 1e-4);
        }
      }
      EXPECT_EQ(SemidefiniteSolver(d.stiffness).n_components(),
                *std::max_element(components.begin(), components.end()) + 1);
    }
}

TEST(Nonmanifold, description_of_unusual_meshes_does_not_matter) {
  for (const NamedMesh& named : unusual_meshes())
    for (const char* name : {"diamond", "bunge"}) {
      SCOPED_TRACE(std::string(name) + " " + named.name);
      const Discretization reference = discretize(named.mesh, name);
      const double rounding = 200 * kEps * condition(named.mesh);
      const std::vector<Index> number = permutation(named.mesh.n_vertices(), 9);
      Discretization renumbered = discretize(renumber(named.mesh, number), name);
      renumbered.stiffness = restore_numbers(renumbered.stiffness, number);
      renumbered.mass = restore_numbers(renumbered.mass, number);
      const Discretization others[] = {renumbered,
                                       discretize(permute_faces(named.mesh, 2), name),
                                       discretize(rotate_faces(named.mesh), name),
                                       discretize(flip_faces(named.mesh, 1), name),
                                       discretize(flip_faces(named.mesh, 2), name),
                                       discretize(move_rigidly(named.mesh), name)};
      for (const Discretization& other : others) {
        EXPECT_LT(difference(other.stiffness, reference.stiffness), rounding);
        EXPECT_LT(difference(other.mass, reference.mass), rounding);
      }
    }
}

TEST(Nonmanifold, k_faces_around_an_edge_form_k_half_diamonds) {
  for (const Index pages : {3, 4, 5, 8}) {
    const PolygonMesh mesh = book(pages);
    const Discretization d = discretize(mesh, "diamond", {.parts = DiscretizationParts::Frames});
    EXPECT_EQ(d.n_samples(), mesh.n_edges() - 1 + pages);
    // The pages are in the order of their angles; the literal sum over neighbouring pairs of pages,
    // each a manifold mesh of two faces with its hinge diamond alone, counted half.
    Matrix expected = Matrix::Zero(mesh.n_vertices(), mesh.n_vertices());
    const auto faces = face_lists(mesh);
    const auto hinge_energy = [&](const std::vector<std::vector<Index>>& pair, bool hinge) {
      const DenseDiamond dense = dense_diamond(PolygonMesh::from_faces(mesh.points(), pair));
      const PolygonMesh part = PolygonMesh::from_faces(mesh.points(), pair);
      Matrix sum = Matrix::Zero(mesh.n_vertices(), mesh.n_vertices());
      for (Index e = 0; e < part.n_edges(); ++e) {
        const bool is_hinge = part.edges().vertices[e] == std::array<Index, 2>{0, 1};
        if (is_hinge == hinge)
          sum += dense.measure[e] * dense.gradient.middleRows(2 * e, 2).transpose() *
                 dense.gradient.middleRows(2 * e, 2);
      }
      return sum;
    };
    for (Index k = 0; k < pages; ++k) {
      std::vector<Index> turned = faces[(k + 1) % pages];  // both sides in one orientation
      std::reverse(turned.begin(), turned.end());
      expected += hinge_energy({faces[k], turned}, true) / 2;
      expected += hinge_energy({faces[k]}, false);
    }
    EXPECT_LT((Matrix(d.stiffness) - expected).cwiseAbs().maxCoeff(),
              1e-13 * expected.cwiseAbs().maxCoeff())
        << pages << " pages";
  }
}

TEST(Nonmanifold, two_faces_are_the_ordinary_case) {
  // A fin elsewhere switches the mesh to the general path; the diamonds of other edges stay.
  const PolygonMesh plain = quad_grid(4, 4);
  auto faces = face_lists(plain);
  Points points = plain.points();
  points.conservativeResize(points.rows() + 1, 3);
  points.row(points.rows() - 1) << 0.5, 0.5, 1;
  faces.push_back({6, 7, static_cast<Index>(points.rows()) - 1});
  const Discretization with_fin = discretize(PolygonMesh::from_faces(points, faces));
  const Discretization without = discretize(plain);
  for (const Index far : {23, 24, 19})
    for (const Index other : {24, 18, 22, 23})
      EXPECT_EQ(with_fin.stiffness.coeff(far, other), without.stiffness.coeff(far, other));
  EXPECT_NEAR(with_fin.mass.sum(), without.mass.sum() + std::sqrt(0.25 + 1) / 2, 1e-13 * 16);
}

TEST(Nonmanifold, loose_vertices_are_reported_and_empty) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  for (const SurfaceOperator* entry : surface_operators()) {
    if (entry->claims.simplices_only) continue;
    const Discretization d = discretize(mesh, entry->name);
    const Finding* loose = d.diagnostics.find("unreferenced_vertices");
    ASSERT_NE(loose, nullptr);
    EXPECT_EQ(loose->elements, (std::vector<Index>{3, 4}));
    for (const Index v : {3, 4}) EXPECT_EQ(Matrix(d.stiffness).row(v).cwiseAbs().maxCoeff(), 0);
  }
}

}  // namespace
}  // namespace carat::test
