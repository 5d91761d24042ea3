#include "carat/io/vtk_lattice.h"

#include <vtkCellType.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "carat/base/error.h"
#include "carat/io/vtk_attributes.h"

namespace carat::detail {
namespace {

// A lattice without values is shorter than its points; so many are accepted in any file.
constexpr std::int64_t kSmallLattice = std::int64_t{1} << 20;

double finite(Scanner& scanner, NumberType type) {
  const double value = scanner.real(type);
  if (!std::isfinite(value))
    scanner.fail("coordinate " + std::to_string(value) +
                 "; every coordinate must be a finite number");
  return value;
}

template <class Position>
Points make_points(const std::array<std::int64_t, 3>& n, Position&& position) {
  Points points(n[0] * n[1] * n[2], 3);
  Eigen::Index row = 0;
  for (std::int64_t z = 0; z < n[2]; ++z)
    for (std::int64_t y = 0; y < n[1]; ++y)
      for (std::int64_t x = 0; x < n[0]; ++x, ++row)
        points.row(row) << position(0, x), position(1, y), position(2, z);
  return points;
}

}  // namespace

void VtkLattice::read_dimensions(Scanner& scanner) {
  const auto limit =
      std::max(kSmallLattice, static_cast<std::int64_t>(scanner.position() + scanner.remaining()));
  std::int64_t total = 1;
  for (std::int64_t& n : n_points) {
    n = scanner.integer();
    if (n < 1) scanner.fail("DIMENSIONS has " + std::to_string(n) + "; at least 1 is needed");
    if (n > limit / total)
      scanner.fail("DIMENSIONS announces more points than the file can hold (" + std::to_string(n) +
                   " in a row); it is truncated or damaged, export it again");
    total *= n;
  }
}

std::array<double, 3> VtkLattice::read_triple(Scanner& scanner) {
  std::array<double, 3> values{};
  for (double& value : values) value = scanner.coordinate();
  return values;
}

void VtkLattice::read_coordinates(Scanner& scanner, std::size_t axis) {
  const std::int64_t n = scanner.integer();
  const NumberType type = read_vtk_type(scanner);
  scanner.start_values();
  scanner.require(n, "coordinates", 1, size_of(type));
  coordinates[axis].resize(static_cast<std::size_t>(n));
  for (double& value : coordinates[axis]) value = finite(scanner, type);
}

Points VtkLattice::regular_points() const {
  return make_points(n_points, [&](std::size_t axis, std::int64_t i) {
    return origin[axis] + static_cast<double>(i) * spacing[axis];
  });
}

Points VtkLattice::rectilinear_points() const {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (static_cast<std::int64_t>(coordinates[axis].size()) != n_points[axis])
      throw IoError(std::to_string(coordinates[axis].size()) + " coordinates " + "XYZ"[axis] +
                    " for " + std::to_string(n_points[axis]) +
                    " points in a row; the file is truncated or damaged");
  return make_points(n_points, [&](std::size_t axis, std::int64_t i) {
    return coordinates[axis][static_cast<std::size_t>(i)];
  });
}

void VtkLattice::add_cells(VtkCells& cells) const {
  std::array<std::int64_t, 3> steps{}, strides{};
  std::size_t dimension = 0;
  for (std::size_t axis = 0, stride = 1; axis < 3; ++axis) {
    if (n_points[axis] > 1) {
      steps[dimension] = n_points[axis] - 1;
      strides[dimension++] = static_cast<std::int64_t>(stride);
    }
    stride *= static_cast<std::size_t>(n_points[axis]);
  }
  if (dimension < 2)
    throw IoError("holds a line of points; a grid with at least 2 points along two axes is needed");
  const std::int64_t layers = dimension == 3 ? steps[2] : 1;
  for (std::int64_t k = 0; k < layers; ++k)
    for (std::int64_t j = 0; j < steps[1]; ++j)
      for (std::int64_t i = 0; i < steps[0]; ++i) {
        const std::int64_t first = i * strides[0] + j * strides[1] + k * strides[2];
        std::array<std::int64_t, 8> corners{};
        for (std::int64_t c = 0; c < 8; ++c)
          corners[static_cast<std::size_t>(c)] =
              first + (c & 1) * strides[0] + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2];
        if (dimension == 3) {
          cells.add_cell(VTK_VOXEL, corners, size());
        } else {
          cells.add_cell(VTK_PIXEL, std::span(corners).first(4), size());
        }
      }
}

}  // namespace carat::detail
