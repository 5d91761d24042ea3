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
  VtkCells cells;
  const auto data = load_vtp(file, session, adding_to(cells));
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

vtkSmartPointer<vtkPointSet> load_vtp(const FileContent& file, VtkSession& session,
                                      const VtkCellVisitor& visit) {
  check_vtk_xml(file, "PolyData", session);
  vtkNew<VtkXmlReader<vtkXMLPolyDataReader>> reader;
  run_vtk_reader(reader.Get(), file);
  check_vtk_reader(*reader);
  vtkPolyData* const data = reader->GetOutput();
  const vtkIdType n_points = data->GetNumberOfPoints();
  const auto visit_all = [&](vtkCellArray* list, int type) {
    for_each_cell(list, [&](std::int64_t, std::span<const std::int64_t> points) {
      visit.cell(type, points, n_points);
    });
  };
  visit_all(data->GetVerts(), VTK_POLY_VERTEX);
  visit_all(data->GetLines(), VTK_POLY_LINE);
  visit_all(data->GetPolys(), VTK_POLYGON);
  visit_all(data->GetStrips(), VTK_TRIANGLE_STRIP);
  return data;
}

FormatEntry vtp_format() {
  return {
      {"vtp", "VTK XML polygons", {".vtp"}, true, true, true}, recognises_vtp, read_vtp, write_vtp};
}

}  // namespace carat::detail
