#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "carat/base/error.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat::test {
namespace {

Points cube_points() {
  Points points(8, 3);
  for (Index v = 0; v < 8; ++v) points.row(v) << (v & 1), (v >> 1 & 1), (v >> 2 & 1);
  return points;
}

Csr rows(const std::vector<std::vector<Index>>& lists) {
  Csr csr;
  for (const auto& list : lists) {
    csr.indices.insert(csr.indices.end(), list.begin(), list.end());
    csr.offsets.push_back(static_cast<Index>(csr.indices.size()));
  }
  return csr;
}

const std::vector<std::vector<Index>> kCubeFaces{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

/// Two unit cubes side by side along x: 12 vertices, 11 faces.
PolyhedralMesh two_cubes() {
  Points points(12, 3);
  for (Index v = 0; v < 12; ++v) points.row(v) << v % 3, v / 3 % 2, v / 6;
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> cells(2, 8);
  cells << 0, 1, 4, 3, 6, 7, 10, 9, 1, 2, 5, 4, 7, 8, 11, 10;
  return PolyhedralMesh::from_hexes(points, cells);
}

std::string message_of(const Points& points, const Csr& faces, const Csr& cells) {
  try {
    PolyhedralMesh(points, faces, cells);
  } catch (const InvalidMesh& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Signed by the side of its faces that the mesh puts the cell on.
double cell_volume(const PolyhedralMesh& mesh, Index c) {
  double six = 0;
  for (const Index f : mesh.cell(c)) {
    const double sign = mesh.face_cells()[f].below == c ? 1 : -1;
    const auto face = mesh.face(f);
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      Eigen::Matrix3d corners;
      corners << mesh.point(face[0]), mesh.point(face[i]), mesh.point(face[i + 1]);
      six += sign * corners.determinant();
    }
  }
  return six / 6;
}

TEST(PolyhedralMesh, shares_the_face_between_two_cells) {
  const PolyhedralMesh mesh = two_cubes();
  EXPECT_EQ(mesh.n_vertices(), 12);
  EXPECT_EQ(mesh.n_faces(), 11);
  EXPECT_EQ(mesh.n_cells(), 2);
  EXPECT_EQ(mesh.n_edges(), 20);
  Index inner = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const FaceCells cells = mesh.face_cells()[f];
    if (cells.boundary()) continue;
    ++inner;
    EXPECT_EQ(cells.below + cells.above, 1);
    EXPECT_EQ(cells.other(0), 1);
    std::vector<Index> face(mesh.face(f).begin(), mesh.face(f).end());
    std::sort(face.begin(), face.end());
    EXPECT_EQ(face, (std::vector<Index>{1, 4, 7, 10}));
  }
  EXPECT_EQ(inner, 1);
  EXPECT_TRUE(mesh.repairs().turned_cells.empty());
}

TEST(PolyhedralMesh, lists_vertices_of_cells_and_cells_of_vertices) {
  const PolyhedralMesh mesh = two_cubes();
  ASSERT_EQ(mesh.cell_vertices().size(0), 8);
  ASSERT_EQ(mesh.cell_vertices().size(1), 8);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const auto corners = mesh.vertex_cell_corners().row(v);
    EXPECT_EQ(corners.size(), v % 3 == 1 ? 2u : 1u);
    for (const Index corner : corners) {
      EXPECT_EQ(mesh.cell_vertices().indices[corner], v);
      const Index c = mesh.corner_cells()[corner];
      EXPECT_GE(corner, mesh.cell_vertices().begin(c));
      EXPECT_LT(corner, mesh.cell_vertices().end(c));
    }
  }
}

TEST(PolyhedralMesh, finds_the_sides_of_faces_however_they_are_turned) {
  for (int turned = 0; turned < 64; ++turned) {
    auto faces = kCubeFaces;
    for (std::size_t f = 0; f < 6; ++f)
      if (turned >> f & 1) std::reverse(faces[f].begin(), faces[f].end());
    const PolyhedralMesh mesh(cube_points(), rows(faces), rows({{0, 1, 2, 3, 4, 5}}));
    for (Index f = 0; f < 6; ++f) {
      EXPECT_EQ(mesh.face_cells()[f].below, turned >> f & 1 ? -1 : 0);
      EXPECT_EQ(mesh.face_cells()[f].above, turned >> f & 1 ? 0 : -1);
    }
    EXPECT_DOUBLE_EQ(cell_volume(mesh, 0), 1);
  }
}

TEST(PolyhedralMesh, merges_faces_that_are_given_twice) {
  Points points(12, 3);
  for (Index v = 0; v < 12; ++v) points.row(v) << v % 3, v / 3 % 2, v / 6;
  // The face between the cubes comes twice, from another vertex and turned.
  const Csr faces = rows({{0, 3, 9, 6},
                          {1, 4, 10, 7},
                          {0, 1, 7, 6},
                          {3, 4, 10, 9},
                          {0, 1, 4, 3},
                          {6, 7, 10, 9},
                          {10, 4, 1, 7},
                          {2, 5, 11, 8},
                          {1, 2, 8, 7},
                          {4, 5, 11, 10},
                          {1, 2, 5, 4},
                          {7, 8, 11, 10}});
  const PolyhedralMesh mesh(points, faces, rows({{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}}));
  EXPECT_EQ(mesh.n_faces(), 11);
  EXPECT_EQ(mesh.repairs().merged_faces, std::vector<Index>{1});
  EXPECT_FALSE(mesh.face_cells()[1].boundary());
  EXPECT_EQ(mesh.face(6)[0], 2) << "later faces move up";
  EXPECT_DOUBLE_EQ(cell_volume(mesh, 0), 1);
  EXPECT_DOUBLE_EQ(cell_volume(mesh, 1), 1);
}

TEST(PolyhedralMesh, keeps_the_sides_of_a_baffle_apart) {
  Points points(12, 3);
  for (Index v = 0; v < 12; ++v) points.row(v) << v % 3, v / 3 % 2, v / 6;
  const Csr faces = rows({{0, 6, 9, 3},
                          {1, 4, 10, 7},
                          {0, 1, 7, 6},
                          {3, 9, 10, 4},
                          {0, 3, 4, 1},
                          {6, 7, 10, 9},
                          {1, 7, 10, 4},
                          {2, 5, 11, 8},
                          {1, 2, 8, 7},
                          {4, 10, 11, 5},
                          {1, 4, 5, 2},
                          {7, 8, 11, 10}});
  const std::vector<Index> owner{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  const PolyhedralMesh mesh = PolyhedralMesh::from_owner_neighbour(points, faces, owner, {});
  EXPECT_EQ(mesh.n_faces(), 12);
  EXPECT_TRUE(mesh.repairs().merged_faces.empty());
  EXPECT_TRUE(mesh.repairs().turned_faces.empty());
  for (Index f = 0; f < 12; ++f) EXPECT_TRUE(mesh.face_cells()[f].boundary());
}

TEST(PolyhedralMesh, reports_faces_that_do_not_point_at_their_neighbour) {
  auto faces = kCubeFaces;
  std::reverse(faces[2].begin(), faces[2].end());
  const std::vector<Index> owner(6, 0);
  const PolyhedralMesh mesh =
      PolyhedralMesh::from_owner_neighbour(cube_points(), rows(faces), owner, {});
  EXPECT_EQ(mesh.repairs().turned_faces, std::vector<Index>{2});
  EXPECT_DOUBLE_EQ(cell_volume(mesh, 0), 1);
}

TEST(PolyhedralMesh, every_cell_type_of_vtk_points_outwards) {
  Points points(8, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  const auto build = [&](CellType type, std::vector<Index> vertices) {
    CellCollector cells;
    cells.add(type, vertices);
    const PolyhedralMesh mesh = std::move(cells).build(points);
    EXPECT_TRUE(mesh.repairs().turned_cells.empty());
    return cell_volume(mesh, 0);
  };
  EXPECT_DOUBLE_EQ(build(CellType::Tetrahedron, {0, 1, 3, 4}), 1.0 / 6);
  EXPECT_DOUBLE_EQ(build(CellType::Hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}), 1);
  EXPECT_DOUBLE_EQ(build(CellType::Voxel, {0, 1, 3, 2, 4, 5, 7, 6}), 1);
  EXPECT_DOUBLE_EQ(build(CellType::Wedge, {0, 1, 3, 4, 5, 7}), 0.5);
  EXPECT_DOUBLE_EQ(build(CellType::Wedge, {0, 3, 1, 4, 7, 5}), 0.5);
  EXPECT_DOUBLE_EQ(build(CellType::Pyramid, {0, 1, 2, 3, 4}), 1.0 / 3);
  // A hexahedron with a collapsed side is a wedge.
  EXPECT_DOUBLE_EQ(build(CellType::Hexahedron, {0, 1, 2, 2, 4, 5, 6, 6}), 0.5);
}

TEST(PolyhedralMesh, reports_cells_that_were_given_inside_out) {
  CellCollector cells;
  cells.add(CellType::Tetrahedron, std::vector<Index>{0, 1, 2, 4});
  cells.add(CellType::Tetrahedron, std::vector<Index>{3, 1, 2, 7});
  const PolyhedralMesh mesh = std::move(cells).build(cube_points());
  EXPECT_EQ(mesh.repairs().turned_cells, std::vector<Index>{1});
  EXPECT_GT(cell_volume(mesh, 0), 0);
  EXPECT_GT(cell_volume(mesh, 1), 0);
}

TEST(PolyhedralMesh, a_cell_folded_over_its_neighbour_keeps_its_negative_volume) {
  PolyhedralMesh mesh = two_cubes();
  Points points = mesh.points();
  // The far side of the second cube goes through the first one.
  for (const Index v : {2, 5, 8, 11}) points(v, 0) = 0.25;
  Csr faces = mesh.face_mesh().faces(), cells = mesh.cells();
  const PolyhedralMesh folded(points, faces, cells);
  EXPECT_DOUBLE_EQ(cell_volume(folded, 0), 1);
  EXPECT_DOUBLE_EQ(cell_volume(folded, 1), -0.75);
}

TEST(PolyhedralMesh, names_what_is_wrong_with_a_cell) {
  const Points points = cube_points();
  const Csr faces = rows(kCubeFaces);
  EXPECT_TRUE(contains(message_of(points, faces, rows({{0, 1, 2, 3, 4}})), "cell 0 is not closed"));
  EXPECT_TRUE(contains(message_of(points, faces, rows({{0, 1, 2}})), "cell 0 has 3 faces"));
  EXPECT_TRUE(contains(message_of(points, faces, rows({{0, 1, 2, 3, 4, 6}})),
                       "cell 0: face 6 does not exist; the mesh has faces 0 to 5"));
  EXPECT_TRUE(contains(message_of(points, faces, rows({{0, 1, 2, 3, 4, 4}})), "face 4 twice"));
  EXPECT_TRUE(contains(
      message_of(points, faces, rows({{0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}})),
      "face 0 belongs to three cells: 0, 1 and 2"));
  Points with_nan = points;
  with_nan(3, 1) = std::nan("");
  EXPECT_TRUE(contains(message_of(with_nan, faces, rows({{0, 1, 2, 3, 4, 5}})), "vertex 3"));
}

TEST(PolyhedralMesh, names_a_cell_of_two_parts) {
  Points points(16, 3);
  points.topRows(8) = cube_points();
  points.bottomRows(8) = cube_points().array() + 3;
  auto faces = kCubeFaces;
  for (const auto& face : kCubeFaces) {
    faces.push_back(face);
    for (Index& v : faces.back()) v += 8;
  }
  const std::string message =
      message_of(points, rows(faces), rows({{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}}));
  EXPECT_TRUE(contains(message, "cell 0 consists of several parts: 6 of its 12 faces")) << message;
}

TEST(PolyhedralMesh, refuses_owners_that_cannot_be) {
  const std::vector<Index> huge(6, 2000000000), few(5, 0), negative(6, -1);
  const auto build = [](const std::vector<Index>& owner) {
    PolyhedralMesh::from_owner_neighbour(cube_points(), rows(kCubeFaces), owner, {});
  };
  EXPECT_THROW(build(huge), InvalidMesh);
  EXPECT_THROW(build(few), InvalidMesh);
  EXPECT_THROW(build(negative), InvalidMesh);
}

TEST(PolyhedralMesh, extracts_its_boundary_facing_outwards) {
  const PolyhedralMesh mesh = two_cubes();
  const BoundarySurface surface = boundary_surface(mesh);
  EXPECT_EQ(surface.mesh.n_faces(), 10);
  EXPECT_EQ(surface.mesh.n_vertices(), 12);
  EXPECT_TRUE(std::is_sorted(surface.face_ids.begin(), surface.face_ids.end()));
  double six_volumes = 0;
  for (Index f = 0; f < 10; ++f) {
    const auto face = surface.mesh.face(f);
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      Eigen::Matrix3d corners;
      corners << surface.mesh.point(face[0]), surface.mesh.point(face[i]),
          surface.mesh.point(face[i + 1]);
      six_volumes += corners.determinant();
    }
  }
  EXPECT_DOUBLE_EQ(six_volumes, 12);
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  EXPECT_EQ(std::count(on_boundary.begin(), on_boundary.end(), true), 12);
}

TEST(PolyhedralMesh, many_cells_at_one_vertex_cost_no_more) {
  // A double fan of tetrahedra around one edge: every face contains vertex 0 or 1.
  constexpr Index n = 50000;
  Points points(n + 2, 3);
  points.row(0) << 0, 0, -1;
  points.row(1) << 0, 0, 1;
  CellCollector cells;
  for (Index k = 0; k < n; ++k) {
    const double angle = 2 * 3.14159265358979 * k / n;
    points.row(k + 2) << std::cos(angle), std::sin(angle), 0;
    cells.add(CellType::Tetrahedron, std::vector<Index>{0, 1, k + 2, (k + 1) % n + 2});
  }
  const PolyhedralMesh mesh = std::move(cells).build(points);
  EXPECT_EQ(mesh.n_faces(), 3 * n);
  EXPECT_EQ(mesh.vertex_cell_corners().size(0), n);
}

}  // namespace
}  // namespace carat::test
