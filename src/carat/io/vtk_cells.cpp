#include "carat/io/vtk_cells.h"

#include <vtkCellType.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

const char* curved_name(int type) {
  switch (type) {
    case VTK_QUADRATIC_TRIANGLE:
      return "a quadratic triangle";
    case VTK_QUADRATIC_QUAD:
    case VTK_BIQUADRATIC_QUAD:
      return "a quadratic quadrilateral";
    case VTK_QUADRATIC_TETRA:
      return "a quadratic tetrahedron";
    case VTK_QUADRATIC_HEXAHEDRON:
    case VTK_TRIQUADRATIC_HEXAHEDRON:
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
      return "a quadratic hexahedron";
    case VTK_QUADRATIC_WEDGE:
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
      return "a quadratic wedge";
    case VTK_QUADRATIC_PYRAMID:
      return "a quadratic pyramid";
    case VTK_LAGRANGE_TETRAHEDRON:
    case VTK_BEZIER_TETRAHEDRON:
      return "a tetrahedron of higher order";
    case VTK_LAGRANGE_HEXAHEDRON:
    case VTK_BEZIER_HEXAHEDRON:
      return "a hexahedron of higher order";
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
  if (const char* name = curved_name(type))
    throw IoError("cell " + std::to_string(cell) + " is " + name + " (VTK's type " +
                  std::to_string(type) + "), which is curved; convert to cells of first order");
  throw IoError("cell " + std::to_string(cell) + " has VTK's type " + std::to_string(type) +
                ", which is no flat polygon and no polyhedron; convert it to cells that are");
}

bool is_standard_volume(int type) {
  return type == VTK_TETRA || type == VTK_VOXEL || type == VTK_HEXAHEDRON || type == VTK_WEDGE ||
         type == VTK_PYRAMID;
}

}  // namespace

void VtkCells::check_points(std::span<const std::int64_t> points, std::int64_t n_points) const {
  for (const std::int64_t v : points)
    if (v < 0 || v >= n_points || v > std::numeric_limits<Index>::max())
      throw InvalidMesh("cell " + std::to_string(n_cells_) + ": vertex " + std::to_string(v) +
                        " does not exist; the mesh has vertices 0 to " +
                        std::to_string(n_points - 1));
}

void VtkCells::add_face(std::span<const std::int64_t> points) {
  for (const std::int64_t v : points) faces_.add_corner(v);
  faces_.end_face();
  numbers_of_faces_.push_back(n_cells_);
}

void VtkCells::add_volume_cell(CellType type, std::span<const std::int64_t> points) {
  scratch_.assign(points.begin(), points.end());
  cells_.add(type, scratch_);
  numbers_of_cells_.push_back(n_cells_);
}

void VtkCells::add_prism(std::span<const std::int64_t> points) {
  const std::size_t n = points.size() / 2;
  scratch_.assign(points.begin(), points.end());
  const std::vector<Index> all = scratch_;
  cells_.add_face(std::span(all).first(n));
  cells_.add_face(std::span(all).last(n));
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    cells_.add_face(std::array{all[k], all[next], all[n + next], all[n + k]});
  }
  cells_.end_cell();
  numbers_of_cells_.push_back(n_cells_);
}

void VtkCells::add_cell(int type, std::span<const std::int64_t> points, std::int64_t n_points) {
  const auto need = [&](std::size_t size) {
    if (points.size() != size)
      throw IoError("cell " + std::to_string(n_cells_) + " has " + std::to_string(points.size()) +
                    " points, its type needs " + std::to_string(size) + "; the file is damaged");
  };
  check_points(points, n_points);
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
  } else if (is_standard_volume(type)) {
    add_volume_cell(static_cast<CellType>(type), points);
  } else if (type == VTK_PENTAGONAL_PRISM || type == VTK_HEXAGONAL_PRISM) {
    need(type == VTK_PENTAGONAL_PRISM ? 10 : 12);
    add_prism(points);
  } else if (!is_point_or_line(type)) {
    refuse(type, n_cells_);
  }
  ++n_cells_;
}

void VtkCells::add_polyhedron(std::span<const std::int64_t> faces, std::int64_t n_points) {
  const auto take = [&]() {
    if (faces.empty())
      throw IoError("cell " + std::to_string(n_cells_) +
                    ": the list of its faces ends too early; the file is damaged");
    const std::int64_t value = faces.front();
    faces = faces.subspan(1);
    return value;
  };
  const std::int64_t n_faces = take();
  for (std::int64_t f = 0; f < n_faces; ++f) {
    const std::int64_t size = take();
    if (size < 0 || static_cast<std::uint64_t>(size) > faces.size())
      throw IoError("cell " + std::to_string(n_cells_) + ": a face of " + std::to_string(size) +
                    " points does not fit the list of its faces; the file is damaged");
    add_polyhedron_face(faces.first(static_cast<std::size_t>(size)), n_points);
    faces = faces.subspan(static_cast<std::size_t>(size));
  }
  if (!faces.empty())
    throw IoError("cell " + std::to_string(n_cells_) + ": its list of " + std::to_string(n_faces) +
                  " faces is longer than these; the file is damaged");
  end_polyhedron();
}

void VtkCells::add_polyhedron_face(std::span<const std::int64_t> points, std::int64_t n_points) {
  check_points(points, n_points);
  scratch_.assign(points.begin(), points.end());
  cells_.add_face(scratch_);
}

void VtkCells::end_polyhedron() {
  cells_.end_cell();
  numbers_of_cells_.push_back(n_cells_++);
}

MeshData VtkCells::build(Points points, std::vector<Field> vertex_fields,
                         std::vector<Field> cell_fields) {
  const bool volume = !numbers_of_cells_.empty();
  for (Field& field : cell_fields)
    field = select_rows(std::move(field), volume ? numbers_of_cells_ : numbers_of_faces_);
  if (volume)
    return VolumeData{std::move(cells_).build(std::move(points)),
                      {std::move(vertex_fields), {}, std::move(cell_fields)}};
  return SurfaceData{faces_.build(std::move(points)),
                     {std::move(vertex_fields), std::move(cell_fields)}};
}

Field select_rows(Field field, const std::vector<std::int64_t>& rows) {
  const auto n = static_cast<std::int64_t>(rows.size());
  bool all = n == field.n_rows();
  for (std::int64_t i = 0; all && i < n; ++i) all = rows[static_cast<std::size_t>(i)] == i;
  if (all) return field;
  Field selected{field.name, field.components, {}};
  selected.values.reserve(rows.size() * static_cast<std::size_t>(field.components));
  for (const std::int64_t row : rows) {
    const auto first = field.values.begin() + row * field.components;
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
