#pragma once
// The diamond Laplacian on tetrahedra in closed form.
//
// With weights 1/4 the vertices that two tetrahedra share cancel in x_r - x_l = (o_r - o_l) / 4, o
// the vertices opposite to the face, and the three minimal diamonds of a face have one gradient. So
// a face couples five vertices: its own, and the two opposite. A tetrahedron keeps the couplings
// inside it, and one with the vertex across each face.

#include <array>

#include "carat/assembly/volume_pattern.h"
#include "carat/base/types.h"

namespace carat {

/// What is known of every tetrahedron from connectivity; k numbers its faces as in cells.
struct TetTopology {
  Array<std::array<Index, 4>> across;  ///< vertex across face k, -1 at the boundary
  /// Which of the tetrahedron's vertices the corners of face k are, and the one opposite.
  Array<std::array<std::array<unsigned char, 4>, 4>> places;
};

/// \param mesh  all cells have 4 faces and 4 vertices
TetTopology tet_topology(const VolumeIncidence& mesh, int threads);

/// Patterns as those of cell_rings, without its places.
VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const TetTopology& tets,
                                       int threads);

/// Couplings of one tetrahedron.
struct TetTerm {
  std::array<double, 6> pair;    ///< -S between vertices 01, 02, 03, 12, 13, 23, this cell's part
  std::array<double, 4> across;  ///< -S between the vertex opposite face k and the one across it
  std::array<double, 4> face_mass;  ///< M between two vertices of face k, this cell's part
  double cell_mass;                 ///< M between two vertices, of the cell's virtual vertex

  /// Adds what the diamonds of face k couple.
  /// \param place        of the face's vertices a, b, c and of the one opposite
  /// \param ab,ac,bc     couplings within the face
  /// \param alpha,gamma  energy 2 w alpha . (ua, ub, uc) + gamma w^2, w = u(this cell) - u(other)
  /// \param volume       of one of the three minimal diamonds
  void add_face(std::size_t k, const std::array<unsigned char, 4>& place, bool boundary, double ab,
                double ac, double bc, const std::array<double, 3>& alpha, double gamma,
                double volume);
};

/// Intermediate values, kept between calls for their memory.
struct TetDiamondWorkspace {
  Array<TetTerm> terms;
  struct Thread {
    Array<Index> stiffness_position, mass_position;
  };
  std::vector<Thread> threads;
};

/// Fills stiffness and mass (whose pattern may be diagonal: then with the row sums) from
/// workspace.terms.
void assemble_tet_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                           const VolumeIncidence& mesh, const TetTopology& tets, int threads,
                           TetDiamondWorkspace& workspace);

}  // namespace carat
