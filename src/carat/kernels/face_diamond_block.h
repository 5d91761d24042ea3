#pragma once
// The minimal diamonds at several faces of one valence at a time, without a coefficient.

#include "carat/base/types.h"

namespace carat {

/// Faces that a block holds, and the most corners that they may have.
inline constexpr int kBlockDiamondFaces = 8;
inline constexpr int kMostDiamondCorners = 8;

inline constexpr bool has_face_diamond_block(Index valence) {
  return valence >= 3 && valence <= kMostDiamondCorners;
}

/// One face of a block. Where a cell is missing, the face point stands for its tip.
struct FaceDiamondInput {
  const Index* vertices;
  const double *face_point, *below, *above;
  double share;  ///< the part of a diamond's volume that each vertex of its base gets is 1 / share
};

/// What the diamonds of each face add up to, one lane a face. Their energy is u^T A u + 2 w a^T u +
/// gamma w^2 with w = u_above - u_below; A and a live on the face's vertices and its face point.
struct FaceDiamonds {
  template <int N>
  using Corners = double[N][kBlockDiamondFaces];
  alignas(64) Corners<kMostDiamondCorners> side;  ///< -A between a corner's vertex and the next
  Corners<kMostDiamondCorners> spoke;             ///< -A between the vertex and the face point
  Corners<kMostDiamondCorners> diagonal;          ///< A at the vertex
  Corners<kMostDiamondCorners> tip;               ///< a at the vertex
  Corners<kMostDiamondCorners> mass;              ///< of the vertex  [length^3]
  Corners<kMostDiamondCorners> volume;            ///< of the diamond over the side  [length^3]
  double point_diagonal[kBlockDiamondFaces];      ///< A at the face point
  double point_tip[kBlockDiamondFaces];           ///< a at the face point
  double point_mass[kBlockDiamondFaces];          ///< of the face point  [length^3]
  double gamma[kBlockDiamondFaces];
  double tip_mass[kBlockDiamondFaces];  ///< a fourth of the volume  [length^3]
};

/// A face's results do not depend on the other faces of its block, and are the same bits on every
/// processor and as from diamond_3d: no fused operations, whatever the width of the registers.
/// \param points   as in Points::data()  [length]
/// \param faces    kBlockDiamondFaces of them, of `valence` corners
/// \param eps_rel  |D| <= eps_rel * size^3 counts as degenerate
/// \return bit f set: face f has a degenerate diamond, and its results are not valid
unsigned face_diamond_block(int valence, const double* points, const FaceDiamondInput* faces,
                            double eps_rel, FaceDiamonds& result);

}  // namespace carat
