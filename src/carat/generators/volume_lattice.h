#pragma once
// What the families of volume meshes share: sizes, the grid of the unit cube, numbering.

#include <array>
#include <initializer_list>
#include <span>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// Cells along a side at a level, base * 2^level.
/// \param corners_per_cube  face corners of the mesh, those of both sides of inner faces, over the
///                          cube of the result
/// \throws InvalidOption  the mesh would have 2^31 corners or more
Index volume_lattice_size(int level, Index base, double corners_per_cube);

/// The grid of n by n by n cubes over the unit cube. Points are numbered with x running fastest.
struct CubeLattice {
  Index n;

  Index n_points() const { return (n + 1) * (n + 1) * (n + 1); }
  Index n_cells() const { return n * n * n; }
  Index point(Index i, Index j, Index k) const { return (k * (n + 1) + j) * (n + 1) + i; }
  Index cell(Index i, Index j, Index k) const { return (k * n + j) * n + i; }
  /// In VTK's order.
  std::array<Index, 8> hexahedron(Index i, Index j, Index k) const;
  /// Whether the diagonal from (0, 0) to (1, 1) of the square cell (i, j) of a side points from
  /// the side's middle to a corner of it; else the other diagonal does.
  bool diagonal_rises(Index i, Index j) const { return (2 * i < n) == (2 * j < n); }

  Points points() const;
  Vec3 at(double i, double j, double k) const { return Vec3(i, j, k) / n; }

  template <class Visit>
  void for_cells(Visit&& visit) const {
    for (Index k = 0; k < n; ++k)
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) visit(i, j, k);
  }
};

/// The sides of a hexahedron, by its corners in VTK's order: at low and high x, y, z.
inline constexpr std::array<std::array<int, 4>, 6> kHexahedronSides{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

/// Collects cells and numbers their vertices as the cells first meet them, so that cells close to
/// each other share memory. Points that no cell names are left out.
class VolumeBuilder {
 public:
  explicit VolumeBuilder(Points points);

  void add(CellType type, std::span<const Index> vertices);
  void add(CellType type, std::initializer_list<Index> vertices) {
    add(type, std::span(vertices.begin(), vertices.size()));
  }
  void add_face(std::span<const Index> vertices);
  void add_face(std::initializer_list<Index> vertices) {
    add_face(std::span(vertices.begin(), vertices.size()));
  }
  void end_cell() { cells_.end_cell(); }
  PolyhedralMesh build() &&;

 private:
  std::span<const Index> numbered(std::span<const Index> vertices);

  Points points_, ordered_;
  Array<Index> number_;
  Index count_ = 0;
  std::vector<Index> scratch_;
  CellCollector cells_;
};

/// The cubes of the lattice with its points at `points`.
PolyhedralMesh hexahedra(const CubeLattice& lattice, Points points);

}  // namespace carat
