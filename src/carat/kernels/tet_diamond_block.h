#pragma once
// The minimal diamonds at the faces of several tetrahedra at a time.
//
// The three minimal diamonds of a face have one gradient. With ua, ub, uc at the face's vertices
// and w = (u_own - u_across) / 4 their energy is that of three couplings in the face, plus
// 2 w alpha . (ua, ub, uc) + gamma w^2.   [BBA21 (28)]

#include "carat/base/types.h"
#include "carat/kernels/tetrahedron_block.h"

namespace carat {

/// Couplings of one tetrahedron, whose vertices are numbered 0 to 3; face k is opposite to vertex
/// k. Sixteen numbers: two lines of the cache.
struct TetDiamonds {
  double pair[6];       ///< -S between vertices 01, 02, 03, 12, 13, 23, this cell's part  [length]
  double across[4];     ///< -S between vertex k and the one across face k
  double face_mass[4];  ///< M between two vertices of face k, this cell's part  [length^3]
  double cell_mass;     ///< M between two vertices, of the cell's virtual vertex
  double unused;
};

/// What the halves of diamonds differ in, as in diamond_split.h.
struct TetHalves {
  double jump;  ///< part of the jump's energy that counts: 1 - theta
  bool moment_exact;
  double tau;  ///< of the moment-exact mass
};

/// One tetrahedron of a block.
struct TetDiamondInput {
  const Index* vertices;  ///< four ascending, then those across their faces, -1 at the boundary
  double sign;            ///< + if vertex 3 sees 0, 1, 2 counter-clockwise
  unsigned left_out = 0;  ///< bit k: the diamonds of face k add nothing
};

/// \param points   as in Points::data()  [length]
/// \param eps_rel  |D| <= eps_rel * size^3 counts as degenerate: the face adds nothing
/// \param volumes  of one minimal diamond of each face, 0 if they are degenerate  [length^3]
/// \return whether all tetrahedra have a volume well above rounding noise, with any sign
/// A face gets the same bits from both of its cells, wherever in a block they stand.
bool tet_diamond_block(const double* points, const TetDiamondInput* input, double eps_rel,
                       TetDiamonds* const* tets, double (*volumes)[4]);

/// The same with the jumps between the halves of diamonds and masses that tell them apart. The axis
/// from tip to tip meets the face in one point, so the jumps of its three diamonds are one as well.
/// \param vertex_masses  four of each tetrahedron, of its vertices, by their faces in this cell: 6 times the masses of
///                       the faces around them where the mass is not moment-exact
bool tet_diamond_block(const double* points, const TetDiamondInput* input, double eps_rel,
                       const TetHalves& halves, TetDiamonds* const* tets,
                       double* const* vertex_masses, double (*volumes)[4]);

}  // namespace carat
