#pragma once
// The symbolic phase in volumes: sparsity patterns from connectivity alone.

#include <cstdint>

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
  const Array<Index>& corner_faces;    ///< corner -> face
  const Csr& vertex_corners;           ///< vertex -> corners of faces

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

}  // namespace carat
