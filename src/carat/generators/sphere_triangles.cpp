#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"
#include "carat/generators/sphere_grids.h"

namespace carat {

/// n = 2 * 2^level intervals on every edge of the icosahedron: 10 n^2 + 2 vertices.
PolygonMesh generate_sphere_triangles(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 2, 60);
  const PolygonMesh mesh = icosahedral_triangles(n);
  return jitter_vertices(mesh.with_points(squeeze_sphere(mesh.points(), options.anisotropy)),
                         kSphere, options);
}

}  // namespace carat
