// VTP: VTK's XML files of polygons. Vertices and lines are passed over.

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>

#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"

namespace carat::detail {
namespace {

/// Also files of other types, so that their error can name the type.
bool recognises_vtp(std::string_view content) {
  const std::string_view type = vtk_file_type(content);
  return !type.empty() && type != "UnstructuredGrid";
}

SurfaceData read_vtp(const FileContent& file) {
  VtkSession session;
  check_vtk_xml(file, "PolyData", session);
  vtkNew<VtkXmlReader<vtkXMLPolyDataReader>> reader;
  run_vtk_reader(reader.Get(), file);
  vtkPolyData* const data = reader->GetOutput();
  const vtkIdType n_points = data->GetNumberOfPoints();
  VtkCellFaces faces;
  add_cells(faces, data->GetVerts(), n_points, VTK_POLY_VERTEX);
  add_cells(faces, data->GetLines(), n_points, VTK_POLY_LINE);
  add_cells(faces, data->GetPolys(), n_points, VTK_POLYGON);
  add_cells(faces, data->GetStrips(), n_points, VTK_TRIANGLE_STRIP);
  return to_surface(data, faces);
}

void write_vtp(const std::filesystem::path& path, const PolygonMesh& mesh,
               const MeshFields& fields) {
  VtkSession session;
  vtkNew<vtkPolyData> data;
  share_points_and_fields(data, mesh, fields);
  data->SetPolys(share_faces(mesh));
  vtkNew<vtkXMLPolyDataWriter> writer;
  run_vtk_writer(writer, data, path, session);
}

}  // namespace

FormatEntry vtp_format() {
  return {
      {"vtp", "VTK XML polygons", {".vtp"}, true, true, true}, recognises_vtp, read_vtp, write_vtp};
}

}  // namespace carat::detail
