#pragma once
// What VTP and VTU files share. They are read and written by the library VTK.

#include <vtkSmartPointer.h>

#include <filesystem>
#include <string_view>

#include "carat/base/error.h"
#include "carat/io/format.h"
#include "carat/io/vtk_cells.h"

class vtkCellArray;
class vtkDataSet;
class vtkPointSet;
class vtkXMLReader;
class vtkXMLWriter;

namespace carat::detail {

class VtkSession;

/// The attribute `type` of the element VTKFile; "" if the content is no such file.
std::string_view vtk_file_type(std::string_view content);

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

/// Runs the reader in silence; see VtkXmlReader::failed for how it went.
void run_vtk_reader(vtkXMLReader* reader, const FileContent& file);

/// Runs the reader.
/// \throws IoError  if it fails
template <class Reader>
void run_vtk_reader(VtkXmlReader<Reader>* reader, const FileContent& file) {
  run_vtk_reader(static_cast<vtkXMLReader*>(reader), file);
  if (reader->failed())
    throw IoError(
        "an array of it cannot be read; the file is truncated or damaged, export it again");
}

/// Adds all cells of a list, as cells of one type or of types[i].
void add_cells(VtkCellFaces& faces, vtkCellArray* cells, vtkIdType n_points, int type,
               const unsigned char* types = nullptr);

/// The mesh of these faces with the data set's points and attributes.
SurfaceData to_surface(vtkPointSet* data, VtkCellFaces& faces);

/// Sets points and attributes. The arrays are shared, not copied: the mesh must outlive them.
void share_points_and_fields(vtkPointSet* data, const PolygonMesh& mesh, const MeshFields& fields);

/// The mesh's faces as cells, shared, not copied.
vtkSmartPointer<vtkCellArray> share_faces(const PolygonMesh& mesh);

void run_vtk_writer(vtkXMLWriter* writer, vtkDataSet* data, const std::filesystem::path& path,
                    VtkSession& session);

}  // namespace carat::detail
