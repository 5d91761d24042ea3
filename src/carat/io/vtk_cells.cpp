#include "carat/io/vtk_cells.h"

#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

const char* volume_name(int type) {
  switch (type) {
    case VTK_TETRA:
      return "tetrahedron";
    case VTK_VOXEL:
      return "voxel";
    case VTK_HEXAHEDRON:
      return "hexahedron";
    case VTK_WEDGE:
      return "wedge";
    case VTK_PYRAMID:
      return "pyramid";
    case VTK_PENTAGONAL_PRISM:
      return "pentagonal prism";
    case VTK_HEXAGONAL_PRISM:
      return "hexagonal prism";
    case VTK_POLYHEDRON:
      return "polyhedron";
    case VTK_CONVEX_POINT_SET:
      return "convex point set";
    case VTK_QUADRATIC_TETRA:
      return "quadratic tetrahedron";
    case VTK_QUADRATIC_HEXAHEDRON:
      return "quadratic hexahedron";
    case VTK_TRIQUADRATIC_HEXAHEDRON:
      return "triquadratic hexahedron";
    case VTK_LAGRANGE_TETRAHEDRON:
      return "Lagrange tetrahedron";
    case VTK_LAGRANGE_HEXAHEDRON:
      return "Lagrange hexahedron";
    default:
      return nullptr;
  }
}

bool is_point_or_line(int type) {
  return type == VTK_EMPTY_CELL || type == VTK_VERTEX || type == VTK_POLY_VERTEX ||
         type == VTK_LINE || type == VTK_POLY_LINE || type == VTK_QUADRATIC_EDGE ||
         type == VTK_CUBIC_LINE;
}

[[noreturn]] void refuse(int type, std::int64_t cell) {
  if (const char* name = volume_name(type))
    throw IoError("holds volume cells (" + std::string(name) + ", cell " + std::to_string(cell) +
                  "); a surface mesh is needed, extract the surface first");
  throw IoError("cell " + std::to_string(cell) + " has VTK's type " + std::to_string(type) +
                ", which is no flat polygon; convert it to triangles, quadrilaterals or polygons");
}

}  // namespace

void VtkCellFaces::add_face(std::span<const std::int64_t> points) {
  for (const std::int64_t v : points) faces_.add_corner(v);
  faces_.end_face();
  cell_of_face_.push_back(n_cells_);
}

void VtkCellFaces::add_cell(int type, std::span<const std::int64_t> points, std::int64_t n_points) {
  const auto need = [&](std::size_t size) {
    if (points.size() != size)
      throw IoError("cell " + std::to_string(n_cells_) + " has " + std::to_string(points.size()) +
                    " points, its type needs " + std::to_string(size) + "; the file is damaged");
  };
  for (const std::int64_t v : points)
    if (v < 0 || v >= n_points)
      throw InvalidMesh("cell " + std::to_string(n_cells_) + ": vertex " + std::to_string(v) +
                        " does not exist; the mesh has vertices 0 to " +
                        std::to_string(n_points - 1));
  if (type == VTK_TRIANGLE) {
    need(3);
    add_face(points);
  } else if (type == VTK_QUAD) {
    need(4);
    add_face(points);
  } else if (type == VTK_POLYGON) {
    add_face(points);
  } else if (type == VTK_PIXEL) {
    need(4);
    add_face(std::array{points[0], points[1], points[3], points[2]});
  } else if (type == VTK_TRIANGLE_STRIP) {
    // Every other triangle of a strip runs backwards.
    for (std::size_t i = 0; i + 2 < points.size(); ++i)
      add_face(std::array{points[i + i % 2], points[i + 1 - i % 2], points[i + 2]});
  } else if (!is_point_or_line(type)) {
    refuse(type, n_cells_);
  }
  ++n_cells_;
}

Field VtkCellFaces::select_rows(Field field) const {
  const auto n_faces = static_cast<std::int64_t>(cell_of_face_.size());
  bool all = n_faces == n_cells_;
  for (std::int64_t f = 0; all && f < n_faces; ++f)
    all = cell_of_face_[static_cast<std::size_t>(f)] == f;
  if (all) return field;
  Field selected{field.name, field.components, {}};
  selected.values.reserve(cell_of_face_.size() * static_cast<std::size_t>(field.components));
  for (const std::int64_t cell : cell_of_face_) {
    const auto first = field.values.begin() + cell * field.components;
    selected.values.insert(selected.values.end(), first, first + field.components);
  }
  return selected;
}

void add_field(std::vector<Field>& fields, Field field) {
  const auto same = std::find_if(fields.begin(), fields.end(),
                                 [&](const Field& other) { return other.name == field.name; });
  if (same == fields.end()) {
    fields.push_back(std::move(field));
  } else {
    *same = std::move(field);
  }
}

}  // namespace carat::detail
