#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"
#include "carat/generators/zigzag.h"

namespace carat {

/// n = 4 * 2^level cells a side, each with two sides bent inwards and two outwards; straight at
/// the border.
PolygonMesh generate_plane_concave(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 4, 8);
  const ZigzagQuads cells = zigzag_quads(square_quads(n, options.anisotropy), checkerboard(1, n));
  return jitter_vertices(cells.mesh, kSquare, options, &cells.centres);
}

}  // namespace carat
