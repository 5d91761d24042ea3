#pragma once
// The diamond Laplacian on tetrahedra in closed form.
//
// With weights 1/4 the vertices that two tetrahedra share cancel in x_r - x_l = (o_r - o_l) / 4, o
// the vertices opposite to the face, and the three minimal diamonds of a face have one gradient. So
// a face couples five vertices: its own, and the two opposite. A tetrahedron keeps the couplings
// inside it, and one with the vertex across each face. The axes of the three diamonds meet the face
// in one point, and so the jumps between their halves are one, of these five vertices as well.

#include <array>

#include "carat/assembly/volume_pattern.h"
#include "carat/base/types.h"
#include "carat/kernels/tet_diamond_block.h"

namespace carat {

/// What is known of every tetrahedron from connectivity. Vertex k is opposite to face k.
struct TetTopology {
  /// The vertices in ascending order, then those across their faces, -1 at the boundary.
  Array<std::array<Index, 8>> vertices;
  /// Faces in the order of the vertices. The lower cell of a face gives its measures, at the
  /// boundary the only one: elsewhere -1.
  Array<std::array<Index, 4>> measured_faces;
  Array<signed char> signs;       ///< + if vertex 3 sees 0, 1, 2 counter-clockwise
  Array<unsigned char> left_out;  ///< bit k: face k is another part's; empty: none is
};

/// \param mesh       all cells have 4 faces and 4 vertices
/// \param own_faces  the faces that are not left out; empty: all
TetTopology tet_topology(const VolumeIncidence& mesh, const std::vector<bool>& own_faces,
                         int threads);

/// Patterns as those of cell_rings, without its places.
VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const TetTopology& tets,
                                       int threads);

/// What the diamonds add; kept between calls for its memory.
struct TetDiamondTerms {
  Array<TetDiamonds> tets;
  /// Of their vertices, by their faces; empty where the halves of diamonds are alike: then 6 times
  /// the masses of the faces around a vertex.  [length^3]
  Array<std::array<double, 4>> vertex_masses;
};

/// Couplings of all tetrahedra, and the measures of the minimal diamonds by corner of the faces.
/// \param halves  if given: what the halves of diamonds differ in
/// \return whether all tetrahedra have a volume
bool compute_tet_diamonds(const Points& points, const VolumeIncidence& mesh,
                          const TetTopology& tets, double eps_rel, const TetHalves* halves,
                          int threads, TetDiamondTerms& terms, Vector& measures);

/// Fills stiffness and mass (whose pattern may be diagonal: then with the row sums).
void assemble_tet_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                           const VolumeIncidence& mesh, const TetTopology& tets,
                           const TetDiamondTerms& terms, int threads);

}  // namespace carat
