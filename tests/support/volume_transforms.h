#pragma once
// The same volume mesh described differently: numbering, start vertices, orientation, position.

#include "carat/mesh/polyhedral_mesh.h"
#include "support/transforms.h"

namespace carat::test {

using Lists = std::vector<std::vector<Index>>;

inline Lists face_lists(const PolyhedralMesh& mesh) { return face_lists(mesh.face_mesh()); }

inline Lists cell_lists(const PolyhedralMesh& mesh) {
  Lists cells;
  for (Index c = 0; c < mesh.n_cells(); ++c)
    cells.emplace_back(mesh.cell(c).begin(), mesh.cell(c).end());
  return cells;
}

inline Csr to_csr(const Lists& lists) {
  Csr csr;
  for (const auto& list : lists) {
    csr.indices.insert(csr.indices.end(), list.begin(), list.end());
    csr.offsets.push_back(static_cast<Index>(csr.indices.size()));
  }
  return csr;
}

inline PolyhedralMesh make_volume(const Points& points, const Lists& faces, const Lists& cells) {
  return PolyhedralMesh(points, to_csr(faces), to_csr(cells));
}

/// Vertex v gets the number new_number[v].
inline PolyhedralMesh renumber(const PolyhedralMesh& mesh, const std::vector<Index>& new_number) {
  Points points(mesh.n_vertices(), 3);
  for (Index v = 0; v < mesh.n_vertices(); ++v) points.row(new_number[v]) = mesh.points().row(v);
  Lists faces = face_lists(mesh);
  for (auto& face : faces)
    for (Index& v : face) v = new_number[v];
  return make_volume(points, faces, cell_lists(mesh));
}

/// Other numbers of faces and cells.
inline PolyhedralMesh permute_faces_and_cells(const PolyhedralMesh& mesh, std::uint64_t seed) {
  const Lists faces = face_lists(mesh), cells = cell_lists(mesh);
  const std::vector<Index> face_order = permutation(mesh.n_faces(), seed);
  std::vector<Index> number(face_order.size());
  Lists new_faces, new_cells;
  for (const Index f : face_order) {
    number[f] = static_cast<Index>(new_faces.size());
    new_faces.push_back(faces[f]);
  }
  for (const Index c : permutation(mesh.n_cells(), seed + 1)) {
    new_cells.push_back(cells[c]);
    for (Index& f : new_cells.back()) f = number[f];
  }
  return make_volume(mesh.points(), new_faces, new_cells);
}

/// Every face starts with another of its vertices, every cell with another of its faces.
inline PolyhedralMesh rotate_faces_and_cells(const PolyhedralMesh& mesh) {
  Lists faces = face_lists(mesh), cells = cell_lists(mesh);
  for (Lists* lists : {&faces, &cells})
    for (std::size_t k = 0; k < lists->size(); ++k) {
      auto& list = (*lists)[k];
      std::rotate(list.begin(),
                  list.begin() + static_cast<std::ptrdiff_t>(1 + k % (list.size() - 1)),
                  list.end());
    }
  return make_volume(mesh.points(), faces, cells);
}

/// Turns every `step`-th face over, which makes its cell below the one above.
inline PolyhedralMesh flip_faces(const PolyhedralMesh& mesh, std::size_t step) {
  Lists faces = face_lists(mesh);
  for (std::size_t f = 0; f < faces.size(); f += step)
    std::reverse(faces[f].begin(), faces[f].end());
  return make_volume(mesh.points(), faces, cell_lists(mesh));
}

inline PolyhedralMesh move_rigidly(const PolyhedralMesh& mesh) {
  const Points points =
      (mesh.points() * some_rotation().transpose()).rowwise() + Eigen::RowVector3d(0.3, -0.8, 1.7);
  return mesh.with_points(points);
}

}  // namespace carat::test
