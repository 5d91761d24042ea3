#pragma once
// Reader for the volume meshes of the reference data: plain OVM, independent of the library's own.

#include "carat/mesh/polyhedral_mesh.h"
#include "support/reference_files.h"

namespace carat::test {

/// Half-edge 2e + 1 is edge e reversed, half-face 2f + 1 is face f reversed.
inline PolyhedralMesh read_plain_ovm(const std::string& path) {
  std::ifstream in = open_reference(path);
  std::string word;
  Index n = 0;
  const auto section = [&](const char* name) {
    if (!(in >> word >> n) || word != name) throw std::runtime_error(path + ": no section " + name);
  };
  std::getline(in, word);
  section("Vertices");
  Points points(n, 3);
  for (Index i = 0; i < 3 * n; ++i) in >> points.data()[i];
  section("Edges");
  std::vector<std::array<Index, 2>> edges(static_cast<std::size_t>(n));
  for (auto& edge : edges) in >> edge[0] >> edge[1];
  const auto read_rows = [&](auto&& item) {
    Csr rows;
    for (Index i = 0; i < n; ++i) {
      Index size = 0, half = 0;
      for (in >> size; size > 0 && in >> half; --size) rows.indices.push_back(item(half));
      rows.offsets.push_back(static_cast<Index>(rows.indices.size()));
    }
    return rows;
  };
  section("Faces");
  Csr faces = read_rows([&](Index half) {
    return edges[static_cast<std::size_t>(half / 2)][static_cast<std::size_t>(half % 2)];
  });
  section("Polyhedra");
  Csr cells = read_rows([](Index half) { return half / 2; });
  if (!in) throw std::runtime_error("short reference file " + path);
  return PolyhedralMesh(std::move(points), std::move(faces), std::move(cells));
}

}  // namespace carat::test
