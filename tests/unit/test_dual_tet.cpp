// The dual Laplacian of tetrahedra: its signs on Delaunay meshes and far from them. It has no place
// among the claims that all operators are held to, as it is not semidefinite.

#include <gtest/gtest.h>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "support/volume_measures.h"
#include "support/volume_transforms.h"

namespace carat::test {
namespace {

/// By how much the nearest vertex lies within a circumsphere, over its radius; <= 0: Delaunay.
double delaunay_defect(const PolyhedralMesh& mesh) {
  double worst = -1;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    const auto v = mesh.cell_vertices().row(c);
    Eigen::Matrix3d rows;
    Vec3 rhs;
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = mesh.point(v[static_cast<std::size_t>(k) + 1]) - mesh.point(v[0]);
      rows.row(k) = 2 * d.transpose();
      rhs[k] = d.squaredNorm();
    }
    const Vec3 centre = mesh.point(v[0]) + rows.fullPivLu().solve(rhs);
    const double radius = (mesh.point(v[0]) - centre).norm();
    for (Index p = 0; p < mesh.n_vertices(); ++p)
      worst = std::max(worst, 1 - (mesh.point(p) - centre).norm() / radius);
  }
  return worst;
}

/// Jittered tetrahedra of the cube, pressed flat: far from Delaunay.
PolyhedralMesh pressed() {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 0, .jitter = 0.3});
  Points points = mesh.points();
  points.col(2) *= 0.1;
  return mesh.with_points(points);
}

TEST(DualTet, delaunay_meshes_have_no_positive_coupling_of_inner_vertices) {
  for (const int level : {0, 1}) {
    const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = level});
    ASSERT_LT(delaunay_defect(mesh), 1e-12);
    const Discretization d = discretize(mesh, "dual_tet");
    const std::vector<bool> inner = inner_vertices(mesh);
    Index n_inner = 0;
    for (Index row = 0; row < d.n_vertices(); ++row) {
      if (!inner[static_cast<std::size_t>(row)]) continue;
      ++n_inner;
      const double diagonal = d.stiffness.coeff(row, row);
      EXPECT_GT(diagonal, 0);
      for (SparseMatrix::InnerIterator entry(d.stiffness, row); entry; ++entry)
        if (entry.col() != row) {
          EXPECT_LT(entry.value(), 1e-14 * diagonal);
        }
    }
    EXPECT_GT(n_inner, 0);
    if (level == 0) {
      EXPECT_GT(relative_eigenvalues(d.stiffness)[0], -1e-14);
    }
    EXPECT_GT(d.mass.diagonal().minCoeff(), 0);
    EXPECT_EQ(d.diagnostics.count("negative_masses"), 0);
  }
}

TEST(DualTet, pressed_meshes_are_indefinite) {
  const PolyhedralMesh mesh = pressed();
  ASSERT_GT(delaunay_defect(mesh), 0.1);
  const Discretization d = discretize(mesh, "dual_tet");
  EXPECT_LT(relative_eigenvalues(d.stiffness)[0], -0.01);
  EXPECT_LT(d.mass.diagonal().minCoeff(), 0);
  EXPECT_GT(d.diagnostics.count("negative_masses"), 0);
  // What holds in spite of that.
  EXPECT_LT(asymmetry(d.stiffness), 1e-14);
  EXPECT_LT(row_sum_defect(d.stiffness), 1e-12);
  EXPECT_LT(linear_precision_defect(d.stiffness, mesh.points(), inner_vertices(mesh)), 1e-12);
  EXPECT_NEAR(total(d.mass), 0.1, 1e-13);
}

TEST(DualTet, mass_sums_to_the_volume) {
  for (const char* family : {"cube-tets", "cube-tets-adaptive"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 1, .jitter = 0.2});
    EXPECT_NEAR(total(discretize(mesh, "dual_tet").mass), 1, 1e-12) << family;
  }
}

TEST(DualTet, does_not_depend_on_numbers_scale_and_place) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 0, .jitter = 0.2});
  const Discretization d = discretize(mesh, "dual_tet");
  const Discretization far = discretize(
      mesh.with_points(mesh.points().rowwise() + Eigen::RowVector3d(1e6, -2e6, 5e5)), "dual_tet");
  // Coordinates of 1e6 keep ten digits of the unit cube; circumcentres take another one.
  EXPECT_LT(difference(far.stiffness, d.stiffness), 1e-8);
  const Discretization large = discretize(mesh.with_points(mesh.points() * 0x1p30), "dual_tet");
  EXPECT_TRUE(same_bits(large.stiffness, SparseMatrix(d.stiffness * 0x1p30)));
  const Discretization threads = discretize(mesh, "dual_tet", {.threads = 3});
  EXPECT_TRUE(same_bits(threads.stiffness, d.stiffness));
}

TEST(DualTet, coefficients_and_errors) {
  const PolyhedralMesh mesh = generate_volume("cube-tets", {.level = 0});
  const Discretization d = discretize(mesh, "dual_tet");
  DiscretizationOptions options;
  options.cell_coefficient = Matrix::Constant(mesh.n_cells(), 1, 3);
  options.coefficient = [](const Vec3&) { return 2.0; };
  EXPECT_LT(
      difference(discretize(mesh, "dual_tet", options).stiffness, SparseMatrix(6 * d.stiffness)),
      1e-14);
  options.cell_coefficient = Matrix::Zero(mesh.n_cells(), 6);
  options.cell_coefficient.leftCols(3).setOnes();
  EXPECT_THROW(discretize(mesh, "dual_tet", options), InvalidOption);
  EXPECT_THROW(discretize(generate_volume("cube-hexahedra"), "dual_tet"), InvalidMesh);
  EXPECT_THROW(discretize(mesh, "dual_tet", {.mass = MassKind::Full}), InvalidOption);
  Points flat = mesh.points();
  flat.col(2).setZero();
  EXPECT_EQ(discretize(mesh.with_points(flat), "dual_tet").diagnostics.count("excluded_samples"),
            mesh.n_cells());
}

}  // namespace
}  // namespace carat::test
