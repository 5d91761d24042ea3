#pragma once
// Diamonds between triangles, several at a time.

#include "carat/base/types.h"

namespace carat {

/// Diamonds of a block, one lane each, so that loops over lanes become vector instructions of
/// whatever width there is. Enough of them that what is written first has left the store buffer
/// when it is read.
inline constexpr int kBlockDiamonds = 64;

/// In: the hinge's ends x1, x2 and the vertices opposite to it in the triangle to its left and the
/// one to its right. Out: as Diamond2d.
struct TriangleDiamondBlock {
  alignas(64) double x[4][3][kBlockDiamonds];  ///< by vertex (1, 2, l, r) and coordinate  [length]
  /// 1, or 0 at the boundary: the midpoint of the hinge stands for the triangle to the right.
  alignas(64) double inner[kBlockDiamonds];
  alignas(64) double alpha[kBlockDiamonds];
  alignas(64) double beta[kBlockDiamonds];
  alignas(64) double gamma[kBlockDiamonds];
  alignas(64) double area[kBlockDiamonds];  ///< [length^2]; 0 if the diamond is degenerate
  /// Not 0 where a triangle's area is so small that it has to be looked at closely.
  alignas(64) double thin[kBlockDiamonds];
};

/// Where the diagonals of the diamonds of a block cross, as DiamondCrossing<2>. Nothing is said of
/// degenerate diamonds and of those at the boundary.
struct TriangleCrossingBlock {
  alignas(64) double left_fraction[kBlockDiamonds];
  alignas(64) double right_fraction[kBlockDiamonds];
  alignas(64) double foot[kBlockDiamonds];  ///< from x1 in units of the hinge
  /// Of the jump between the halves; 0 where there is none.
  alignas(64) double stiffness[kBlockDiamonds];
};

/// The virtual vertices are the triangles' centroids: x_l - x_r = (o_l - o_r) / 3, and the halves
/// of a diamond have a third of the triangles' areas.   [BBA21 (7), (12), (21)]
///
/// A diamond's results do not depend on the others of its block, and are the same bits on every
/// processor.
/// \param eps_rel  as in diamond_2d
void triangle_diamond_block(TriangleDiamondBlock& block, double eps_rel);
/// The same, and where the diagonals cross.
void triangle_diamond_block(TriangleDiamondBlock& block, double eps_rel,
                            TriangleCrossingBlock& crossing);

}  // namespace carat
