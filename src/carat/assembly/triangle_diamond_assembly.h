#pragma once
// The diamond Laplacian on triangles in closed form.
//
// With weights 1/3 the vertices that two triangles share cancel in p_l - p_r = (o_l - o_r) / 3, o
// the vertices opposite to the edge. So the stiffness has two kinds of off-diagonal entries: one an
// edge, -alpha and the differences of the betas of the sides around it, and one an inner edge
// between o_l and o_r, -gamma / 9. Both are computed once and gathered by the rows, which sum to
// zero. The jump between the halves of a diamond couples the same four vertices, but the four sides
// by a value each, in place of one beta.

#include <array>
#include <cstdint>
#include <vector>

#include "carat/assembly/pattern.h"
#include "carat/base/types.h"

namespace carat {

/// Connectivity of triangles: three corners a face.
struct TriangleIncidence {
  Index n_vertices;
  const Csr& faces;                                  ///< face -> vertices
  const Array<std::array<Index, 2>>& edge_vertices;  ///< edge -> its ends, lower one first
  const Csr& edge_corners;                           ///< edge -> corners
  const Array<Index>& corner_edges;                  ///< corner -> edge
};

/// The other corners of a triangle.
struct TriangleCorners {
  Index next, previous;
};
inline TriangleCorners triangle_neighbours(Index corner) {
  const Index place = corner % 3;
  return {place == 2 ? corner - 2 : corner + 1, place == 0 ? corner + 2 : corner - 1};
}

/// What the closed form asks of triangles: at most two an edge, which are oriented alike, and fewer
/// than 2^30 edges.
bool has_triangle_diamonds(const TriangleIncidence& mesh, int threads);

/// Where the entries of the rows come from. Values are numbered: those of edges, those between
/// opposite vertices (one an edge), sums, and a zero for the diagonal.
struct TriangleDiamondSources {
  Array<std::uint32_t> stiffness;   ///< entry -> its value
  Csr vertex_edges;                 ///< vertex -> edges in the order of the mass's row; see below
  Array<Index> stiffness_diagonal;  ///< row -> its diagonal entry, -1: the row is empty
  Array<Index> mass_diagonal;       ///< likewise, in vertex_edges, where it holds n_edges
  /// Pairs of vertices that several diamonds couple, on meshes of few triangles: their values.
  std::vector<std::vector<std::uint32_t>> sums;
  Array<Index> boundary_edges;
};

struct TriangleDiamondPatterns {
  DiamondPatterns patterns;  ///< as those of diamond_patterns()
  TriangleDiamondSources sources;
};

/// \throws InvalidMesh  2^31 entries or more
TriangleDiamondPatterns triangle_diamond_patterns(const TriangleIncidence& mesh, int threads);

/// Values of the diamonds, by edge; kept between calls for their memory.
struct TriangleDiamondTerms {
  struct Around {
    double beta;   ///< beta / 3
    double share;  ///< mass share of each vertex / 9  [length^2]
  };
  Array<Around> around;
  /// In place of `around` where the halves of diamonds differ: in jumps, or in the moment-exact
  /// mass. By corner: of the diamond over its side, S between the vertex opposite to the side and
  /// the side's start and end, and the mass of the face's virtual vertex / 9.
  struct Half {
    double start, end;
    double tip;  ///< [length^2]
  };
  Array<Half> halves;
  Array<std::array<double, 2>> ends;  ///< by edge: masses of its ends, lower one first  [length^2]
  /// In: -alpha by edge, then -gamma / 9 by edge. Further places as in TriangleDiamondSources.
  Array<double> values;
  Array<double> mass;  ///< of the two ends of every edge  [length^2]

  /// \param halves  whether those of diamonds differ
  void resize(Index n_edges, Index n_corners, bool halves, const TriangleDiamondSources& sources);
};

/// Fills both matrices; the mass, if diagonal, with the row sums.
void assemble_triangle_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                                const TriangleIncidence& mesh,
                                const TriangleDiamondSources& sources, int threads,
                                TriangleDiamondTerms& terms);

}  // namespace carat
