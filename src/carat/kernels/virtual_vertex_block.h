#pragma once
// The common case of VirtualVertexKernel for several faces of one valence at a time.

#include "carat/base/types.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {

/// Faces that a block holds.
inline constexpr int kBlockFaces = 8;

/// Valences that have a block kernel.
inline constexpr bool has_block_kernel(Index valence) { return valence >= 4 && valence <= 6; }

/// Weights and virtual triangles of kBlockFaces faces with in-plane weights, the point minimising
/// the area or, `centroid`, the mean of the vertices.
///
/// A face's results do not depend on the other faces of its block, and are the same bits on every
/// processor: no fused operations, whatever the width of its registers.
/// \param faces      the faces' first vertices in the face lists
/// \param weights    receives the weights of each face at its own pointer
/// \param triangles  likewise
/// \return bit f set: face f is degenerate or has a flipped triangle; its results are not valid
///         and VirtualVertexKernel has to be asked
unsigned virtual_vertex_block(int valence, const double* points, const Index* const* faces,
                              bool centroid, double* const* weights,
                              VirtualTriangle* const* triangles);

}  // namespace carat
