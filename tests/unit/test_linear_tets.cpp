// Linear elements on tetrahedra: the closed form that bunge and primal_tet share.

#include <gtest/gtest.h>

#include "carat/generators/families.h"
#include "carat/operators/linear_tets.h"
#include "carat/operators/registry.h"
#include "support/volume_meshes.h"

namespace carat::test {
namespace {

/// K = 1 as a function may vary within a cell, so that bunge goes over its virtual tetrahedra.
DiscretizationOptions general(DiscretizationOptions options) {
  options.coefficient = [](const Vec3&) { return 1.0; };
  return options;
}

Eigen::Map<const Vector> values(const SparseMatrix& a) { return {a.valuePtr(), a.nonZeros()}; }

void expect_near(const SparseMatrix& a, const SparseMatrix& b) {
  ASSERT_EQ(a.nonZeros(), b.nonZeros());
  ASSERT_GT(b.nonZeros(), 0);
  EXPECT_LT((values(a) - values(b)).cwiseAbs().maxCoeff(), 1e-13 * values(b).cwiseAbs().maxCoeff());
}

/// A third of the cells folded over, one face without cells.
PolyhedralMesh folded() {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 1, .jitter = 0.2});
  Points points = mesh.points();
  points.row(points.rows() / 2) = points.row(0);
  Csr faces = mesh.face_mesh().faces();
  const Index corners[] = {0, 5, 9};
  faces.indices.insert(faces.indices.end(), std::begin(corners), std::end(corners));
  faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  return PolyhedralMesh(points, faces, mesh.cells());
}

Matrix scalars(Index n_cells) { return Vector::LinSpaced(n_cells, 0.5, 3); }

Matrix tensors(Index n_cells) {
  Matrix k(n_cells, 6);
  for (Index c = 0; c < n_cells; ++c) k.row(c) << 1 + 0.1 * (c % 7), 2, 3, 0.3, -0.2, 0.1 * (c % 5);
  return k;
}

TEST(LinearTets, bunge_agrees_with_its_virtual_tetrahedra) {
  for (const PolyhedralMesh& mesh :
       {generate_volume("cube-tets", {.level = 1, .jitter = 0.3}), folded()})
    for (const MassKind mass : {MassKind::Lumped, MassKind::Full})
      for (const Matrix& k : {Matrix(), scalars(mesh.n_cells()), tensors(mesh.n_cells())}) {
        const DiscretizationOptions options{.mass = mass, .cell_coefficient = k};
        const Discretization closed = discretize(mesh, "bunge", options);
        const Discretization wide = discretize(mesh, "bunge", general(options));
        expect_near(closed.stiffness, wide.stiffness);
        expect_near(closed.mass, wide.mass);
        expect_near(closed.gradient, wide.gradient);
        EXPECT_LT((closed.sample_measure - wide.sample_measure).cwiseAbs().maxCoeff(),
                  1e-14 * wide.sample_measure.sum());
        EXPECT_EQ(closed.diagnostics.count("excluded_samples"),
                  wide.diagnostics.count("excluded_samples"));
      }
  EXPECT_GT(discretize(folded(), "bunge").diagnostics.count("excluded_samples"), 0);
}

TEST(LinearTets, masses_do_not_depend_on_the_coefficient) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 1, .jitter = 0.3});
  for (const char* const name : {"bunge", "primal_tet"}) {
    const Discretization plain = discretize(mesh, name);
    for (const Matrix& k : {scalars(mesh.n_cells()), tensors(mesh.n_cells())})
      EXPECT_EQ(values(discretize(mesh, name, {.cell_coefficient = k}).mass), values(plain.mass));
  }
}

TEST(LinearTets, thin_tetrahedra_are_left_to_the_general_form) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 1, .jitter = 0.3});
  // Some virtual tetrahedra count at this limit, others of the same cell do not.
  const DiscretizationOptions options{.eps_rel = 0.0105};
  const Discretization d = discretize(mesh, "bunge", options);
  const Discretization wide = discretize(mesh, "bunge", general(options));
  EXPECT_EQ(values(d.stiffness), values(wide.stiffness));
  const auto excluded = d.diagnostics.count("excluded_samples");
  EXPECT_GT(excluded, 0);
  EXPECT_LT(excluded, d.n_samples());
  EXPECT_EQ(excluded, wide.diagnostics.count("excluded_samples"));
}

TEST(LinearTets, turned_faces_and_single_cells_give_the_values_of_one_tetrahedron) {
  const Vec3 x[] = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0}, {0.1, 0.3, 0.9}};
  const Tetrahedron expected = carat::tetrahedron(x[1], x[0], x[2], x[3], 0);
  // The same tetrahedron with its first face given in either direction.
  for (const bool turn : {false, true}) {
    Points points(4, 3);
    for (Index v = 0; v < 4; ++v) points.row(v) = x[v].transpose();
    Csr faces, cells;
    faces.offsets = {0, 3, 6, 9, 12};
    faces.indices = {0, turn ? 2 : 1, turn ? 1 : 2, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    cells.offsets = {0, 4};
    cells.indices = {0, 1, 2, 3};
    const Discretization d = discretize(PolyhedralMesh(points, faces, cells), "primal_tet",
                                        {.parts = DiscretizationParts::Matrices});
    const Index order[] = {1, 0, 2, 3};
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b)
        EXPECT_NEAR(d.stiffness.coeff(order[a], order[b]), expected.coupling(a, b), 1e-15);
  }
}

TEST(LinearTets, stiffness_alone_is_that_of_all_matrices) {
  for (const char* const family : {"cube-tets", "cube-hexahedra"})
    for (const char* const name : {"bunge", "diamond"}) {
      const PolyhedralMesh mesh = generate_volume(family, {.level = 1, .jitter = 0.2});
      const Discretization all = discretize(mesh, name, {.parts = DiscretizationParts::Matrices});
      const Discretization alone =
          discretize(mesh, name, {.parts = DiscretizationParts::Stiffness});
      EXPECT_EQ(values(alone.stiffness), values(all.stiffness));
      EXPECT_EQ(alone.gradient.size(), 0);
      EXPECT_EQ(alone.mass.size() == 0, std::string(name) == "bunge");
    }
}

}  // namespace
}  // namespace carat::test
