#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {

/// n = 4 * 2^level layers of cubes, each cut in two along a diagonal of its top that points from
/// the middle of the layer to a corner of it: (n + 1)^3 vertices.
PolyhedralMesh generate_volume_prisms(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 4, 36)};
  VolumeBuilder cells(place_points(domain, lattice.points(), options.anisotropy));
  lattice.for_cells([&](Index i, Index j, Index k) {
    const auto cube = lattice.hexahedron(i, j, k);
    const int turn = lattice.diagonal_rises(i, j) ? 0 : 1;
    const auto add = [&](int a, int b, int c) {
      cells.add(CellType::Wedge,
                {cube[a], cube[b], cube[c], cube[a + 4], cube[b + 4], cube[c + 4]});
    };
    add(turn, turn + 1, turn + 2);
    add(turn, turn + 2, (turn + 3) % 4);
  });
  return finish_volume(std::move(cells).build(), domain, options);
}

}  // namespace carat
