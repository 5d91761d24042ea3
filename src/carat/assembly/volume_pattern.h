#pragma once
// The symbolic phase in volumes: sparsity patterns from connectivity alone.

#include <cstdint>

#include "carat/assembly/pattern.h"
#include "carat/assembly/row_pattern.h"
#include "carat/base/types.h"

namespace carat {

/// Connectivity of a volume mesh as the assembly sees it. A *cell corner* is an entry of
/// cell_vertices, a *corner* one of faces.
struct VolumeIncidence {
  const Csr& faces;                    ///< face -> vertices
  const Csr& cells;                    ///< cell -> faces
  const Array<FaceCells>& face_cells;  ///< face -> the cells on its sides
  const Csr& cell_vertices;            ///< cell -> vertices, each once
  const Array<Index>& corner_cells;    ///< cell corner -> cell
  const Csr& vertex_cell_corners;      ///< vertex -> cell corners

  Index n_vertices() const { return vertex_cell_corners.n_rows(); }
};

/// The vertices that a cell couples: its own, in the order of cell_vertices, then those of the
/// cells across its faces, each once. A *place* is a position in that list.
struct CellRings {
  Array<std::int64_t> ring_offsets;  ///< cell -> its ring, the vertices behind its own
  Array<Index> ring;
  /// For every face of every cell, in order: the places of the face's vertices, then those of all
  /// vertices of the cell across, if there is one.
  Array<std::int64_t> place_offsets;  ///< cell -> its first
  Array<Index> places;

  Index ring_size(Index c) const {
    return static_cast<Index>(ring_offsets[static_cast<std::size_t>(c) + 1] -
                              ring_offsets[static_cast<std::size_t>(c)]);
  }
};

CellRings cell_rings(const VolumeIncidence& mesh, int threads);

/// Square matrix of unset values: row i holds the vertices of all cells of i.
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix cell_pattern(const VolumeIncidence& mesh, int threads);

/// Patterns of the diamond Laplacian, square matrices of unset values.
struct VolumeDiamondPatterns {
  /// Row i holds the vertices of all cells of i and of all cells across a face from them.
  SparseMatrix stiffness;
  /// Row i holds the vertices of all cells of i.
  SparseMatrix mass;
};

/// \throws InvalidMesh  2^31 entries or more
VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const CellRings& rings,
                                       int threads);

/// The same with the rings given by for_ring(c, visit), which calls visit(v) for vertices across
/// the faces of cell c; they may repeat.
template <class ForRing>
VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, int threads,
                                       const ForRing& for_ring) {
  Array<Index> sizes, mass_sizes;
  const Index n = mesh.n_vertices();
  const std::vector<CollectedRows> rows =
      collect_rows(n, threads, sizes, mass_sizes, [&](Index row, RowCollector& out) {
        const std::size_t before = out.columns.size();
        const std::span<const Index> corners = mesh.vertex_cell_corners.row(row);
        for (const Index corner : corners)
          for (const Index v : mesh.cell_vertices.row(mesh.corner_cells[corner])) out.add(v, row);
        const std::size_t own = out.columns.size() - before;
        for (const Index corner : corners)
          for_ring(mesh.corner_cells[corner], [&](Index v) { out.add(v, row); });
        return static_cast<Index>(own);
      });
  VolumeDiamondPatterns patterns{allocate_rows(n, n, sizes, "the diamond stiffness"),
                                 allocate_rows(n, n, mass_sizes, "the diamond mass")};
  write_transposed(rows, sizes, sizes, threads, patterns.stiffness);
  write_transposed(rows, sizes, mass_sizes, threads, patterns.mass);
  return patterns;
}

}  // namespace carat
