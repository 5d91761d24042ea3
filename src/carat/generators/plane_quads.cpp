#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"

namespace carat {

/// n = 6 * 2^level squares a side.
PolygonMesh generate_plane_quads(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 6, 4);
  return jitter_vertices(square_quads(n, options.anisotropy), kSquare, options);
}

}  // namespace carat
