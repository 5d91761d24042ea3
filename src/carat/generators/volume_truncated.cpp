#include <array>
#include <numbers>

#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {
namespace {

// Of an edge, from the vertex that is cut off: then all edges are of one length.
constexpr double kCut = 1 - std::numbers::sqrt2 / 2;

using Place = std::array<Index, 3>;

Place neighbour(const Place& at, int axis, int sign) {
  Place next = at;
  next[axis] += sign;
  return next;
}

/// The cubes of a lattice with their corners cut off, and the cells that fill the gaps.
class TruncatedCubes {
 public:
  TruncatedCubes(const CubeLattice& lattice, const VolumeDomain& domain, double anisotropy)
      : lattice_(lattice), cells_(place_points(domain, points(), anisotropy)) {}

  PolyhedralMesh build() && {
    lattice_.for_cells([&](Index i, Index j, Index k) {
      add_cube({i, j, k});
      // Next to the cubes around it, so that numbers stay close.
      add_gap({i, j, k});
      if (i + 1 == lattice_.n) add_gap({i + 1, j, k});
      if (j + 1 == lattice_.n) add_gap({i, j + 1, k});
      if (k + 1 == lattice_.n) add_gap({i, j, k + 1});
    });
    return std::move(cells_).build();
  }

 private:
  int borders(const Place& at) const {
    int count = 0;
    for (const Index i : at) count += i == 0 || i == lattice_.n ? 1 : 0;
    return count;
  }
  /// Vertices on the edges of the unit cube stay: the pieces cut off there would be flat in a
  /// domain with a smooth border.
  bool is_cut(const Place& at) const { return borders(at) < 2; }
  Index vertex(const Place& at) const { return lattice_.point(at[0], at[1], at[2]); }
  bool exists(const Place& at) const {
    for (const Index i : at)
      if (i < 0 || i > lattice_.n) return false;
    return true;
  }
  /// The point on the edge from `at` along an axis, close to `at`.
  Index cut_point(const Place& at, int axis, int sign) const {
    return lattice_.n_points() + 6 * vertex(at) + 2 * axis + (sign > 0 ? 1 : 0);
  }

  Points points() const {
    Points points = lattice_.points();
    points.conservativeResize(7 * lattice_.n_points(), 3);
    for (Index k = 0; k <= lattice_.n; ++k)
      for (Index j = 0; j <= lattice_.n; ++j)
        for (Index i = 0; i <= lattice_.n; ++i)
          for (int axis = 0; axis < 3; ++axis)
            for (const int sign : {-1, 1}) {
              const Place at{i, j, k};
              // Beyond the border lie points that no cell has.
              Vec3 x = lattice_.at(i, j, k);
              if (exists(neighbour(at, axis, sign))) x[axis] += sign * kCut / lattice_.n;
              points.row(cut_point(at, axis, sign)) = x.transpose();
            }
    return points;
  }

  void add_cube(const Place& low) {
    const auto corner = [&](int at) {
      return Place{low[0] + (at & 1), low[1] + (at >> 1 & 1), low[2] + (at >> 2 & 1)};
    };
    const auto inwards = [&](int at, int axis) { return (at >> axis & 1) == 1 ? -1 : 1; };
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const std::array<int, 4> around{0, 1 << u, 1 << u | 1 << v, 1 << v};
        Index n = 0;
        std::array<Index, 8> face;
        for (int m = 0; m < 4; ++m) {
          const int at = around[m] | side << axis;
          const Place place = corner(at);
          // The side before corners 0 and 2 runs along v, that after them along u.
          const int before = m % 2 == 0 ? v : u, after = m % 2 == 0 ? u : v;
          if (is_cut(place)) {
            face[n++] = cut_point(place, before, inwards(at, before));
            face[n++] = cut_point(place, after, inwards(at, after));
          } else {
            face[n++] = vertex(place);
          }
        }
        cells_.add_face(std::span(face.data(), static_cast<std::size_t>(n)));
      }
    for (int at = 0; at < 8; ++at) {
      const Place place = corner(at);
      if (is_cut(place))
        cells_.add_face({cut_point(place, 0, inwards(at, 0)), cut_point(place, 1, inwards(at, 1)),
                         cut_point(place, 2, inwards(at, 2))});
    }
    cells_.end_cell();
  }

  /// The octahedron about a vertex or, on the border, the half of it: a pyramid.
  void add_gap(const Place& at) {
    if (!is_cut(at)) return;
    const auto tip = [&](int axis, int sign) {
      return exists(neighbour(at, axis, sign)) ? cut_point(at, axis, sign) : -1;
    };
    for (int signs = 0; signs < 8; ++signs) {
      std::array<Index, 3> face;
      for (int axis = 0; axis < 3; ++axis)
        face[axis] = tip(axis, (signs >> axis & 1) == 1 ? 1 : -1);
      if (face[0] >= 0 && face[1] >= 0 && face[2] >= 0) cells_.add_face(face);
    }
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] == 0 || at[axis] == lattice_.n) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        cells_.add_face({tip(u, -1), tip(v, -1), tip(u, 1), tip(v, 1)});
      }
    cells_.end_cell();
  }

  CubeLattice lattice_;
  VolumeBuilder cells_;
};

}  // namespace

/// n = 2 * 2^level cubes along a side. Inside the domain, all faces are regular octagons and
/// triangles in the cube.
PolyhedralMesh generate_volume_truncated(const VolumeDomain& domain, const FamilyOptions& options) {
  const CubeLattice lattice{volume_lattice_size(options.level, 2, 96)};
  TruncatedCubes cubes(lattice, domain, options.anisotropy);
  return finish_volume(std::move(cubes).build(), domain, options);
}

}  // namespace carat
