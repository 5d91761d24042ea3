// make_page FOLDER: the pages that check_page.mjs looks at, and what it should read on them.

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

using carat::Csr;
using carat::Field;
using carat::Index;
using carat::Points;
using carat::PolygonMesh;
using carat::SurfaceData;
using carat::Vec3;

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
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
