#pragma once
// The symbolic phase: sparsity patterns from connectivity alone, by counting.

#include <cstdint>

#include "carat/base/types.h"

namespace carat {

/// Connectivity of a surface as the assembly sees it: faces of corners, edges of corners.
struct SurfaceIncidence {
  const Csr& faces;                  ///< face -> vertices
  const Array<Index>& corner_faces;  ///< corner -> face
  const Array<Index>& corner_edges;  ///< corner -> edge
  const Csr& edge_corners;           ///< edge -> corners
  const Csr& vertex_corners;         ///< vertex -> corners
};

/// The vertices that each face reaches across its sides: those of the faces there without the
/// side's two ends, side by side and by corner. A vertex can occur more than once.
struct FaceRings {
  Array<std::int64_t> offsets;
  Array<Index> vertices;

  std::int64_t begin(Index face) const { return offsets[static_cast<std::size_t>(face)]; }
  std::int64_t end(Index face) const { return offsets[static_cast<std::size_t>(face) + 1]; }
};

/// Calls visit(v) for the vertices of the face of `corner` that follow the side's two ends, in
/// their order around the face.
template <class Visit>
void for_vertices_across(const SurfaceIncidence& mesh, Index corner, const Visit& visit) {
  const Index f = mesh.corner_faces[corner];
  const Index begin = mesh.faces.begin(f), size = mesh.faces.size(f);
  Index c = corner - begin + 2;
  for (Index k = 2; k < size; ++k, ++c) visit(begin + (c >= size ? c - size : c));
}

FaceRings face_rings(const SurfaceIncidence& mesh, int threads);

/// Square matrix of unset values: row i holds the vertices of all faces of i.
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix face_pattern(const SurfaceIncidence& mesh, int threads);

/// Patterns of the diamond Laplacian, square matrices of unset values.
struct DiamondPatterns {
  /// Row i holds the vertices of all faces of i and of all faces across an edge from them.
  /// [BBA21 section 7, Locality]
  SparseMatrix stiffness;
  /// Row i holds the vertices of all faces of i.
  SparseMatrix mass;
};

/// \throws InvalidMesh  2^31 entries or more
DiamondPatterns diamond_patterns(const SurfaceIncidence& mesh, const FaceRings& rings, int threads);

/// Square diagonal matrix of unset values.
SparseMatrix diagonal_pattern(Index n);

/// Allocates a matrix of unset values from its row sizes; offsets are set, columns are not.
/// \param what  names the matrix in the error message
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix allocate_rows(Index n_rows, Index n_cols, const Array<Index>& row_sizes,
                           const char* what);

}  // namespace carat
