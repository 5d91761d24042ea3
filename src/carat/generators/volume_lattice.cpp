#include "carat/generators/volume_lattice.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat {

Index volume_lattice_size(int level, Index base, double corners_per_cube) {
  const double n = std::ldexp(static_cast<double>(base), level);
  const double n_corners = corners_per_cube * n * n * n;
  if (!(n_corners <= static_cast<double>(std::numeric_limits<Index>::max())))
    throw InvalidOption("level " + std::to_string(level) +
                        ": the mesh would have more than 2^31 face corners; choose a lower level");
  return static_cast<Index>(n);
}

std::array<Index, 8> CubeLattice::hexahedron(Index i, Index j, Index k) const {
  return {point(i, j, k),
          point(i + 1, j, k),
          point(i + 1, j + 1, k),
          point(i, j + 1, k),
          point(i, j, k + 1),
          point(i + 1, j, k + 1),
          point(i + 1, j + 1, k + 1),
          point(i, j + 1, k + 1)};
}

Points CubeLattice::points() const {
  Points points(n_points(), 3);
  for (Index k = 0; k <= n; ++k)
    for (Index j = 0; j <= n; ++j)
      for (Index i = 0; i <= n; ++i) points.row(point(i, j, k)) = at(i, j, k).transpose();
  return points;
}

VolumeBuilder::VolumeBuilder(Points points)
    : points_(std::move(points)),
      ordered_(points_.rows(), 3),
      number_(static_cast<std::size_t>(points_.rows()), -1) {}

std::span<const Index> VolumeBuilder::numbered(std::span<const Index> vertices) {
  scratch_.clear();
  for (const Index v : vertices) {
    if (number_[v] < 0) {
      ordered_.row(count_) = points_.row(v);
      number_[v] = count_++;
    }
    scratch_.push_back(number_[v]);
  }
  return scratch_;
}

void VolumeBuilder::add(CellType type, std::span<const Index> vertices) {
  cells_.add(type, numbered(vertices));
}

void VolumeBuilder::add_face(std::span<const Index> vertices) {
  cells_.add_face(numbered(vertices));
}

PolyhedralMesh VolumeBuilder::build() && {
  ordered_.conservativeResize(count_, 3);
  return std::move(cells_).build(std::move(ordered_));
}

PolyhedralMesh hexahedra(const CubeLattice& lattice, Points points) {
  VolumeBuilder cells(std::move(points));
  lattice.for_cells([&](Index i, Index j, Index k) {
    cells.add(CellType::Hexahedron, lattice.hexahedron(i, j, k));
  });
  return std::move(cells).build();
}

}  // namespace carat
