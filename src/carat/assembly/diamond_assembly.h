#pragma once
// Stiffness and mass of the diamond Laplacian from per-diamond scalars and per-face weights.
//
// With p_f the affine weights of face f as a row vector over the vertices and w = p_l - p_r, a
// diamond over the edge (1, 2) has the energy alpha d^2 - 2 beta d (w u) + gamma (w u)^2 with
// d = u_2 - u_1. So row i of the stiffness is
//   sum over edges at i of  d_i (alpha d - beta w)  +  sum over faces f at i of  p_f,i r_f,
//   r_f = sum over sides of f of  +-(gamma w - beta d),  + where f is the left face.
// The r_f are computed once a face, over the vertices of its ring; then every row adds the few
// that belong to it.

#include <vector>

#include "carat/assembly/pattern.h"
#include "carat/base/types.h"

namespace carat {

/// One diamond: its energy (see Diamond2d), what it adds to the mass of each of its vertices, its
/// hinge (v1 < v2), and the corners of the faces to its left and right (-1: none, the midpoint of
/// the hinge stands in).
struct DiamondTerm {
  double alpha, beta, gamma;
  double mass_share;  ///< [length^2]
  Index v1, v2;
  Index left, right;
};

/// Intermediate values of assemble_diamonds, kept between calls for their memory.
struct DiamondWorkspace {
  Array<double> ring_values;  ///< r_f over the ring of every face
  Array<double> face_mass;    ///< of the virtual vertices  [length^2]
  struct Thread {
    Array<Index> stiffness_position, mass_position;  ///< column -> its entry in the open row
  };
  std::vector<Thread> threads;
};

/// Fills `stiffness`, whose pattern is diamond_pattern(mesh, rings), with the sum over all diamonds, and
/// `mass` = P^T M^ P, whose pattern is face_pattern(mesh), or diagonal: then with the row sums.
/// \param terms           the diamonds
/// \param edge_diamonds   edge -> first diamond, n_edges + 1 numbers; empty: one diamond an edge
/// \param weights         corner -> affine weight
void assemble_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                       const SurfaceIncidence& mesh, const FaceRings& rings,
                       const Array<DiamondTerm>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads, DiamondWorkspace& workspace);

}  // namespace carat
