#pragma once
// VTK's reader of unstructured grids without its part for polyhedra, which trusts the counts in
// the lists of faces.

#include <vtkXMLUnstructuredGridReader.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "carat/io/vtk_xml.h"

namespace carat::detail {

/// Reads everything as its base does, but keeps the faces of polyhedra itself. Knows both ways in
/// which VTK has written them: arrays faces and faceoffsets, and from file version 2.3 on
/// polyhedron_to_faces, polyhedron_offsets, face_connectivity and face_offsets.
class VtkGridReader : public VtkXmlReader<vtkXMLUnstructuredGridReader> {
 public:
  static VtkGridReader* New();

  /// The list of faces of a cell, as VtkCells::add_polyhedron takes it; empty for other cells.
  std::span<const std::int64_t> polyhedron(std::int64_t cell) const;
  /// What is wrong with these lists; empty if nothing is.
  const std::string& problem() const { return problem_; }
  /// No array can have more values than this.
  void set_limit(std::int64_t n_values) { limit_ = n_values; }

 protected:
  int ReadPieceData() override;

 private:
  vtkXMLDataElement* find(vtkXMLDataElement* cells, const char* name);
  std::vector<std::int64_t> read(vtkXMLDataElement* element, std::int64_t n);
  std::vector<std::int64_t> read_offsets(vtkXMLDataElement* element, std::int64_t n);
  void read_streams(vtkXMLDataElement* cells);
  void read_faces(vtkXMLDataElement* cells);
  void end_cells(std::int64_t n_cells);

  std::vector<std::int64_t> streams_, ends_;  ///< of all cells so far
  std::int64_t limit_ = 0;
  std::string problem_;
};

}  // namespace carat::detail
