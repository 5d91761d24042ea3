#pragma once
// Stiffness of the diamond Laplacian from per-diamond scalars and per-face weights.
//
// With p_f the affine weights of face f as a row vector over the vertices and w = p_l - p_r, a
// diamond over the edge (1, 2) has the energy alpha d^2 - 2 beta d (w u) + gamma (w u)^2 with
// d = u_2 - u_1. Row i of its matrix is a multiple of d and a multiple of w, so a row needs only
// the faces of i and, for each, the faces across its edges.

#include "carat/assembly/pattern.h"
#include "carat/base/types.h"

namespace carat {

/// One diamond: its hinge (v1 < v2), the corners of the faces to its left and right (-1: none, the
/// midpoint of the hinge stands in), and its energy, see Diamond2d.
struct DiamondTerm {
  double alpha, beta, gamma;
  Index v1, v2;
  Index left, right;
};

/// Fills `stiffness`, whose pattern is diamond_pattern(mesh), with the sum over all diamonds.
/// \param terms           the diamonds
/// \param edge_diamonds   edge -> first diamond, n_edges + 1 numbers; empty: one diamond an edge
/// \param weights         corner -> affine weight
void assemble_diamonds(SparseMatrix& stiffness, const SurfaceIncidence& mesh,
                       const Array<DiamondTerm>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads);

}  // namespace carat
