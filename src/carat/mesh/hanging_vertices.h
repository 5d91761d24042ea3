#pragma once
// Vertices where the cells of a volume mesh meet without sharing their faces.

#include <vector>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

struct HangingVertices {
  /// Inside an edge or a face of the boundary that does not name them, ascending.
  std::vector<Index> vertices;
  /// False if the search was given up: so many vertices lie in the boxes of so many faces that
  /// the search would no longer be linear.
  bool complete = true;
};

/// Looks for vertices of the boundary that lie inside a straight edge or a face of the boundary
/// without being a vertex of it: cells that touch there are not connected, as between blocks of
/// different fineness. Distances up to 1e-6 of the edge's length or the face's diameter count as
/// zero.
/// Cost: O(n log n) for n corners of the boundary.
HangingVertices hanging_vertices(const PolyhedralMesh& mesh);

}  // namespace carat
