#pragma once
// Which cells of a volume mesh are the solids that other programs have names for.

#include <array>
#include <span>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

enum class CellKind { Tetrahedron, Hexahedron, Wedge, Pyramid, Polyhedron };

inline constexpr std::array<CellKind, 5> kCellKinds = {CellKind::Tetrahedron, CellKind::Hexahedron,
                                                       CellKind::Wedge, CellKind::Pyramid,
                                                       CellKind::Polyhedron};

/// Plural and lower case, for tables, e.g. "tetrahedra".
const char* cell_kind_name(CellKind kind);

/// A cell as programs hold it that know solids by their vertices.
struct StandardCell {
  CellKind kind = CellKind::Polyhedron;
  std::array<Index, 8> vertex_array{};
  /// In the order of VTK; none of a polyhedron.
  std::span<const Index> vertices() const { return {vertex_array.data(), n_vertices()}; }
  std::size_t n_vertices() const;
};

/// The kind is found from how the faces meet, not from positions: a cell of six quadrilaterals that
/// meet like those of a cube is a hexahedron however it is bent.
/// Cost: O(1) for cells of at most six faces that have three or four vertices, else O(faces).
/// No allocation. Thread-safe.
StandardCell standard_cell(const PolyhedralMesh& mesh, Index cell);

inline CellKind cell_kind(const PolyhedralMesh& mesh, Index cell) {
  return standard_cell(mesh, cell).kind;
}

}  // namespace carat
