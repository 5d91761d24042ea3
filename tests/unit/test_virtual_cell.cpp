#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "carat/kernels/virtual_cell.h"
#include "carat/mesh/polyhedral_mesh.h"
#include "carat/prolongation/virtual_cells.h"

namespace carat::test {
namespace {

constexpr double kEps = 2.2e-16;

PolyhedralMesh hexahedron(const Points& points) {
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> cell(1, 8);
  cell << 0, 1, 2, 3, 4, 5, 6, 7;
  return PolyhedralMesh::from_hexes(points, cell);
}

Points cube_points() {
  Points points(8, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  return points;
}

Points bent_points() {
  Points points = cube_points();
  for (Index v = 0; v < 8; ++v)
    for (Index k = 0; k < 3; ++k) points(v, k) += 0.15 * std::sin(7.0 * v + 3.0 * k + 1);
  return points;
}

VirtualCells virtuals_of(const PolyhedralMesh& mesh, const VirtualVertexRule& rule = {}) {
  VirtualCells virtuals;
  update_virtual_cells(mesh, mesh.points(), rule, 1, virtuals);
  return virtuals;
}

double squared_volumes(const PolyhedralMesh& mesh, const Points& face_points, const Vec3& x) {
  double sum = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t i = 0; i < face.size(); ++i) {
      Eigen::Matrix3d edges;
      edges << mesh.point(face[i]) - x, mesh.point(face[(i + 1) % face.size()]) - x,
          Vec3(face_points.row(f).transpose()) - x;
      sum += std::pow(edges.determinant() / 6, 2);
    }
  }
  return sum;
}

TEST(VirtualCell, point_minimises_the_squared_volumes) {
  const PolyhedralMesh mesh = hexahedron(bent_points());
  const VirtualCells virtuals = virtuals_of(mesh);
  const Vec3 x = virtuals.cell_points.row(0).transpose();
  const double least = squared_volumes(mesh, virtuals.face_points, x);
  // A quadratic function: at a minimum, steps both ways cost the same.
  for (const Vec3& d : {Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0, 0, 0.1)}) {
    const double up = squared_volumes(mesh, virtuals.face_points, x + d);
    const double down = squared_volumes(mesh, virtuals.face_points, x - d);
    EXPECT_GT(up, least);
    EXPECT_NEAR(up, down, 1e-12 * up);
  }
}

TEST(VirtualCell, weights_are_those_of_least_norm_composed_with_the_faces) {
  const PolyhedralMesh mesh = hexahedron(bent_points());
  const VirtualCells virtuals = virtuals_of(mesh);
  // Least norm over 8 vertices and 6 face points, by a dense solver.
  Matrix constraints(4, 14);
  for (Index k = 0; k < 8; ++k)
    constraints.col(k) << 1, mesh.point(mesh.cell_vertices().indices[k]);
  for (Index k = 0; k < 6; ++k)
    constraints.col(8 + k) << 1, virtuals.face_points.row(mesh.cell(0)[k]).transpose();
  Vector target(4);
  target << 1, virtuals.cell_points.row(0).transpose();
  const Vector direct = constraints.completeOrthogonalDecomposition().solve(target);
  for (Index k = 0; k < 8; ++k) {
    const Index v = mesh.cell_vertices().indices[k];
    double composed = direct[k];
    for (Index j = 0; j < 6; ++j) {
      const Index f = mesh.cell(0)[j];
      for (Index c = mesh.face_mesh().faces().begin(f); c < mesh.face_mesh().faces().end(f); ++c)
        if (mesh.face_mesh().faces().indices[c] == v)
          composed += direct[8 + j] * virtuals.faces.weights[c];
    }
    EXPECT_NEAR(virtuals.cell_weights[k], composed, 100 * kEps);
  }
}

TEST(VirtualCell, tetrahedra_have_quarters_and_cubes_eighths) {
  CellCollector cells;
  cells.add(CellType::Tetrahedron, std::vector<Index>{0, 1, 3, 4});
  const VirtualCells tet = virtuals_of(std::move(cells).build(bent_points()));
  for (const double w : tet.cell_weights) EXPECT_EQ(w, 0.25);
  const VirtualCells cube = virtuals_of(hexahedron(cube_points()));
  for (const double w : cube.cell_weights) EXPECT_NEAR(w, 0.125, 10 * kEps);
  for (Index k = 0; k < 3; ++k) EXPECT_NEAR(cube.cell_points(0, k), 0.5, 10 * kEps);
}

TEST(VirtualCell, centroid_is_the_mean_of_vertices_and_face_points) {
  const PolyhedralMesh mesh = hexahedron(bent_points());
  const VirtualCells virtuals = virtuals_of(mesh, {.point = VirtualPoint::Centroid});
  const Eigen::RowVector3d mean =
      (mesh.points().colwise().sum() + virtuals.face_points.colwise().sum()) / 14;
  EXPECT_LT((virtuals.cell_points.row(0) - mean).norm(), 10 * kEps);
}

TEST(VirtualCell, does_not_depend_on_place_and_unit) {
  const VirtualCells reference = virtuals_of(hexahedron(bent_points()));
  for (const double scale : {1e-9, 1e9}) {
    const VirtualCells scaled = virtuals_of(hexahedron(scale * bent_points()));
    for (std::size_t k = 0; k < 8; ++k)
      EXPECT_NEAR(scaled.cell_weights[k], reference.cell_weights[k], 1e-14);
  }
}

/// A prism over a polygon, whose kernel is that of the polygon.
PolyhedralMesh prism(const std::vector<Vec2>& polygon) {
  const Index n = static_cast<Index>(polygon.size());
  Points points(2 * n, 3);
  CellCollector cells;
  std::vector<Index> bottom, top;
  for (Index k = 0; k < n; ++k) {
    points.row(k) << polygon[k].x(), polygon[k].y(), 0;
    points.row(n + k) << polygon[k].x(), polygon[k].y(), 1;
    bottom.push_back(n - 1 - k);
    top.push_back(n + k);
    const Index next = k + 1 == n ? 0 : k + 1;
    cells.add_face(std::vector<Index>{k, next, n + next, n + k});
  }
  cells.add_face(bottom);
  cells.add_face(top);
  cells.end_cell();
  return std::move(cells).build(std::move(points));
}

TEST(VirtualCell, point_of_a_concave_cell_is_moved_into_the_kernel) {
  // An L with thin arms: the kernel is the small square at its corner.
  const PolyhedralMesh mesh = prism({{0, 0}, {4, 0}, {4, 0.5}, {0.5, 0.5}, {0.5, 4}, {0, 4}});
  const VirtualVertexRule centroid{.point = VirtualPoint::Centroid};
  const VirtualCells virtuals = virtuals_of(mesh, centroid);
  ASSERT_EQ(virtuals.cell_status[0], VirtualVertexStatus::Moved);
  const Vec3 x = virtuals.cell_points.row(0).transpose();
  for (Index k = 0; k < 2; ++k) {
    EXPECT_GT(x[k], 0);
    EXPECT_LT(x[k], 0.5);
  }
  EXPECT_NEAR(x.z(), 0.5, 1e-9) << "by symmetry";
  EXPECT_NEAR(x.x(), x.y(), 1e-9) << "by symmetry";
  const VirtualCells kept =
      virtuals_of(mesh, {.point = VirtualPoint::Centroid, .keep_in_kernel = false});
  EXPECT_EQ(kept.cell_status[0], VirtualVertexStatus::Flipped);
}

TEST(VirtualCell, a_cell_without_a_kernel_is_reported) {
  // A U: no point sees all of it.
  const PolyhedralMesh mesh =
      prism({{0, 0}, {5, 0}, {5, 4}, {4, 4}, {4, 1}, {1, 1}, {1, 4}, {0, 4}});
  const VirtualCells virtuals = virtuals_of(mesh);
  EXPECT_EQ(virtuals.cell_status[0], VirtualVertexStatus::Flipped);
  double sum = 0;
  for (const double w : virtuals.cell_weights) sum += w;
  EXPECT_NEAR(sum, 1, 1e-13);
  Diagnostics diagnostics;
  report_virtual_cells(virtuals, diagnostics);
  EXPECT_EQ(diagnostics.count("flipped_cell_points"), 1);
}

TEST(VirtualCell, a_flat_cell_is_degenerate_and_finite) {
  Points points = cube_points();
  points.col(2).setZero();
  const PolyhedralMesh mesh = hexahedron(bent_points()).with_points(points);
  const VirtualCells virtuals = virtuals_of(mesh);
  EXPECT_EQ(virtuals.cell_status[0], VirtualVertexStatus::Degenerate);
  for (const double w : virtuals.cell_weights) EXPECT_TRUE(std::isfinite(w));
}

TEST(HalfSpaceCenter, of_a_box_and_of_nothing) {
  std::vector<HalfSpace> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back({Vec3::Unit(axis), 0.75});
    planes.push_back({-Vec3::Unit(axis), -0.25});
  }
  Vec3 center;
  ASSERT_TRUE(half_space_center(planes, center));
  EXPECT_LT((center - Vec3::Constant(0.5)).norm(), 1e-9);
  // Weights by the lengths of the normals: 3 log(0.75 - x) + log(x - 0.25) is largest at 0.375.
  planes[0] = {3 * Vec3::Unit(0), 3 * 0.75};
  ASSERT_TRUE(half_space_center(planes, center));
  EXPECT_NEAR(center.x(), 0.375, 1e-7);
  planes.push_back({Vec3::Unit(0), 0.2});
  EXPECT_FALSE(half_space_center(planes, center));
}

}  // namespace
}  // namespace carat::test
