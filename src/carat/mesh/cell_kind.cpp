#include "carat/mesh/cell_kind.h"

#include <algorithm>

namespace carat {
namespace {

/// A face of three or four vertices in the direction that points out of the cell.
struct OutwardFace {
  std::array<Index, 4> vertices{};
  int size = 0;
  Index operator[](int k) const { return vertices[static_cast<std::size_t>(k % size)]; }
  bool has(Index v) const {
    return std::find(vertices.begin(), vertices.begin() + size, v) != vertices.begin() + size;
  }
};

struct OutwardFaces {
  std::array<OutwardFace, 6> faces{};
  std::size_t size = 0;
  int n_triangles = 0;
};

/// False if the cell has too many faces, or one with too many vertices, for a standard cell.
bool collect(const PolyhedralMesh& mesh, Index c, OutwardFaces& result) {
  const std::span<const Index> cell = mesh.cell(c);
  if (cell.size() > result.faces.size()) return false;
  for (const Index f : cell) {
    const std::span<const Index> face = mesh.face(f);
    OutwardFace& outward = result.faces[result.size++];
    if (face.size() > outward.vertices.size()) return false;
    outward.size = static_cast<int>(face.size());
    std::copy(face.begin(), face.end(), outward.vertices.begin());
    if (mesh.face_cells()[static_cast<std::size_t>(f)].below != c)
      std::reverse(outward.vertices.begin(), outward.vertices.begin() + outward.size);
    if (face.size() == 3) ++result.n_triangles;
  }
  return true;
}

CellKind candidate(const OutwardFaces& faces) {
  const int n = static_cast<int>(faces.size);
  if (n == 4 && faces.n_triangles == 4) return CellKind::Tetrahedron;
  if (n == 6 && faces.n_triangles == 0) return CellKind::Hexahedron;
  if (n == 5 && faces.n_triangles == 2) return CellKind::Wedge;
  if (n == 5 && faces.n_triangles == 4) return CellKind::Pyramid;
  return CellKind::Polyhedron;
}

/// The vertex outside the base at the other end of the cell's edge at v, -1 if there is none.
Index across(const OutwardFaces& faces, const OutwardFace& base, Index v) {
  for (std::size_t k = 0; k < faces.size; ++k) {
    const OutwardFace& face = faces.faces[k];
    for (int i = 0; i < face.size; ++i)
      if (face[i] == v && !base.has(face[i + 1])) return face[i + 1];
  }
  return -1;
}

struct Sides {
  std::size_t size;
  std::array<std::array<signed char, 4>, 6> faces;
};

/// Faces by VTK's numbering of vertices, pointing outwards; -1: a triangle.
const Sides& sides_of(CellKind kind) {
  static constexpr Sides tetrahedron{
      4, {{{0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}, {0, 2, 1, -1}}}};
  static constexpr Sides hexahedron{
      6, {{{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}}};
  static constexpr Sides wedge{
      5, {{{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}}};
  static constexpr Sides pyramid{
      5, {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}}};
  switch (kind) {
    case CellKind::Tetrahedron:
      return tetrahedron;
    case CellKind::Hexahedron:
      return hexahedron;
    case CellKind::Wedge:
      return wedge;
    default:
      return pyramid;
  }
}

bool same_cycle(const OutwardFace& a, const OutwardFace& b) {
  if (a.size != b.size) return false;
  for (int start = 0; start < a.size; ++start) {
    int k = 0;
    while (k < a.size && a[start + k] == b[k]) ++k;
    if (k == a.size) return true;
  }
  return false;
}

/// Whether the cell has exactly the faces which its kind has on these vertices.
bool matches(const OutwardFaces& faces, const StandardCell& cell) {
  const Sides& sides = sides_of(cell.kind);
  for (std::size_t s = 0; s < sides.size; ++s) {
    OutwardFace expected;
    for (const signed char k : sides.faces[s])
      if (k >= 0)
        expected.vertices[static_cast<std::size_t>(expected.size++)] =
            cell.vertex_array[static_cast<std::size_t>(k)];
    const auto end = faces.faces.begin() + static_cast<std::ptrdiff_t>(faces.size);
    if (std::none_of(faces.faces.begin(), end,
                     [&](const OutwardFace& face) { return same_cycle(face, expected); }))
      return false;
  }
  return true;
}

bool distinct(std::span<const Index> vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (vertices[i] == vertices[j]) return false;
  return true;
}

}  // namespace

const char* cell_kind_name(CellKind kind) {
  switch (kind) {
    case CellKind::Tetrahedron:
      return "tetrahedra";
    case CellKind::Hexahedron:
      return "hexahedra";
    case CellKind::Wedge:
      return "wedges";
    case CellKind::Pyramid:
      return "pyramids";
    default:
      return "polyhedra";
  }
}

std::size_t StandardCell::n_vertices() const {
  switch (kind) {
    case CellKind::Tetrahedron:
      return 4;
    case CellKind::Hexahedron:
      return 8;
    case CellKind::Wedge:
      return 6;
    case CellKind::Pyramid:
      return 5;
    default:
      return 0;
  }
}

StandardCell standard_cell(const PolyhedralMesh& mesh, Index cell) {
  OutwardFaces faces;
  StandardCell result;
  if (!collect(mesh, cell, faces)) return {};
  result.kind = candidate(faces);
  if (result.kind == CellKind::Polyhedron) return {};
  // The base: the quadrilateral of a pyramid, a triangle of a wedge, else any face.
  const int base_size =
      result.kind == CellKind::Tetrahedron || result.kind == CellKind::Wedge ? 3 : 4;
  std::size_t b = 0;
  while (faces.faces[b].size != base_size) ++b;
  const OutwardFace& base = faces.faces[b];
  const bool has_top = result.kind == CellKind::Hexahedron || result.kind == CellKind::Wedge;
  for (int k = 0; k < base_size; ++k) {
    // VTK's wedge has its base outwards, the others inwards.
    const Index v = result.kind == CellKind::Wedge ? base[k] : base[base_size - k];
    result.vertex_array[static_cast<std::size_t>(k)] = v;
    if (has_top)
      result.vertex_array[static_cast<std::size_t>(base_size + k)] = across(faces, base, v);
  }
  if (!has_top)
    result.vertex_array[static_cast<std::size_t>(base_size)] = across(faces, base, base[0]);
  if (!distinct(result.vertices()) || !matches(faces, result)) return {};
  return result;
}

}  // namespace carat
