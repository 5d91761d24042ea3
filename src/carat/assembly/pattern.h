#pragma once
// The symbolic phase: sparsity patterns from connectivity alone, by counting.

#include <functional>

#include "carat/base/types.h"

namespace carat {

/// Connectivity of a surface as the assembly sees it: faces of corners, edges of corners.
struct SurfaceIncidence {
  const Csr& faces;                   ///< face -> vertices
  const Array<Index>& corner_faces;   ///< corner -> face
  const Array<Index>& corner_edges;   ///< corner -> edge
  const Csr& edge_corners;            ///< edge -> corners
  const Csr& vertex_corners;          ///< vertex -> corners
};

/// Square matrix of unset values: row i holds the vertices of all faces of i.
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix face_pattern(const SurfaceIncidence& mesh, int threads);

/// Square matrix of unset values: row i holds the vertices of all faces of i and of all faces
/// across an edge from them, the reach of the diamond Laplacian.   [BBA21 section 7, Locality]
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix diamond_pattern(const SurfaceIncidence& mesh, int threads);

/// Square diagonal matrix of unset values.
SparseMatrix diagonal_pattern(Index n);

/// Allocates a matrix of unset values from its row sizes; offsets are set, columns are not.
/// \param what  names the matrix in the error message
/// \throws InvalidMesh  2^31 entries or more
SparseMatrix allocate_rows(Index n_rows, Index n_cols, const Array<Index>& row_sizes,
                           const char* what);

}  // namespace carat
