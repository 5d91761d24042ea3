#pragma once
// Volume meshes of a given size for measurements: mildly jittered, in natural order.

#include <string>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat::bench {

/// \param kind  "tets", "hexahedra" or "truncated" (octahedra)
/// \return about `n_vertices` vertices
PolyhedralMesh volume_grid(const std::string& kind, Index n_vertices);

}  // namespace carat::bench
