// Kinds of cells, and their vertices in the order of VTK.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "carat/mesh/cell_kind.h"

namespace carat::test {
namespace {

Points corners_of(CellType type) {
  if (type == CellType::Wedge) {
    Points points(6, 3);
    points << 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 1, 1, 1, 0, 1;
    return points;
  }
  Points points(8, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  if (type == CellType::Hexahedron) return points;
  if (type == CellType::Tetrahedron) {
    Points four(4, 3);
    four << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    return four;
  }
  return points.topRows(5);
}

std::vector<Index> count_up(std::size_t n) {
  std::vector<Index> ids(n);
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

struct Case {
  CellType type;
  CellKind kind;
  std::size_t n_vertices;
};
const std::vector<Case> kCases = {{CellType::Tetrahedron, CellKind::Tetrahedron, 4},
                                  {CellType::Hexahedron, CellKind::Hexahedron, 8},
                                  {CellType::Wedge, CellKind::Wedge, 6},
                                  {CellType::Pyramid, CellKind::Pyramid, 5}};

/// Faces as sets of vertices: what a cell is but for orientation.
std::multiset<std::set<Index>> face_sets(const PolyhedralMesh& mesh, Index c) {
  std::multiset<std::set<Index>> sets;
  for (const Index f : mesh.cell(c)) sets.insert({mesh.face(f).begin(), mesh.face(f).end()});
  return sets;
}

TEST(CellKind, IsFoundWithVerticesInAnOrderThatGivesTheCellBack) {
  for (const Case& expected : kCases) {
    CellCollector cells;
    cells.add(expected.type, count_up(expected.n_vertices));
    const PolyhedralMesh mesh = std::move(cells).build(corners_of(expected.type));
    const StandardCell cell = standard_cell(mesh, 0);
    ASSERT_EQ(cell.kind, expected.kind);
    ASSERT_EQ(cell.vertices().size(), expected.n_vertices);
    CellCollector again;
    again.add(expected.type, cell.vertices());
    const PolyhedralMesh back = std::move(again).build(mesh.points());
    EXPECT_EQ(face_sets(back, 0), face_sets(mesh, 0));
    // As VTK has it: not turned inside out. (Wedges are in use in both ways.)
    EXPECT_TRUE(back.repairs().turned_cells.empty()) << cell_kind_name(cell.kind);
  }
}

TEST(CellKind, WedgeHasItsFirstTriangleOutwards) {
  CellCollector cells;
  cells.add(CellType::Wedge, count_up(6));
  const PolyhedralMesh mesh = std::move(cells).build(corners_of(CellType::Wedge));
  const StandardCell cell = standard_cell(mesh, 0);
  ASSERT_EQ(cell.kind, CellKind::Wedge);
  const auto at = [&](std::size_t k) { return mesh.point(cell.vertex_array[k]); };
  const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
  EXPECT_LT(normal.dot(at(3) - at(0)), 0);
}

TEST(CellKind, DoesNotDependOnDirectionAndOrderOfTheFaces) {
  const std::vector<std::vector<Index>> faces = {{0, 4, 7, 3}, {5, 6, 2, 1}, {0, 1, 5, 4},
                                                 {2, 6, 7, 3}, {0, 1, 2, 3}, {7, 4, 5, 6}};
  std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5};
  do {
    CellCollector cells;
    for (const std::size_t f : order) cells.add_face(faces[f]);
    cells.end_cell();
    const PolyhedralMesh mesh = std::move(cells).build(corners_of(CellType::Hexahedron));
    EXPECT_EQ(cell_kind(mesh, 0), CellKind::Hexahedron);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(CellKind, OtherCellsArePolyhedra) {
  // A tetrahedron with one face cut in two: six faces, none a quadrilateral.
  Points points(5, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0;
  CellCollector cells;
  for (const std::vector<Index>& face : std::vector<std::vector<Index>>{
           {0, 2, 4}, {4, 2, 1}, {0, 4, 3}, {4, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    cells.add_face(face);
  cells.end_cell();
  EXPECT_EQ(cell_kind(std::move(cells).build(points), 0), CellKind::Polyhedron);

  // A prism over a pentagon: seven faces.
  Points prism(10, 3);
  for (int k = 0; k < 10; ++k)
    prism.row(k) << std::cos(k % 5 * 1.2566), std::sin(k % 5 * 1.2566), k / 5;
  CellCollector five;
  five.add_face(std::vector<Index>{0, 1, 2, 3, 4});
  five.add_face(std::vector<Index>{5, 6, 7, 8, 9});
  for (Index k = 0; k < 5; ++k)
    five.add_face(std::vector<Index>{k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k});
  five.end_cell();
  const PolyhedralMesh mesh = std::move(five).build(prism);
  EXPECT_EQ(cell_kind(mesh, 0), CellKind::Polyhedron);
  EXPECT_TRUE(standard_cell(mesh, 0).vertices().empty());
}

/// Two triangles and three quadrilaterals that are no wedge: both triangles share an edge.
TEST(CellKind, FacesMustMeetLikeThoseOfTheKind) {
  Points points(6, 3);
  points << 0, 0, 0, 1, 0, 0, 0.5, 1, 0.2, 0.5, -1, 0.2, 0.2, 0.3, 1, 0.8, 0.3, 1;
  CellCollector cells;
  for (const std::vector<Index>& face : std::vector<std::vector<Index>>{
           {0, 1, 2}, {1, 0, 3}, {0, 2, 4, 3}, {1, 3, 5, 2}, {2, 5, 3, 4}})
    cells.add_face(face);
  cells.end_cell();
  EXPECT_EQ(cell_kind(std::move(cells).build(points), 0), CellKind::Polyhedron);
}

}  // namespace
}  // namespace carat::test
