#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {

/// n = 4 * 2^level cubes along a side: (n + 1)^3 vertices.
PolyhedralMesh generate_volume_hexahedra(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 4, 24)};
  return finish_volume(
      hexahedra(lattice, place_points(domain, lattice.points(), options.anisotropy)), domain,
      options);
}

}  // namespace carat
