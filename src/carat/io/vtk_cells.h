#pragma once
// Faces from the cells of VTK's data model.

#include <cstdint>
#include <span>
#include <vector>

#include "carat/io/face_collector.h"
#include "carat/mesh/fields.h"

namespace carat::detail {

/// Keeps the 2-D cells: triangles, quadrilaterals, polygons and pixels as they are, strips as
/// their triangles. Vertices and lines are passed over.
class VtkCellFaces {
 public:
  /// Adds the next cell. Points are named by their numbers.
  /// \param type  VTK's number of the cell type
  /// \throws IoError      a volume cell, a curved cell, an unknown type, a wrong number of points
  /// \throws InvalidMesh  a point number that does not exist
  void add_cell(int type, std::span<const std::int64_t> points, std::int64_t n_points);

  std::int64_t n_cells() const { return n_cells_; }
  FaceCollector& faces() { return faces_; }

  /// The rows of a cell field that belong to the faces.
  Field select_rows(Field field) const;

 private:
  void add_face(std::span<const std::int64_t> points);

  FaceCollector faces_;
  std::vector<std::int64_t> cell_of_face_;
  std::int64_t n_cells_ = 0;
};

/// Adds a field; one of the same name that came before is replaced.
void add_field(std::vector<Field>& fields, Field field);

}  // namespace carat::detail
