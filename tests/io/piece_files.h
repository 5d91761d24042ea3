#pragma once
// Meshes written as VTK's pieces.

#include <cmath>
#include <numeric>

#include "carat/io/parallel_vtk.h"
#include "io_support.h"
#include "support/mesh_parts.h"

namespace carat::test {

struct PieceForm {
  bool ids = true, ghosts = true;
  const char* vertex_ids = "vertex_id";
  const char* element_ids = "cell_id";
};

inline const char* piece_extension(const PolygonMesh&) { return "vtp"; }
inline const char* piece_extension(const PolyhedralMesh&) { return "vtu"; }
inline void write_mesh(const std::filesystem::path& path, const PolygonMesh& mesh,
                       MeshFields fields) {
  fields.face = std::move(fields.cell);
  fields.cell.clear();
  write_surface(path, mesh, fields);
}
inline void write_mesh(const std::filesystem::path& path, const PolyhedralMesh& mesh,
                       const MeshFields& fields) {
  write_volume(path, mesh, fields);
}

/// What a file holds of that kind.
inline SurfaceData read_as(const std::filesystem::path& path, const PolygonMesh&) {
  return read_surface(path);
}
inline VolumeData read_as(const std::filesystem::path& path, const PolyhedralMesh&) {
  return read_volume(path);
}

/// Values that depend on the number in the whole mesh; elements' values are those of cells.
template <class Numbers>
MeshFields fields_by_numbers(const Numbers& vertices, const Numbers& elements) {
  MeshFields fields;
  Field heat{"heat", 1, {}}, flow{"flow", 3, {}}, tensor{"tensor", 2, {}};
  for (const auto v : vertices) {
    heat.values.push_back(std::sin(v + 1.0));
    for (int k = 0; k < 3; ++k) flow.values.push_back(std::cos(3.0 * v + k));
  }
  for (const auto e : elements)
    for (int k = 0; k < 2; ++k) tensor.values.push_back(std::sin(0.1 * e + k));
  fields.vertex = {heat, flow};
  fields.cell = {tensor};
  return fields;
}

inline std::vector<Index> numbers_to(Index n) {
  std::vector<Index> numbers(static_cast<std::size_t>(n));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

/// The whole mesh with its fields in one file.
template <class Mesh>
std::filesystem::path write_whole(const std::filesystem::path& folder, const Mesh& mesh) {
  const auto path = folder / ("whole." + std::string(piece_extension(mesh)));
  write_mesh(path, mesh,
             fields_by_numbers(numbers_to(mesh.n_vertices()), numbers_to(n_elements(mesh))));
  return path;
}

/// Pieces mesh_0.vtu, ... and their index mesh.pvtu, of surfaces .vtp and .pvtp.
template <class Mesh>
std::filesystem::path write_pieces(const std::filesystem::path& folder, const Mesh& mesh,
                                   const std::vector<Index>& element_part, Index n_parts,
                                   const PieceForm& form = {}) {
  const MeshDivision division = divide(mesh, n_parts, element_part);
  const std::string extension = piece_extension(mesh);
  std::vector<std::string> pieces;
  MeshFields fields;
  for (Index p = 0; p < n_parts; ++p) {
    const MeshPart<Mesh> part = part_of(mesh, division, p);
    const PartNumbers& numbers = part.numbers;
    const Mesh alone = own_mesh(part);
    Array<Index> elements;
    Field ghosts{kGhostField, 1, {}};
    for (std::size_t e = 0; e < numbers.elements.size(); ++e) {
      if (!form.ghosts && !numbers.own_elements[e]) continue;
      elements.push_back(numbers.elements[e]);
      ghosts.values.push_back(numbers.own_elements[e] ? 0 : 1);
    }
    fields = fields_by_numbers(numbers.vertices, elements);
    if (form.ghosts) fields.cell.push_back(ghosts);
    if (form.ids) {
      fields.vertex.insert(
          fields.vertex.begin(),
          {form.vertex_ids, 1, {numbers.vertices.begin(), numbers.vertices.end()}});
      fields.cell.insert(fields.cell.begin(),
                         {form.element_ids, 1, {elements.begin(), elements.end()}});
    }
    pieces.push_back("mesh_" + std::to_string(p) + "." + extension);
    write_mesh(folder / pieces.back(), form.ghosts ? part.mesh : alone, fields);
  }
  const auto shapes = [](const std::vector<Field>& list) {
    std::vector<FieldShape> result;
    for (const Field& field : list) result.push_back({field.name, field.components});
    return result;
  };
  const auto path = folder / ("mesh.p" + extension);
  write_parallel_index(path, pieces, shapes(fields.vertex), shapes(fields.cell), form.ghosts);
  return path;
}

}  // namespace carat::test
