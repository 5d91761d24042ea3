#pragma once
// What VTP and VTU files share. They are read and written by the library VTK.

#include <vtkSmartPointer.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "carat/base/error.h"
#include "carat/io/format.h"
#include "carat/io/vtk_cells.h"

class vtkCellArray;
class vtkDataSet;
class vtkPointSet;
class vtkXMLDataElement;
class vtkXMLReader;
class vtkXMLWriter;

namespace carat::detail {

class VtkSession;

/// The attribute `type` of the element VTKFile; "" if the content is no such file.
std::string_view vtk_file_type(std::string_view content);

/// No array of the file can have more values: its size, times the best ratio of the compressors.
std::int64_t most_vtk_values(std::string_view content);

/// Refuses, from the XML elements alone, a file of another type and sizes which the file cannot
/// hold. The readers of VTK would allocate them.
/// \throws IoError  malformed XML, another type, impossible sizes
void check_vtk_xml(const FileContent& file, const char* type, VtkSession& session);

/// A reader of VTK that tells whether it failed, which VTK itself only prints.
template <class Reader>
class VtkXmlReader : public Reader {
 public:
  static VtkXmlReader* New() {
    auto* const reader = new VtkXmlReader;
    reader->InitializeObjectBase();
    return reader;
  }
  bool failed() const { return this->DataError != 0 || this->InformationError != 0; }
};

/// The root of a file of that type, VTKFile.
/// \throws IoError  malformed XML, another type
vtkSmartPointer<vtkXMLDataElement> parse_vtk_xml(const FileContent& file, const char* type,
                                                 VtkSession& session);

/// Runs the reader in silence; see VtkXmlReader::failed for how it went.
void run_vtk_reader(vtkXMLReader* reader, const FileContent& file);

/// \throws IoError  if the reader, which has run, failed
template <class Reader>
void check_vtk_reader(const VtkXmlReader<Reader>& reader) {
  if (reader.failed())
    throw IoError(
        "an array of it cannot be read; the file is truncated or damaged, export it again");
}

/// Calls visit(i, points) for the cells of a list, which may be null.
/// \throws IoError  offsets that do not fit the points
void for_each_cell(
    vtkCellArray* cells,
    const std::function<void(std::int64_t cell, std::span<const std::int64_t> points)>& visit);

/// Receives the cells of a file in their order.
struct VtkCellVisitor {
  /// Points are named by their numbers; `type` is VTK's.
  std::function<void(int type, std::span<const std::int64_t> points, std::int64_t n_points)> cell;
  /// The list of faces, as VtkCells::add_polyhedron takes it.
  std::function<void(std::span<const std::int64_t> faces, std::int64_t n_points)> polyhedron;
};

/// Reads a VTU or VTP file.
/// \return  its points and attributes
/// \throws IoError  malformed, truncated, another type
vtkSmartPointer<vtkPointSet> load_vtu(const FileContent& file, VtkSession& session,
                                      const VtkCellVisitor& visit);
vtkSmartPointer<vtkPointSet> load_vtp(const FileContent& file, VtkSession& session,
                                      const VtkCellVisitor& visit);

/// What adds all cells to these.
VtkCellVisitor adding_to(VtkCells& cells);

/// Points and attributes of a data set as they are.
Points points_of(vtkPointSet* data);
std::vector<Field> point_fields(vtkPointSet* data, std::int64_t n_points);
std::vector<Field> cell_fields(vtkPointSet* data, std::int64_t n_cells);

/// The mesh of these cells with the data set's points and attributes.
MeshData to_mesh(vtkPointSet* data, VtkCells& cells);

/// A field's name as VTK can write it: its writers do not escape what means something in XML.
/// \param taken  names of the fields before it
std::string vtk_field_name(std::string name, const std::vector<std::string>& taken);

/// Sets points and attributes. The arrays are shared, not copied: they must outlive the data set.
void share_points_and_fields(vtkPointSet* data, const Points& points,
                             const std::vector<Field>& vertex_fields,
                             const std::vector<Field>& cell_fields);

/// The mesh's faces as cells, shared, not copied.
vtkSmartPointer<vtkCellArray> share_faces(const PolygonMesh& mesh);

void run_vtk_writer(vtkXMLWriter* writer, vtkDataSet* data, const std::filesystem::path& path,
                    VtkSession& session);

}  // namespace carat::detail
