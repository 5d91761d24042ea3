#pragma once
// Meshes of a given size for measurements: gently curved, jittered, in natural order.

#include <string>

#include "carat/mesh/polygon_mesh.h"

namespace carat::bench {

/// \param kind  "triangles", "quads" or "hexagons"
/// \return about `n_vertices` vertices
PolygonMesh grid(const std::string& kind, Index n_vertices);

}  // namespace carat::bench
