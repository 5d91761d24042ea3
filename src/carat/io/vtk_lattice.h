#pragma once
// The structured data sets of legacy VTK files: STRUCTURED_POINTS, STRUCTURED_GRID and
// RECTILINEAR_GRID.

#include <array>
#include <cstdint>
#include <vector>

#include "carat/io/scanner.h"
#include "carat/io/vtk_cells.h"

namespace carat::detail {

/// Points in rows along x, then y, then z.
struct VtkLattice {
  std::array<std::int64_t, 3> n_points{0, 0, 0};
  std::array<double, 3> origin{0, 0, 0}, spacing{1, 1, 1};
  std::array<std::vector<double>, 3> coordinates;

  /// Reads the three numbers behind DIMENSIONS.
  /// \throws IoError  no numbers of points, or more than the file can mean
  void read_dimensions(Scanner& scanner);
  /// Reads the three numbers behind ORIGIN or SPACING.
  static std::array<double, 3> read_triple(Scanner& scanner);
  /// Reads the array behind X_COORDINATES and so on.
  void read_coordinates(Scanner& scanner, std::size_t axis);

  std::int64_t size() const { return n_points[0] * n_points[1] * n_points[2]; }
  /// Points of STRUCTURED_POINTS.
  Points regular_points() const;
  /// Points of RECTILINEAR_GRID.
  /// \throws IoError  the coordinates do not fit the dimensions
  Points rectilinear_points() const;
  /// Hexahedra, or quadrilaterals where there is one layer of points.
  void add_cells(VtkCells& cells) const;
};

}  // namespace carat::detail
