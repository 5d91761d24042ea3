#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"
#include "carat/generators/sphere_grids.h"
#include "carat/generators/zigzag.h"

namespace carat {

/// The cubed sphere with n = 2 * 2^level intervals on every edge of the cube and all sides bent.
PolygonMesh generate_sphere_concave(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 2, 48);
  const ZigzagQuads cells = zigzag_quads(cubed_sphere_quads(n), checkerboard(6, n));
  const auto onto_sphere = [&](Points points) {
    points.rowwise().normalize();
    return squeeze_sphere(points, options.anisotropy);
  };
  const Points centres = onto_sphere(cells.centres);
  return jitter_vertices(cells.mesh.with_points(onto_sphere(cells.mesh.points())), kSphere, options,
                         &centres);
}

}  // namespace carat
