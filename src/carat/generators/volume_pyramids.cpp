#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {

/// n = 3 * 2^level cubes along a side, each of six pyramids with their tips at its centre.
PolyhedralMesh generate_volume_pyramids(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 3, 96)};
  VolumeBuilder cells(place_lattice_and_centres(domain, lattice, options.anisotropy));
  lattice.for_cells([&](Index i, Index j, Index k) {
    const auto cube = lattice.hexahedron(i, j, k);
    const Index tip = lattice.n_points() + lattice.cell(i, j, k);
    for (const auto& side : kHexahedronSides)
      cells.add(CellType::Pyramid,
                {cube[side[0]], cube[side[1]], cube[side[2]], cube[side[3]], tip});
  });
  return finish_volume(std::move(cells).build(), domain, options);
}

}  // namespace carat
