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

MeshData read_vtp(const FileContent& file) {
  VtkSession session;
  check_vtk_xml(file, "PolyData", session);
  vtkNew<VtkXmlReader<vtkXMLPolyDataReader>> reader;
  run_vtk_reader(reader.Get(), file);
  check_vtk_reader(*reader);
  vtkPolyData* const data = reader->GetOutput();
  const vtkIdType n_points = data->GetNumberOfPoints();
  VtkCells cells;
  const auto add_all = [&](vtkCellArray* list, int type) {
    for_each_cell(list, [&](std::int64_t, std::span<const std::int64_t> points) {
      cells.add_cell(type, points, n_points);
    });
  };
  add_all(data->GetVerts(), VTK_POLY_VERTEX);
  add_all(data->GetLines(), VTK_POLY_LINE);
  add_all(data->GetPolys(), VTK_POLYGON);
  add_all(data->GetStrips(), VTK_TRIANGLE_STRIP);
  return to_mesh(data, cells);
}

void write_vtp(const std::filesystem::path& path, const PolygonMesh& mesh,
               const MeshFields& fields) {
  VtkSession session;
  vtkNew<vtkPolyData> data;
  share_points_and_fields(data, mesh.points(), fields.vertex, fields.face);
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
