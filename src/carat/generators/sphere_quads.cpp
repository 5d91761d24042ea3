#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"
#include "carat/generators/sphere_grids.h"

namespace carat {

/// n = 3 * 2^level intervals on every edge of the cube: 6 n^2 + 2 vertices.
PolygonMesh generate_sphere_quads(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 3, 24);
  const PolygonMesh mesh = cubed_sphere_quads(n);
  return jitter_vertices(mesh.with_points(squeeze_sphere(mesh.points(), options.anisotropy)),
                         kSphere, options);
}

}  // namespace carat
