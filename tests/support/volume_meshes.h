#pragma once
// Small volume meshes made by hand: every one is a case that real input contains.

#include "support/meshes.h"
#include "support/volume_transforms.h"

namespace carat::test {

struct NamedVolume {
  const char* name;
  PolyhedralMesh mesh;
};

inline PolyhedralMesh tets(const std::vector<Vec3>& points,
                           const std::vector<std::array<Index, 4>>& cells) {
  CellCollector collector;
  for (const auto& cell : cells) collector.add(CellType::Tetrahedron, cell);
  return std::move(collector).build(make_points(points));
}

/// n^3 hexahedra of side 1; vertex (i, j, k) has the number (k (n + 1) + j) (n + 1) + i.
inline PolyhedralMesh hex_grid(Index n) {
  std::vector<Vec3> points;
  for (Index k = 0; k <= n; ++k)
    for (Index j = 0; j <= n; ++j)
      for (Index i = 0; i <= n; ++i) points.emplace_back(i, j, k);
  const Index s = n + 1;
  CellCollector collector;
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        const Index v = (k * s + j) * s + i;
        collector.add(CellType::Hexahedron,
                      std::array<Index, 8>{v, v + 1, v + s + 1, v + s, v + s * s, v + s * s + 1,
                                           v + s * s + s + 1, v + s * s + s});
      }
  return std::move(collector).build(make_points(points));
}

/// A prism over an n-gon, the honeycomb's cell for n = 6.
inline PolyhedralMesh prism_over_polygon(Index n) {
  std::vector<Vec3> points;
  Lists faces(2), cells(1);
  for (Index i = 0; i < 2 * n; ++i) {
    const double angle = 2 * std::numbers::pi * (i % n) / n;
    points.emplace_back(std::cos(angle), std::sin(angle), i < n ? 0 : 1);
  }
  for (Index i = 0; i < n; ++i) {
    faces[0].push_back(i);
    faces[1].push_back(n + i);
    faces.push_back({i, (i + 1) % n, n + (i + 1) % n, n + i});
  }
  for (Index f = 0; f < n + 2; ++f) cells[0].push_back(f);
  return make_volume(make_points(points), faces, cells);
}

/// 2^3 hexahedra whose inner vertex was pulled out through a face: some cells are folded over.
inline PolyhedralMesh folded_hexes() {
  const PolyhedralMesh grid = hex_grid(2);
  Points points = grid.points();
  points.row(13) = Eigen::RowVector3d(1, 1, 2.6);
  return grid.with_points(points);
}

/// Two hexahedra whose common face is far from planar.
inline PolyhedralMesh twisted_hexes() {
  CellCollector collector;
  collector.add(CellType::Hexahedron, std::array<Index, 8>{0, 1, 2, 3, 4, 5, 6, 7});
  collector.add(CellType::Hexahedron, std::array<Index, 8>{4, 5, 6, 7, 8, 9, 10, 11});
  return std::move(collector).build(make_points({{0, 0, 0},
                                                 {1, 0, 0},
                                                 {1, 1, 0},
                                                 {0, 1, 0},
                                                 {0, 0, 1.3},
                                                 {1, 0, 0.7},
                                                 {1, 1, 1.3},
                                                 {0, 1, 0.7},
                                                 {0, 0, 2},
                                                 {1, 0, 2},
                                                 {1, 1, 2},
                                                 {0, 1, 2}}));
}

/// An L-shaped cell that does not contain the mean of its vertices, and the box that fills its
/// notch: both share two faces.
inline PolyhedralMesh l_shaped_cell() {
  std::vector<Vec3> points;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] :
         {std::pair{0., 0.}, {4., 0.}, {4., 1.}, {1., 1.}, {1., 4.}, {0., 4.}, {4., 4.}})
      points.emplace_back(x, y, z);
  // 0..6 below, 7..13 above.
  const Lists faces{{0, 1, 2, 3, 4, 5}, {7, 8, 9, 10, 11, 12}, {0, 1, 8, 7},   {1, 2, 9, 8},
                    {2, 3, 10, 9},      {3, 4, 11, 10},        {4, 5, 12, 11}, {5, 0, 7, 12},
                    {3, 2, 6, 4},       {10, 9, 13, 11},       {2, 6, 13, 9},  {6, 4, 11, 13}};
  return make_volume(make_points(points), faces, {{0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 8, 9, 10, 11}});
}

/// Two tetrahedra far apart, vertices and a face without a cell.
inline PolyhedralMesh two_components_with_loose_parts() {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {7, 7, 7}, {9, 0, 0},
                                 {9, 1, 0}, {9, 0, 1}, {10, 0, 0}, {5, 5, 5}, {5, 6, 5}, {5, 5, 6}};
  const Lists faces{{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}, {9, 10, 11},
                    {5, 6, 7}, {5, 6, 8}, {6, 7, 8}, {5, 7, 8}, {0, 1, 9}};
  return make_volume(make_points(points), faces, {{0, 1, 2, 3}, {5, 6, 7, 8}});
}

/// Meshes of positive volume without degenerate parts.
inline std::vector<NamedVolume> unusual_volumes() {
  return {
      {"single_tet", tets({{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.3, 0.4, 0.9}}, {{0, 1, 2, 3}})},
      {"single_hex", hex_grid(1)},
      {"hexagonal_prism", prism_over_polygon(6)},
      {"prism_over_17", prism_over_polygon(17)},
      {"twisted_hexes", twisted_hexes()},
      {"l_shaped_cell", l_shaped_cell()},
      {"two_components", two_components_with_loose_parts()}};
}

}  // namespace carat::test
