// The closed form of the diamond Laplacian on tetrahedra against the general one.

#include <gtest/gtest.h>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/operators/tet_diamonds.h"

namespace carat::test {
namespace {

Eigen::Map<const Vector> values(const SparseMatrix& a) { return {a.valuePtr(), a.nonZeros()}; }

void expect_near(const SparseMatrix& a, const SparseMatrix& b) {
  ASSERT_EQ(a.nonZeros(), b.nonZeros());
  EXPECT_LT((values(a) - values(b)).cwiseAbs().maxCoeff(), 1e-13 * values(b).cwiseAbs().maxCoeff());
}

/// \param folded  one vertex on the other side of its neighbours
/// \param turned  vertices in reverse, so that the orders of all faces and cells are others
PolyhedralMesh mesh_of(bool folded, bool turned) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 1, .jitter = 0.3});
  const Index n = mesh.n_vertices();
  Points points = mesh.points();
  if (folded) points.row(n / 2) = 0.4 * points.row(0) + 0.6 * points.row(n - 1).reverse();
  Csr faces = mesh.face_mesh().faces();
  if (turned) {
    points = points.colwise().reverse().eval();
    for (Index& v : faces.indices) v = n - 1 - v;
  }
  // One face without cells, and one vertex without either.
  const Index corners[] = {0, 5, 9};
  faces.indices.insert(faces.indices.end(), std::begin(corners), std::end(corners));
  faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  points.conservativeResize(n + 1, 3);
  points.row(n).setZero();
  return PolyhedralMesh(points, faces, mesh.cells());
}

TEST(TetDiamonds, agree_with_the_general_form) {
  for (const bool folded : {false, true})
    for (const bool turned : {false, true})
      for (const MassKind mass : {MassKind::Full, MassKind::Lumped}) {
        const PolyhedralMesh mesh = mesh_of(folded, turned);
        DiscretizationOptions options{.mass = mass};
        const Discretization closed = discretize(mesh, "diamond", options);
        options.coefficient = [](const Vec3&) { return 1.0; };  // may vary within a diamond
        const Discretization general = discretize(mesh, "diamond", options);
        expect_near(closed.stiffness, general.stiffness);
        expect_near(closed.mass, general.mass);
        EXPECT_LT((closed.sample_measure - general.sample_measure).cwiseAbs().maxCoeff(),
                  1e-14 * general.sample_measure.sum());
        const auto excluded = closed.diagnostics.count("excluded_samples");
        EXPECT_EQ(excluded, general.diagnostics.count("excluded_samples"));
        EXPECT_EQ(excluded > 0, folded);
      }
}

TEST(TetDiamonds, stabilised_agree_with_the_general_form) {
  for (const bool folded : {false, true})
    for (const bool turned : {false, true})
      for (const MassKind mass : {MassKind::Full, MassKind::MomentExact, MassKind::Lumped})
        for (const double theta : {0.0, 2.0 / 3, 1.0}) {
          SCOPED_TRACE("theta " + std::to_string(theta));
          const PolyhedralMesh mesh = mesh_of(folded, turned);
          DiscretizationOptions options{.mass = mass, .theta = theta};
          if (mass == MassKind::MomentExact) options.tau = 0.7;
          const Discretization closed = discretize(mesh, "stabilized_diamond", options);
          options.coefficient = [](const Vec3&) { return 1.0; };
          const Discretization general = discretize(mesh, "stabilized_diamond", options);
          expect_near(closed.stiffness, general.stiffness);
          expect_near(closed.mass, general.mass);
          EXPECT_LT((closed.sample_measure - general.sample_measure).cwiseAbs().maxCoeff(),
                    1e-14 * general.sample_measure.sum());
        }
}

TEST(TetDiamonds, stabilised_have_the_same_bits_for_any_number_of_threads_and_are_symmetric) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 2, .jitter = 0.3});
  DiscretizationOptions options{
      .mass = MassKind::MomentExact, .parts = DiscretizationParts::Matrices, .threads = 1};
  const Discretization one = discretize(mesh, "stabilized_diamond", options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    const Discretization many = discretize(mesh, "stabilized_diamond", options);
    EXPECT_EQ(values(one.stiffness), values(many.stiffness));
    EXPECT_EQ(values(one.mass), values(many.mass));
  }
  EXPECT_LT((values(one.stiffness) - values(SparseMatrix(one.stiffness.transpose())))
                .cwiseAbs()
                .maxCoeff(),
            1e-15 * values(one.stiffness).cwiseAbs().maxCoeff());
}

TEST(TetDiamonds, topology_names_what_is_opposite_and_across) {
  // Two tetrahedra on the face (1, 2, 3).
  Points points(5, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1;
  Eigen::Matrix<Index, 2, 4, Eigen::RowMajor> cells;
  cells << 3, 1, 0, 2, 4, 2, 1, 3;
  const PolyhedralMesh mesh = PolyhedralMesh::from_tets(points, cells);
  const VolumeIncidence incidence{mesh.face_mesh().faces(), mesh.cells(),
                                  mesh.face_cells(),        mesh.cell_vertices(),
                                  mesh.corner_cells(),      mesh.vertex_cell_corners()};
  const TetTopology tets = tet_topology(incidence, {}, 1);
  EXPECT_EQ(tets.vertices[0], (std::array<Index, 8>{0, 1, 2, 3, 4, -1, -1, -1}));
  EXPECT_EQ(tets.vertices[1], (std::array<Index, 8>{1, 2, 3, 4, -1, -1, -1, 0}));
  // Vertex 3 sees 0, 1, 2 counter-clockwise; 4 sees 1, 2, 3 so as well.
  EXPECT_EQ(tets.signs[0], 1);
  EXPECT_EQ(tets.signs[1], 1);
  for (std::size_t c = 0; c < 2; ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      const Index f = tets.measured_faces[c][k];
      if (f < 0) continue;
      const auto face = mesh.face(f);
      EXPECT_EQ(std::count(face.begin(), face.end(), tets.vertices[c][k]), 0);
    }
  // The common face is measured once.
  EXPECT_EQ((tets.measured_faces[0][0] < 0) + (tets.measured_faces[1][3] < 0), 1);
}

}  // namespace
}  // namespace carat::test
