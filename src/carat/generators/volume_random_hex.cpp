#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {

/// The grid of volume_hexahedra, n = 4 * 2^level, with every vertex moved as far as half its
/// shortest edge at random; the option jitter moves them once more.
PolyhedralMesh generate_volume_random_hex(const VolumeDomain& domain,
                                          const FamilyOptions& options) {
  constexpr double kDisorder = 0.5;
  const CubeLattice lattice{volume_lattice_size(options.level, 4, 24)};
  FamilyOptions disorder = options;
  disorder.jitter = kDisorder;
  disorder.seed = options.seed ^ 0x2545f4914f6cdd1d;
  const PolyhedralMesh grid =
      hexahedra(lattice, place_points(domain, lattice.points(), options.anisotropy));
  return jitter_cells(finish_volume(grid, domain, disorder), domain, options.jitter, options.seed);
}

}  // namespace carat
