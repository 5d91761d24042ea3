// VTU: VTK's XML files of unstructured cells, of which the 2-D ones are read.

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <string>

#include "carat/base/error.h"
#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"

namespace carat::detail {
namespace {

bool recognises_vtu(std::string_view content) {
  return vtk_file_type(content) == "UnstructuredGrid";
}

SurfaceData read_vtu(const FileContent& file) {
  VtkSession session;
  check_vtk_xml(file, "UnstructuredGrid", session);
  vtkNew<VtkXmlReader<vtkXMLUnstructuredGridReader>> reader;
  run_vtk_reader(reader.Get(), file);
  vtkUnstructuredGrid* const data = reader->GetOutput();
  VtkCellFaces faces;
  if (vtkCellArray* const cells = data->GetCells()) {
    vtkUnsignedCharArray* const types = data->GetCellTypesArray();
    const vtkIdType n_types = types == nullptr ? 0 : types->GetNumberOfValues();
    if (n_types != cells->GetNumberOfCells())
      throw IoError(std::to_string(cells->GetNumberOfCells()) + " cells but " +
                    std::to_string(n_types) + " cell types; the file is truncated or damaged");
    if (n_types > 0)
      add_cells(faces, cells, data->GetNumberOfPoints(), VTK_EMPTY_CELL, types->GetPointer(0));
  }
  return to_surface(data, faces);
}

void write_vtu(const std::filesystem::path& path, const PolygonMesh& mesh,
               const MeshFields& fields) {
  VtkSession session;
  vtkNew<vtkUnstructuredGrid> data;
  share_points_and_fields(data, mesh, fields);
  vtkNew<vtkUnsignedCharArray> types;
  types->SetNumberOfValues(mesh.n_faces());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const std::size_t size = mesh.face(f).size();
    types->SetValue(f, size == 3 ? VTK_TRIANGLE : size == 4 ? VTK_QUAD : VTK_POLYGON);
  }
  data->SetCells(types, share_faces(mesh));
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  run_vtk_writer(writer, data, path, session);
}

}  // namespace

FormatEntry vtu_format() {
  return {{"vtu", "VTK XML unstructured grid", {".vtu"}, true, true, true},
          recognises_vtu,
          read_vtu,
          write_vtu};
}

}  // namespace carat::detail
