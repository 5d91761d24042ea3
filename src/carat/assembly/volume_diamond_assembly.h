#pragma once
// Stiffness and mass of the diamond Laplacian in volumes from a few numbers a face.
//
// All minimal diamonds of a face f between cells l (below) and r (above) share w = u_r - u_l. Their
// energies add up to E_f = u^T A u + 2 w a^T u + gamma w^2, where A and a live on the face's
// vertices and its virtual vertex, whose weights are w_f. With p_c the weights of cell c as a row
// vector over the vertices, the row of vertex i is
//   sum over its cells of p_c,i (b_c + Gamma_c p_c - sum over faces of gamma p_across) + b_c,i p_c
//   + the rows of A,    b_c = sum over faces of sigma a,  Gamma_c = sum of gamma,
// sigma = + where the cell is above. Jumps between the halves of diamonds make a and gamma of the
// two cells differ, so each has its own. The bracket is computed once a cell. At the boundary the
// virtual vertex of the face stands for the missing cell, and is folded into A and a.

#include <vector>

#include "carat/assembly/volume_pattern.h"
#include "carat/base/types.h"

namespace carat {

/// What the diamonds of a face add, and intermediate values, kept between calls for their memory.
struct VolumeDiamondWorkspace {
  /// A, one a corner of a face: the diagonal entries `diagonal`, -`side` between the corner's
  /// vertex and the next, and -`spoke` between the vertex and the virtual one.
  struct Corner {
    double side, spoke, diagonal;
    double mass;  ///< of the vertex itself  [length^3]
  };
  /// sigma a at a corner's vertex, of either cell. Apart, as rows do not read it.
  struct Tips {
    double below, above;
  };
  /// A and a at the virtual vertex, and what belongs to the face as a whole.
  struct Face {
    double spokes;
    double mass;  ///< of the virtual vertex  [length^3]
    double below, above;
    double gamma_below, gamma_above;  ///< gamma of either cell
    double gamma_across;              ///< gamma between them
    double mass_below, mass_above;    ///< of each cell's virtual vertex  [length^3]
  };
  Array<Corner> corners;
  Array<Tips> tips;  ///< of the corners
  Array<Face> faces;
  Array<double> cell_mass;
  Array<double> own;                 ///< cell corner -> b_c
  Array<double> coupling;            ///< the bracket, over the vertices and the ring of every cell
  std::vector<Array<Index>> places;  ///< one a thread: vertex -> its place in the row
};

/// Fills `stiffness` and `mass`, whose patterns are those of diamond_patterns(mesh, rings) (the
/// mass may be diagonal: then with the row sums), from corners, tips and faces of the
/// workspace.
/// \param vertex_corners  vertex -> corners of faces; \param corner_faces  corner -> face
/// \param face_weights  corner -> affine weight; \param cell_weights  cell corner -> affine weight
void assemble_volume_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                              const VolumeIncidence& mesh, const CellRings& rings,
                              const Csr& vertex_corners, const Array<Index>& corner_faces,
                              const Array<double>& face_weights, const Array<double>& cell_weights,
                              int threads, VolumeDiamondWorkspace& workspace);

}  // namespace carat
