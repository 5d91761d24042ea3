#pragma once
// Meshes from the cells of VTK's data model.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "carat/io/face_collector.h"
#include "carat/io/mesh_file.h"

namespace carat::detail {

/// Collects cells of any dimension. With volume cells they become a volume mesh, and the 2-D ones
/// are passed over; without, the 2-D cells become a surface: triangles, quadrilaterals, polygons
/// and pixels as they are, strips as their triangles. Vertices and lines are passed over.
class VtkCells {
 public:
  /// Adds the next cell. Points are named by their numbers.
  /// \param type  VTK's number of the cell type, not of polyhedra
  /// \throws IoError      a curved cell, an unknown type, a wrong number of points
  /// \throws InvalidMesh  a point number that does not exist
  void add_cell(int type, std::span<const std::int64_t> points, std::int64_t n_points);

  /// Adds a polyhedron by VTK's list of its faces: their number, and for each the number of its
  /// points and these.
  /// \throws IoError  the list is longer or shorter than it says; InvalidMesh as add_cell
  void add_polyhedron(std::span<const std::int64_t> faces, std::int64_t n_points);
  /// Adds a polyhedron face by face.
  void add_polyhedron_face(std::span<const std::int64_t> points, std::int64_t n_points);
  void end_polyhedron();

  std::int64_t n_cells() const { return n_cells_; }

  /// The mesh of these cells.
  /// \param cell_fields  with a row for each of the n_cells() cells
  MeshData build(Points points, std::vector<Field> vertex_fields, std::vector<Field> cell_fields);

 private:
  void add_face(std::span<const std::int64_t> points);
  void add_volume_cell(CellType type, std::span<const std::int64_t> points);
  void add_prism(std::span<const std::int64_t> points);
  void check_points(std::span<const std::int64_t> points, std::int64_t n_points) const;

  FaceCollector faces_;
  CellCollector cells_;
  std::vector<std::int64_t> numbers_of_faces_, numbers_of_cells_;
  std::vector<Index> scratch_;
  std::int64_t n_cells_ = 0;
};

/// Adds a field; one of the same name that came before is replaced.
void add_field(std::vector<Field>& fields, Field field);

/// The rows of a field with these numbers, ascending.
Field select_rows(Field field, const std::vector<std::int64_t>& rows);

}  // namespace carat::detail
