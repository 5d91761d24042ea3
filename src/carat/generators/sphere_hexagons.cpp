#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"
#include "carat/generators/sphere_grids.h"
#include "carat/mesh/transform.h"

namespace carat {

/// The dual of sphere-triangles with n = 2 * 2^level: 10 n^2 + 2 faces. Jitter moves the vertices
/// of the hexagons; all of them stay on the sphere.
PolygonMesh generate_sphere_hexagons(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 2, 60);
  const PolygonMesh dual = dual_mesh(icosahedral_triangles(n));
  Points points = dual.points();
  points.rowwise().normalize();
  return jitter_vertices(dual.with_points(squeeze_sphere(points, options.anisotropy)), kSphere,
                         options);
}

}  // namespace carat
