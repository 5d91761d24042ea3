#pragma once
// Which part each element of a mesh goes to, by Scotch.

#include <vector>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// Divides the graph of elements that share interfaces so that parts are about equally large and
/// few interfaces lie between them. The same mesh gives the same parts.
/// \return element (face of a surface, cell of a volume) -> part, as divide() takes it
/// \throws InvalidOption  n_parts < 1
/// \throws SolverFailure  Scotch fails
std::vector<Index> partition(const PolygonMesh& mesh, Index n_parts);
std::vector<Index> partition(const PolyhedralMesh& mesh, Index n_parts);

}  // namespace carat
