#pragma once
// Meshes cut to pieces, as files would hold them, and what the whole mesh has.

#include <algorithm>
#include <map>
#include <numeric>

#include "carat/io/mesh_piece.h"
#include "parts.h"
#include "support/same_parts.h"
#include "support/sample_data.h"

namespace carat::test {

template <class Numbers>
std::vector<Field> select(const std::vector<Field>& fields, const Numbers& rows) {
  std::vector<Field> selected;
  for (const Field& field : fields) {
    Field part{field.name, field.components, {}};
    for (const auto row : rows)
      for (Index k = 0; k < field.components; ++k)
        part.values.push_back(field.values[std::size_t(row) * field.components + k]);
    selected.push_back(part);
  }
  return selected;
}

/// What the part has of the patches of the whole mesh.
inline std::vector<BoundaryPatch> select(std::vector<BoundaryPatch> patches,
                                         const PartNumbers& numbers) {
  for (BoundaryPatch& patch : patches) {
    std::vector<Index> here;
    for (Index f = 0; f < static_cast<Index>(numbers.interfaces.size()); ++f)
      if (std::binary_search(patch.faces.begin(), patch.faces.end(), numbers.interfaces[f]))
        here.push_back(f);
    patch.faces = here;
  }
  return patches;
}

/// A process's part of the whole mesh with what belongs to it.
template <class Mesh>
PartData<Mesh> expected_part(const Mesh& mesh, const std::vector<Index>& element_part) {
  PartData<Mesh> data;
  data.part = own_part(mesh, element_part);
  const PartNumbers& numbers = data.part.numbers;
  const MeshFields fields = sample_fields(mesh);
  data.fields.vertex = select(fields.vertex, numbers.vertices);
  data.fields.face = select(fields.face, numbers.elements);
  data.fields.cell = select(fields.cell, numbers.elements);
  data.patches = select(sample_patches(mesh), numbers);
  return data;
}

/// Ids that are neither dense nor start at 0.
inline std::vector<std::int64_t> ids_of(const std::vector<Index>& numbers) {
  std::vector<std::int64_t> ids;
  for (const Index number : numbers) ids.push_back((std::int64_t{number} - 2) * 100000000003);
  return ids;
}

/// Numbers of the piece by first use.
class Renumbering {
 public:
  Index operator()(Index whole) {
    const auto [at, added] = place_.emplace(whole, static_cast<Index>(list.size()));
    if (added) list.push_back(whole);
    return at->second;
  }
  std::vector<Index> list;

 private:
  std::map<Index, Index> place_;
};

inline Points select(const Points& points, const std::vector<Index>& rows) {
  Points selected(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) selected.row(Eigen::Index(k)) = points.row(rows[k]);
  return selected;
}

/// The elements of a process, from the last to the first; what has no elements is in the last one's
/// piece, and once more in the first one's.
inline MeshPiece<PolygonMesh> piece_of(const PolygonMesh& mesh,
                                       const std::vector<Index>& element_part) {
  Renumbering vertices;
  std::vector<Index> elements;
  Csr faces;
  for (Index f = mesh.n_faces() - 1; f >= 0; --f) {
    if (element_part[f] != rank()) continue;
    elements.push_back(f);
    for (const Index v : mesh.face(f)) faces.indices.push_back(vertices(v));
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_corners().size(v) == 0 && (rank() == 0 || rank() + 1 == n_processes()))
      vertices(v);
  MeshPiece<PolygonMesh> piece{PolygonMesh(select(mesh.points(), vertices.list), faces),
                               ids_of(vertices.list),
                               ids_of(elements),
                               {},
                               {},
                               {}};
  const MeshFields fields = sample_fields(mesh);
  piece.fields.vertex = select(fields.vertex, vertices.list);
  piece.fields.face = select(fields.face, elements);
  return piece;
}

inline MeshPiece<PolyhedralMesh> piece_of(const PolyhedralMesh& mesh,
                                          const std::vector<Index>& element_part) {
  Renumbering vertices, interfaces;
  std::vector<Index> elements;
  std::map<Index, Index> place;
  Csr cells, faces;
  for (Index c = mesh.n_cells() - 1; c >= 0; --c) {
    if (element_part[c] != rank()) continue;
    place[c] = static_cast<Index>(elements.size());
    elements.push_back(c);
    for (const Index f : mesh.cell(c)) cells.indices.push_back(interfaces(f));
    cells.offsets.push_back(static_cast<Index>(cells.indices.size()));
  }
  const bool brings_loose = rank() == 0 || rank() + 1 == n_processes();
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (const FaceCells sides = mesh.face_cells()[f];
        sides.below < 0 && sides.above < 0 && brings_loose)
      interfaces(f);
  Array<FaceCells> face_cells;
  const auto here = [&](Index cell) { return place.contains(cell) ? place[cell] : -1; };
  for (const Index f : interfaces.list) {
    for (const Index v : mesh.face(f)) faces.indices.push_back(vertices(v));
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
    face_cells.push_back({here(mesh.face_cells()[f].below), here(mesh.face_cells()[f].above)});
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_cell_corners().size(v) == 0 && brings_loose) vertices(v);
  MeshPiece<PolyhedralMesh> piece{
      PolyhedralMesh::from_face_cells(select(mesh.points(), vertices.list), faces, cells,
                                      face_cells),
      ids_of(vertices.list),
      ids_of(elements),
      ids_of(interfaces.list),
      {},
      {}};
  const MeshFields fields = sample_fields(mesh);
  piece.fields.vertex = select(fields.vertex, vertices.list);
  piece.fields.cell = select(fields.cell, elements);
  for (BoundaryPatch patch : sample_patches(mesh)) {
    std::vector<Index> faces_here;
    for (Index f = 0; f < static_cast<Index>(interfaces.list.size()); ++f)
      if (std::binary_search(patch.faces.begin(), patch.faces.end(), interfaces.list[f]))
        faces_here.push_back(f);
    patch.faces = faces_here;
    piece.patches.push_back(patch);
  }
  return piece;
}

/// The mesh with its faces in the order in which the cells name them.
inline PolyhedralMesh numbered_by_cells(const PolyhedralMesh& mesh) {
  Renumbering order;
  Csr cells, faces;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    for (const Index f : mesh.cell(c)) cells.indices.push_back(order(f));
    cells.offsets.push_back(static_cast<Index>(cells.indices.size()));
  }
  Array<FaceCells> face_cells;
  for (const Index f : order.list) {
    faces.indices.insert(faces.indices.end(), mesh.face(f).begin(), mesh.face(f).end());
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
    face_cells.push_back(mesh.face_cells()[f]);
  }
  return PolyhedralMesh::from_face_cells(mesh.points(), faces, cells, face_cells);
}

/// Calls visit(element_part) for divisions of either kind, and one of which all but the last
/// process are empty.
template <class Mesh, class Visit>
void for_cuts(const Mesh& mesh, const Visit& visit) {
  visit(in_blocks(n_elements(mesh), n_processes()));
  visit(scattered(n_elements(mesh), n_processes()));
  visit(std::vector<Index>(std::size_t(n_elements(mesh)), n_processes() - 1));
}

}  // namespace carat::test
