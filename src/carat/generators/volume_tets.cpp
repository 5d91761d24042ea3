#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {

/// The points of n = 3 * 2^level cubes along a side and their centres. Between the centres of two
/// cubes, four tetrahedra share the line across the common side; at the border, two stand on each
/// side of a cube.
PolyhedralMesh generate_volume_tets(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 3, 144)};
  const Index n = lattice.n;
  VolumeBuilder cells(place_lattice_and_centres(domain, lattice, options.anisotropy));
  lattice.for_cells([&](Index i, Index j, Index k) {
    const auto hexahedron = lattice.hexahedron(i, j, k);
    const Index centre = lattice.n_points() + lattice.cell(i, j, k);
    for (int side = 0; side < 6; ++side) {
      const int axis = side / 2;
      const std::array<Index, 3> at{i, j, k};
      std::array<Index, 4> square;
      for (int m = 0; m < 4; ++m) square[m] = hexahedron[kHexahedronSides[side][m]];
      if (at[axis] == (side % 2 == 0 ? 0 : n - 1)) {
        const Index u = at[(axis + 1) % 3], v = at[(axis + 2) % 3];
        // Corners 0 and 2 of a side are at the low and high ends of both axes.
        const int turn = lattice.diagonal_rises(u, v) ? 0 : 1;
        const Index a = square[turn], b = square[turn + 1], c = square[turn + 2],
                    d = square[(turn + 3) % 4];
        cells.add(CellType::Tetrahedron, {centre, a, b, c});
        cells.add(CellType::Tetrahedron, {centre, a, c, d});
      } else if (side % 2 == 1) {
        const Index other =
            lattice.n_points() + lattice.cell(i + (axis == 0), j + (axis == 1), k + (axis == 2));
        for (int m = 0; m < 4; ++m)
          cells.add(CellType::Tetrahedron, {centre, other, square[m], square[(m + 1) % 4]});
      }
    }
  });
  return finish_volume(std::move(cells).build(), domain, options);
}

}  // namespace carat
