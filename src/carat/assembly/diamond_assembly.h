#pragma once
// Stiffness and mass of the diamond Laplacian from per-diamond scalars and per-face weights.
//
// With p_f the affine weights of face f as a row vector over the vertices, w = p_l - p_r and
// d = u_2 - u_1, a diamond has the energy alpha d^2 - 2 beta d (w u) + gamma (w u)^2. Summed over
// the sides of a face, sigma = + where it is to the left, the row of its vertex i is
//   b_i p_f + p_f,i (b + Gamma p_f - sum over sides of gamma p_across) + the alpha of its sides,
//   b = -sum over sides of sigma beta d,  Gamma = sum of gamma.
// These are computed once a face; then every row adds the few faces that belong to it. An energy of
// general couplings differs only in what a side brings to b and Gamma.

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

/// A diamond with any energy on its four vertices, the sum of couplings k_ij (u_i - u_j)^2, and a
/// mass for each of them. Where a corner is missing, what belongs to the midpoint of the hinge has
/// been folded into the hinge's ends.
struct GeneralDiamondTerm {
  double k12, k1l, k2l, k1r, k2r, klr;
  double mass1, mass2, mass_left, mass_right;  ///< [length^2]
  Index v1, v2;
  Index left, right;
};

/// Intermediate values of assemble_diamonds, kept between calls for their memory.
struct DiamondWorkspace {
  /// What a corner's face adds to the row of the corner's vertex.
  struct Corner {
    double beta;      ///< b at the vertex
    double ring;      ///< b - sum of gamma p_across, at the vertex
    double side;      ///< coupling of the two ends of the side that starts here
    double diagonal;  ///< of the stiffness
    double mass;      ///< of the vertex itself  [length^2]
  };
  struct Face {
    double gamma;  ///< Gamma
    double mass;   ///< of the virtual vertex  [length^2]
  };
  struct Thread {
    Array<Index> stiffness_position, mass_position;  ///< column -> its entry in the open row
  };
  Array<Corner> corners;
  Array<Face> faces;
  Array<double> across;  ///< -gamma p_across, over the vertices of the rings
  std::vector<Thread> threads;
};

/// Fills `stiffness`, whose pattern is that of diamond_patterns(mesh, rings), with the sum over all
/// diamonds, and `mass` = P^T M^ P, whose pattern is face_pattern(mesh), or diagonal: then with the
/// row sums.
/// \param terms           the diamonds: DiamondTerm or GeneralDiamondTerm
/// \param edge_diamonds   edge -> first diamond, n_edges + 1 numbers; empty: one diamond an edge
/// \param weights         corner -> affine weight
template <class Term>
void assemble_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                       const SurfaceIncidence& mesh, const FaceRings& rings,
                       const Array<Term>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads, DiamondWorkspace& workspace);

}  // namespace carat
