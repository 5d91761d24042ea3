#include "volume_grids.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace carat::bench {
namespace {

/// Uniform in [-1, 1], from the place alone.
double noise(std::uint64_t place) {
  place += 0x9e3779b97f4a7c15ULL;
  place = (place ^ (place >> 30)) * 0xbf58476d1ce4e5b9ULL;
  place = (place ^ (place >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>(static_cast<std::int64_t>(place ^ (place >> 31))) * 0x1p-63;
}

void jitter(Points& points, double size) {
  for (Index v = 0; v < points.rows(); ++v)
    for (Index k = 0; k < 3; ++k)
      points(v, k) += size * noise(3 * static_cast<std::uint64_t>(v) + static_cast<unsigned>(k));
}

PolyhedralMesh cubes(Index n, bool tets) {
  const Index m = n + 1;
  Points points(Eigen::Index{m} * m * m, 3);
  const auto number = [&](Index i, Index j, Index k) { return (k * m + j) * m + i; };
  for (Index k = 0; k < m; ++k)
    for (Index j = 0; j < m; ++j)
      for (Index i = 0; i < m; ++i) points.row(number(i, j, k)) << i, j, k;
  jitter(points, 0.1);
  CellCollector cells;
  // Tetrahedra along the six ways from one corner to the opposite one.
  constexpr std::array<std::array<int, 3>, 6> kWays{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        if (!tets) {
          const std::array<Index, 8> cell{number(i, j, k),
                                          number(i + 1, j, k),
                                          number(i + 1, j + 1, k),
                                          number(i, j + 1, k),
                                          number(i, j, k + 1),
                                          number(i + 1, j, k + 1),
                                          number(i + 1, j + 1, k + 1),
                                          number(i, j + 1, k + 1)};
          cells.add(CellType::Hexahedron, cell);
          continue;
        }
        for (const auto& way : kWays) {
          std::array<Index, 3> at{i, j, k};
          std::array<Index, 4> cell{number(i, j, k), 0, 0, 0};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(way[step])];
            cell[step + 1] = number(at[0], at[1], at[2]);
          }
          cells.add(CellType::Tetrahedron, cell);
        }
      }
  return std::move(cells).build(std::move(points));
}

/// Truncated octahedra about the points of a body-centred lattice of spacing 4.
PolyhedralMesh truncated_octahedra(Index n) {
  const Index m = 4 * n + 5;
  std::vector<Index> number(static_cast<std::size_t>(m) * m * m, -1);
  std::vector<Vec3> positions;
  const auto vertex = [&](Index x, Index y, Index z) {
    Index& v = number[(static_cast<std::size_t>(z) * m + y) * m + x];
    if (v < 0) {
      v = static_cast<Index>(positions.size());
      positions.emplace_back(x, y, z);
    }
    return v;
  };
  constexpr std::array<std::array<int, 3>, 6> kHexagon{
      {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {2, 1, 0}, {2, 0, 1}, {1, 0, 2}}};
  constexpr std::array<std::array<int, 2>, 4> kSquare{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  CellCollector cells;
  const auto add_cell = [&](Index x, Index y, Index z) {
    std::vector<Index> face;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-2, 2}) {
        face.clear();
        for (const auto& [a, b] : kSquare) {
          std::array<int, 3> d{};
          d[static_cast<std::size_t>(axis)] = side;
          d[static_cast<std::size_t>((axis + 1) % 3)] = a;
          d[static_cast<std::size_t>((axis + 2) % 3)] = b;
          face.push_back(vertex(x + d[0], y + d[1], z + d[2]));
        }
        cells.add_face(face);
      }
    for (int octant = 0; octant < 8; ++octant) {
      const int sx = octant & 1 ? 1 : -1, sy = octant & 2 ? 1 : -1, sz = octant & 4 ? 1 : -1;
      face.clear();
      for (const auto& [a, b, c] : kHexagon)
        face.push_back(vertex(x + sx * a, y + sy * b, z + sz * c));
      cells.add_face(face);
    }
    cells.end_cell();
  };
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        add_cell(4 * i + 2, 4 * j + 2, 4 * k + 2);
        add_cell(4 * i + 4, 4 * j + 4, 4 * k + 4);
      }
  Points points(static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t v = 0; v < positions.size(); ++v)
    points.row(static_cast<Eigen::Index>(v)) = positions[v].transpose();
  jitter(points, 0.1);
  return std::move(cells).build(std::move(points));
}

}  // namespace

PolyhedralMesh volume_grid(const std::string& kind, Index n_vertices) {
  if (kind == "truncated")
    return truncated_octahedra(static_cast<Index>(std::cbrt(n_vertices / 12.0)));
  return cubes(static_cast<Index>(std::lround(std::cbrt(n_vertices))) - 1, kind == "tets");
}

}  // namespace carat::bench
