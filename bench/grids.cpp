#include "grids.h"

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

Points surface(const std::vector<Vec2>& plane, double jitter) {
  Points points(static_cast<Eigen::Index>(plane.size()), 3);
  for (std::size_t v = 0; v < plane.size(); ++v) {
    const double x = plane[v].x() + jitter * noise(3 * v);
    const double y = plane[v].y() + jitter * noise(3 * v + 1);
    points.row(static_cast<Index>(v)) << x, y,
        std::sin(0.01 * x) * std::cos(0.013 * y) + 0.3 * jitter * noise(3 * v + 2);
  }
  return points;
}

}  // namespace

PolygonMesh grid(const std::string& kind, Index n_vertices) {
  std::vector<Vec2> plane;
  Csr faces;
  const auto add = [&](std::initializer_list<Index> face) {
    faces.indices.insert(faces.indices.end(), face);
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  };
  if (kind == "hexagons") {
    // A wall of bricks: every brick has six vertices.
    const Index rows = static_cast<Index>(std::sqrt(n_vertices / 2.0));
    const Index width = 2 * rows;
    for (Index j = 0; j <= rows; ++j)
      for (Index i = 0; i < width; ++i)
        plane.emplace_back(0.866 * i, 1.5 * j + ((i + j) % 2 == 0 ? -0.25 : 0.25));
    for (Index j = 0; j < rows; ++j)
      for (Index i = j % 2; i + 2 < width; i += 2) {
        const Index a = j * width + i, b = a + width;
        add({a, a + 1, a + 2, b + 2, b + 1, b});
      }
    return PolygonMesh(surface(plane, 0.1), std::move(faces));
  }
  const Index n = static_cast<Index>(std::sqrt(static_cast<double>(n_vertices))) - 1;
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i) plane.emplace_back(i, j);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      if (kind == "quads") {
        add({a, b, c, d});
      } else {
        add({a, b, c});
        add({a, c, d});
      }
    }
  return PolygonMesh(surface(plane, 0.15), std::move(faces));
}

}  // namespace carat::bench
