// make_page FOLDER: the pages that check_page.mjs and check_volumes.mjs look at, and what they
// should read on them.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "carat/report/html_view.h"

namespace {

using carat::BoundaryPatch;
using carat::CellCollector;
using carat::CellType;
using carat::Field;
using carat::Index;
using carat::Points;
using carat::PolygonMesh;
using carat::PolyhedralMesh;
using carat::SurfaceData;
using carat::Vec2;
using carat::Vec3;
using carat::VolumeData;

/// Far from the origin, so that single precision alone would lose the picked position.
const Vec3 kShift(1e6, -2e6, 5e5);

/// n x n quads over [-1, 1]^2. The middle is a vertex where n is even.
PolygonMesh quad_grid(Index n) {
  Points points((n + 1) * (n + 1), 3);
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      const Vec3 at(x, y, 0.12 * std::sin(4 * x) * std::cos(3 * y));
      points.row(j * (n + 1) + i) = (at + kShift).transpose();
    }
  std::vector<std::vector<Index>> faces;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index v = j * (n + 1) + i;
      faces.push_back({v, v + 1, v + n + 2, v + n + 1});
    }
  return PolygonMesh::from_faces(points, faces);
}

/// Creases and large polygons: an n-gon at each end and quads around.
PolygonMesh drum(Index n) {
  Points points(2 * n, 3);
  std::vector<std::vector<Index>> faces(2);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.row(i) << std::cos(angle), -0.6, std::sin(angle);
    points.row(n + i) << std::cos(angle), 0.6, std::sin(angle);
    faces[0].push_back(i);
    faces[1].push_back(2 * n - 1 - i);
    faces.push_back({n + i, n + (i + 1) % n, (i + 1) % n, i});
  }
  return PolygonMesh::from_faces(points, faces);
}

SurfaceData wavy_grid(Index n) {
  SurfaceData data{quad_grid(n), {}};
  const Index n_vertices = data.mesh.n_vertices();
  Field distance{"distance", 1, {}}, curvature{"curvature < \"0\" & >", 1, {}};
  Field gradient{"gradient", 3, {}}, nearly{"nearly constant", 1, {}};
  for (Index v = 0; v < n_vertices; ++v) {
    const Vec3 p = data.mesh.point(v) - kShift;
    distance.values.push_back(std::hypot(p.x(), p.y() - 0.5));
    curvature.values.push_back(std::cos(4 * p.x()) * std::cos(3 * p.y()));
    nearly.values.push_back(1e9 + p.x());
    const Vec3 swirl(-p.y(), p.x(), 0);
    gradient.values.insert(gradient.values.end(), swirl.data(), swirl.data() + 3);
  }
  curvature.values[0] = std::numeric_limits<double>::quiet_NaN();
  curvature.values[static_cast<std::size_t>(n)] = std::numeric_limits<double>::infinity();
  Field checker{"checker", 1, {}};
  for (Index f = 0; f < data.mesh.n_faces(); ++f) checker.values.push_back((f / n + f % n) % 2);
  data.fields.vertex = {distance, curvature, gradient, nearly};
  data.fields.face = {checker};
  return data;
}

/// Corners of the cube cells of an n^3 lattice over [-1, 1]^3 about the shift.
Points lattice(Index n) {
  const Index m = n + 1;
  Points points(m * m * m, 3);
  for (Index k = 0; k <= n; ++k)
    for (Index j = 0; j <= n; ++j)
      for (Index i = 0; i <= n; ++i)
        points.row((k * m + j) * m + i) =
            (Vec3(2.0 * i / n - 1, 2.0 * j / n - 1, 2.0 * k / n - 1) + kShift).transpose();
  return points;
}

PolyhedralMesh cubes(Index n) {
  const Index m = n + 1;
  CellCollector cells;
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        const Index v = (k * m + j) * m + i, up = v + m * m;
        const std::array<Index, 8> corners = {v,  v + 1,  v + m + 1,  v + m,
                                              up, up + 1, up + m + 1, up + m};
        cells.add(CellType::Hexahedron, corners);
      }
  return std::move(cells).build(lattice(n));
}

/// Prisms over polygons, one cell each: a hexagon, an L, a U, and a square between the arms of the
/// U, so that sections are convex, concave, and in two parts.
PolyhedralMesh prisms() {
  std::vector<std::vector<Vec2>> bases(4);
  for (int i = 0; i < 6; ++i)
    bases[0].emplace_back(std::cos(i * std::numbers::pi / 3), std::sin(i * std::numbers::pi / 3));
  bases[1] = {{2, 0}, {4, 0}, {4, 1}, {3, 1}, {3, 2}, {2, 2}};
  bases[2] = {{5, 0}, {8, 0}, {8, 3}, {7, 3}, {7, 1}, {6, 1}, {6, 3}, {5, 3}};
  bases[3] = {{6, 3}, {6, 2}, {7, 2}, {7, 3}};
  std::vector<Vec3> points;
  CellCollector cells;
  for (const auto& base : bases) {
    const Index n = static_cast<Index>(base.size());
    const Index first = static_cast<Index>(points.size());
    std::vector<Index> bottom, top;
    for (const Vec2& p : base) points.emplace_back(p.x(), p.y(), -1);
    for (const Vec2& p : base) points.emplace_back(p.x(), p.y(), 1);
    for (Index i = 0; i < n; ++i) {
      bottom.push_back(first + n - 1 - i);
      top.push_back(first + n + i);
    }
    cells.add_face(bottom);
    cells.add_face(top);
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + 1) % n;
      cells.add_face(std::array<Index, 4>{first + i, first + j, first + n + j, first + n + i});
    }
    cells.end_cell();
  }
  Points rows(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    rows.row(static_cast<Eigen::Index>(v)) = points[v].transpose();
  return std::move(cells).build(rows);
}

/// On a lattice of cubes: a value that is linear in space, others at vertices, one in cells.
VolumeData linear_cubes(Index n) {
  VolumeData data{cubes(n), {}};
  Field linear{"linear", 1, {}}, wind{"wind", 3, {}};
  std::vector<Field> modes;
  for (int mode = 1; mode <= 3; ++mode) modes.push_back({"mode_" + std::to_string(mode), 1, {}});
  for (Index v = 0; v < data.mesh.n_vertices(); ++v) {
    const Vec3 p = data.mesh.point(v) - kShift;
    linear.values.push_back(1 + 2 * p.x() - 3 * p.y() + 5 * p.z());
    wind.values.insert(wind.values.end(), {p.y(), -p.x(), 0.2});
    for (int mode = 1; mode <= 3; ++mode)
      modes[static_cast<std::size_t>(mode - 1)].values.push_back(std::sin(mode * p.x()));
  }
  Field number{"number", 1, {}};
  for (Index c = 0; c < data.mesh.n_cells(); ++c) number.values.push_back(c);
  data.fields.vertex = {linear, wind};
  data.fields.vertex.insert(data.fields.vertex.end(), modes.begin(), modes.end());
  data.fields.cell = {number};
  BoundaryPatch floor{"floor", "wall", {}};
  for (Index f = 0; f < data.mesh.n_faces(); ++f) {
    double highest = -2;
    for (const Index v : data.mesh.face(f))
      highest = std::max(highest, data.mesh.point(v).z() - kShift.z());
    if (highest < -0.99) floor.faces.push_back(f);
  }
  data.patches = {floor};
  return data;
}

void write_volumes(const std::filesystem::path& folder) {
  const VolumeData volume = linear_cubes(4);
  carat::write_html_view(folder / "volumes.html",
                         {{"cubes", volume},
                          {"prisms", VolumeData{prisms(), {}}},
                          {"square", SurfaceData{quad_grid(4), {}}},
                          {"empty", VolumeData{}}},
                         "Volumes");
  std::ofstream(folder / "volumes.json")
      << nlohmann::json{{"shift", {kShift.x(), kShift.y(), kShift.z()}}};
}

void write_pages(const std::filesystem::path& folder) {
  const Index n = 32;
  const SurfaceData grid = wavy_grid(n);
  const Index middle = (n + 1) * (n + 1) / 2;
  const std::string title = "Test </script> <b>\"page\"</b> & 'more'";
  carat::write_html_view(folder / "page.html",
                         {{"grid </script><i>", grid}, {"drum", SurfaceData{drum(12), {}}}}, title);
  const Vec3 at = grid.mesh.point(middle);
  std::ofstream(folder / "expected.json") << nlohmann::json{
      {"title", title},
      {"vertex", middle},
      {"position", {at.x(), at.y(), at.z()}},
      {"distance", grid.fields.vertex[0].values[static_cast<std::size_t>(middle)]},
      {"nearly", grid.fields.vertex[3].values[static_cast<std::size_t>(middle)]}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_page FOLDER\n";
    return 2;
  }
  try {
    std::filesystem::create_directories(argv[1]);
    write_pages(argv[1]);
    write_volumes(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
