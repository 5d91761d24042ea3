// Legacy VTK files, text and binary. The library VTK is not used here: its readers trust the sizes
// and cell lengths that a damaged file gives them.

#include <vtkCellType.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"
#include "carat/io/vtk_attributes.h"
#include "carat/io/vtk_cells.h"
#include "carat/io/vtk_lattice.h"

namespace carat::detail {
namespace {

/// One list of cells, row i = indices[offsets[i] .. offsets[i+1]).
struct CellList {
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int64_t> points;
  std::size_t size() const { return offsets.size() - 1; }
  std::span<const std::int64_t> cell(std::size_t i) const {
    return {points.data() + offsets[i], static_cast<std::size_t>(offsets[i + 1] - offsets[i])};
  }
};

enum class DataSet { Polygons, Cells, RegularLattice, Grid, RectilinearLattice };

struct Geometry {
  DataSet kind = DataSet::Polygons;
  Points points;
  CellList vertices, lines, polygons, strips;  ///< of POLYDATA
  CellList cells;                              ///< of UNSTRUCTURED_GRID
  std::vector<int> cell_types;
  VtkLattice lattice;  ///< of the structured kinds
};

bool recognises_vtk(std::string_view content) { return content.starts_with("# vtk DataFile"); }

Points read_points(Scanner& scanner) {
  const std::int64_t n = scanner.integer();
  const NumberType type = read_vtk_type(scanner);
  scanner.start_values();
  scanner.require(n, "points", 3, 3 * size_of(type));
  Points points(n, 3);
  for (std::int64_t v = 0; v < n; ++v)
    for (int k = 0; k < 3; ++k) {
      const double value = scanner.real(type);
      if (!std::isfinite(value))
        scanner.fail("vertex " + std::to_string(v) + ": coordinate " + std::to_string(value) +
                     "; every coordinate must be a finite number");
      points(v, k) = value;
    }
  return points;
}

/// Rows "n v1 ... vn", as before version 5.
CellList read_rows(Scanner& scanner, std::int64_t n_cells, std::int64_t n_values) {
  scanner.start_values();
  scanner.require(n_values, "cell values", 1, 4);
  scanner.require(n_cells, "cells", 1, 4);
  CellList list;
  list.offsets.reserve(static_cast<std::size_t>(n_cells) + 1);
  for (std::int64_t i = 0; i < n_cells; ++i) {
    const std::int64_t size = scanner.whole(NumberType::Int32);
    if (size < 0 || size >= n_values)
      scanner.fail("cell " + std::to_string(i) + " has " + std::to_string(size) +
                   " points, which is not what the header says; the file is damaged");
    n_values -= size + 1;
    for (std::int64_t k = 0; k < size; ++k) list.points.push_back(scanner.whole(NumberType::Int32));
    list.offsets.push_back(static_cast<std::int64_t>(list.points.size()));
  }
  if (n_values != 0) scanner.fail("the cells are fewer than the header says; the file is damaged");
  return list;
}

std::vector<std::int64_t> read_named_integers(Scanner& scanner, const char* name,
                                              std::int64_t count) {
  if (!scanner.to_content() || scanner.word() != name)
    scanner.fail(std::string(name) + " is missing; the file is damaged");
  const NumberType type = read_vtk_type(scanner);
  if (!is_integer(type)) scanner.fail(std::string(name) + " must be whole numbers");
  scanner.start_values();
  scanner.require(count, "cell values", 1, size_of(type));
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  for (std::int64_t& value : values) value = scanner.whole(type);
  return values;
}

/// Arrays OFFSETS and CONNECTIVITY, from version 5 on.
CellList read_offsets(Scanner& scanner, std::int64_t n_offsets, std::int64_t n_points) {
  CellList list;
  if (n_offsets == 0 && n_points == 0) return list;
  list.offsets = read_named_integers(scanner, "OFFSETS", n_offsets);
  skip_vtk_metadata(scanner);
  list.points = read_named_integers(scanner, "CONNECTIVITY", n_points);
  if (list.offsets.empty() || list.offsets.front() != 0 || list.offsets.back() != n_points ||
      !std::is_sorted(list.offsets.begin(), list.offsets.end()))
    scanner.fail("OFFSETS must ascend from 0 to the size of CONNECTIVITY; the file is damaged");
  return list;
}

CellList read_cells(Scanner& scanner, int version) {
  const std::int64_t first = scanner.integer();
  const std::int64_t second = scanner.integer();
  return version < 5 ? read_rows(scanner, first, second) : read_offsets(scanner, first, second);
}

std::vector<int> read_cell_types(Scanner& scanner) {
  const std::int64_t n = scanner.integer();
  scanner.start_values();
  scanner.require(n, "cell types", 1, 4);
  std::vector<int> types(static_cast<std::size_t>(n));
  for (int& type : types) type = static_cast<int>(scanner.whole(NumberType::Int32));
  return types;
}

/// Reads the geometry up to the line POINT_DATA or CELL_DATA, whose keyword it returns.
std::string read_geometry(Scanner& scanner, int version, Geometry& geometry) {
  while (scanner.to_content()) {
    std::string keyword = upper_case(scanner.word());
    if (keyword == "POINTS") {
      geometry.points = read_points(scanner);
    } else if (keyword == "VERTICES") {
      geometry.vertices = read_cells(scanner, version);
    } else if (keyword == "LINES") {
      geometry.lines = read_cells(scanner, version);
    } else if (keyword == "POLYGONS") {
      geometry.polygons = read_cells(scanner, version);
    } else if (keyword == "TRIANGLE_STRIPS") {
      geometry.strips = read_cells(scanner, version);
    } else if (keyword == "CELLS") {
      geometry.cells = read_cells(scanner, version);
    } else if (keyword == "CELL_TYPES") {
      geometry.cell_types = read_cell_types(scanner);
    } else if (keyword == "DIMENSIONS") {
      geometry.lattice.read_dimensions(scanner);
    } else if (keyword == "ORIGIN") {
      geometry.lattice.origin = VtkLattice::read_triple(scanner);
    } else if (keyword == "SPACING" || keyword == "ASPECT_RATIO") {
      geometry.lattice.spacing = VtkLattice::read_triple(scanner);
    } else if (keyword == "X_COORDINATES" || keyword == "Y_COORDINATES" ||
               keyword == "Z_COORDINATES") {
      geometry.lattice.read_coordinates(scanner, static_cast<std::size_t>(keyword[0] - 'X'));
    } else if (keyword == "FIELD") {
      skip_vtk_field_data(scanner);
    } else if (keyword == "METADATA") {
      skip_vtk_metadata_block(scanner);
    } else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
      return keyword;
    } else {
      scanner.fail(in_quotes(keyword) + " is no VTK keyword; the file is damaged");
    }
  }
  return {};
}

/// Sets the points of a structured data set from what describes them.
void set_lattice_points(Geometry& geometry) {
  const VtkLattice& lattice = geometry.lattice;
  if (lattice.size() == 0) throw IoError("DIMENSIONS is missing; the file is damaged");
  if (geometry.kind == DataSet::RegularLattice) geometry.points = lattice.regular_points();
  if (geometry.kind == DataSet::RectilinearLattice) geometry.points = lattice.rectilinear_points();
  if (geometry.points.rows() != lattice.size())
    throw IoError(std::to_string(geometry.points.rows()) + " points, but DIMENSIONS says " +
                  std::to_string(lattice.size()) + "; the file is truncated or damaged");
}

void add_polygons(VtkCells& cells, const Geometry& geometry) {
  const auto add_all = [&](const CellList& list, int type) {
    for (std::size_t i = 0; i < list.size(); ++i)
      cells.add_cell(type, list.cell(i), geometry.points.rows());
  };
  add_all(geometry.vertices, VTK_POLY_VERTEX);
  add_all(geometry.lines, VTK_POLY_LINE);
  add_all(geometry.polygons, VTK_POLYGON);
  add_all(geometry.strips, VTK_TRIANGLE_STRIP);
}

void add_unstructured_cells(VtkCells& cells, const Geometry& geometry) {
  if (geometry.cell_types.size() != geometry.cells.size())
    throw IoError(std::to_string(geometry.cells.size()) + " cells but " +
                  std::to_string(geometry.cell_types.size()) +
                  " cell types; the file is truncated or damaged");
  for (std::size_t i = 0; i < geometry.cells.size(); ++i) {
    if (geometry.cell_types[i] == VTK_POLYHEDRON) {
      cells.add_polyhedron(geometry.cells.cell(i), geometry.points.rows());
    } else {
      cells.add_cell(geometry.cell_types[i], geometry.cells.cell(i), geometry.points.rows());
    }
  }
}

VtkCells collect_cells(Geometry& geometry) {
  VtkCells cells;
  if (geometry.kind == DataSet::Polygons) {
    add_polygons(cells, geometry);
  } else if (geometry.kind == DataSet::Cells) {
    add_unstructured_cells(cells, geometry);
  } else {
    set_lattice_points(geometry);
    geometry.lattice.add_cells(cells);
  }
  return cells;
}

struct Attributes {
  std::vector<Field> vertex, cell;
};

Attributes read_attributes(Scanner& scanner, std::string section, std::int64_t n_points,
                           std::int64_t n_cells) {
  Attributes attributes;
  while (!section.empty()) {
    const bool of_points = section == "POINT_DATA";
    const std::int64_t expected = of_points ? n_points : n_cells;
    const std::int64_t n = scanner.integer();
    if (n != expected)
      scanner.fail(section + " for " + std::to_string(n) + " elements, the mesh has " +
                   std::to_string(expected) + "; the file is damaged");
    std::vector<Field> read;
    section = read_vtk_attributes(scanner, n, read);
    for (Field& field : read)
      add_field(of_points ? attributes.vertex : attributes.cell, std::move(field));
  }
  return attributes;
}

DataSet read_data_set(Scanner& scanner) {
  if (!scanner.to_content() || upper_case(scanner.word()) != "DATASET")
    scanner.fail("the line DATASET is missing; the file is damaged");
  const std::string name = upper_case(scanner.word());
  if (name == "POLYDATA") return DataSet::Polygons;
  if (name == "UNSTRUCTURED_GRID") return DataSet::Cells;
  if (name == "STRUCTURED_POINTS") return DataSet::RegularLattice;
  if (name == "STRUCTURED_GRID") return DataSet::Grid;
  if (name == "RECTILINEAR_GRID") return DataSet::RectilinearLattice;
  throw IoError("holds a data set " + in_quotes(name) +
                "; POLYDATA, UNSTRUCTURED_GRID or a structured one is needed");
}

/// Reads "# vtk DataFile Version 4.2" and the title; returns the major version.
int read_version(Scanner& scanner) {
  for (int i = 0; i < 4; ++i) scanner.word();
  const double version = scanner.number();
  if (!(version >= 1 && version < 6))
    scanner.fail("version " + std::to_string(version) + " of VTK's file format is not known");
  scanner.skip_line();
  scanner.skip_line();
  return static_cast<int>(version);
}

MeshData read_vtk(const FileContent& file) {
  Scanner scanner(file.bytes);
  if (!recognises_vtk(file.bytes)) scanner.fail("does not start with '# vtk DataFile'");
  const int version = read_version(scanner);
  const std::string encoding = upper_case(scanner.word());
  if (encoding != "ASCII" && encoding != "BINARY")
    scanner.fail("neither ASCII nor BINARY; the file is damaged");
  scanner.skip_line();
  if (encoding == "BINARY") scanner.set_encoding(Encoding::BigEndian);
  Geometry geometry;
  geometry.kind = read_data_set(scanner);
  std::string section = read_geometry(scanner, version, geometry);
  VtkCells cells = collect_cells(geometry);
  Attributes attributes =
      read_attributes(scanner, std::move(section), geometry.points.rows(), cells.n_cells());
  return cells.build(std::move(geometry.points), std::move(attributes.vertex),
                     std::move(attributes.cell));
}

}  // namespace

FormatEntry vtk_format() {
  return {.format = {"vtk", "VTK legacy", {".vtk"}, true, false, true, true, false},
          .recognises = recognises_vtk,
          .read = read_vtk};
}

}  // namespace carat::detail
