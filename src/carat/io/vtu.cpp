// VTU: VTK's XML files of unstructured cells.

#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <string>

#include "carat/base/error.h"
#include "carat/io/vtk_grid_reader.h"
#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"
#include "carat/mesh/cell_kind.h"

namespace carat::detail {
namespace {

bool recognises_vtu(std::string_view content) {
  return vtk_file_type(content) == "UnstructuredGrid";
}

MeshData read_vtu(const FileContent& file) {
  VtkSession session;
  VtkCells cells;
  const auto data = load_vtu(file, session, adding_to(cells));
  return to_mesh(data, cells);
}

void write_vtu(const std::filesystem::path& path, const PolygonMesh& mesh,
               const MeshFields& fields) {
  VtkSession session;
  vtkNew<vtkUnstructuredGrid> data;
  share_points_and_fields(data, mesh.points(), fields.vertex, fields.face);
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

unsigned char vtk_type(CellKind kind) {
  switch (kind) {
    case CellKind::Tetrahedron:
      return VTK_TETRA;
    case CellKind::Hexahedron:
      return VTK_HEXAHEDRON;
    case CellKind::Wedge:
      return VTK_WEDGE;
    case CellKind::Pyramid:
      return VTK_PYRAMID;
    default:
      return VTK_POLYHEDRON;
  }
}

/// Cells in VTK's arrays. Polyhedra have lists of their faces, each pointing outwards.
struct GridCells {
  vtkNew<vtkUnsignedCharArray> types;
  vtkNew<vtkTypeInt32Array> offsets, vertices;
  vtkNew<vtkIdTypeArray> faces, face_locations;
  bool has_polyhedra = false;

  explicit GridCells(const PolyhedralMesh& mesh) {
    offsets->InsertNextValue(0);
    for (Index c = 0; c < mesh.n_cells(); ++c) {
      const StandardCell cell = standard_cell(mesh, c);
      types->InsertNextValue(vtk_type(cell.kind));
      if (cell.kind == CellKind::Polyhedron) {
        add_polyhedron(mesh, c);
      } else {
        face_locations->InsertNextValue(-1);
        for (const Index v : cell.vertices()) vertices->InsertNextValue(v);
      }
      offsets->InsertNextValue(static_cast<vtkTypeInt32>(vertices->GetNumberOfValues()));
    }
  }

 private:
  void add_polyhedron(const PolyhedralMesh& mesh, Index c) {
    has_polyhedra = true;
    for (const Index v : mesh.cell_vertices().row(c)) vertices->InsertNextValue(v);
    face_locations->InsertNextValue(faces->GetNumberOfValues());
    faces->InsertNextValue(static_cast<vtkIdType>(mesh.cell(c).size()));
    for (const Index f : mesh.cell(c)) {
      const std::span<const Index> face = mesh.face(f);
      const bool outwards = mesh.face_cells()[static_cast<std::size_t>(f)].below == c;
      faces->InsertNextValue(static_cast<vtkIdType>(face.size()));
      for (std::size_t k = 0; k < face.size(); ++k)
        faces->InsertNextValue(outwards ? face[k] : face[face.size() - 1 - k]);
    }
  }
};

void write_volume_vtu(const std::filesystem::path& path, const PolyhedralMesh& mesh,
                      const MeshFields& fields, const std::vector<BoundaryPatch>&) {
  VtkSession session;
  vtkNew<vtkUnstructuredGrid> data;
  share_points_and_fields(data, mesh.points(), fields.vertex, fields.cell);
  const GridCells cells(mesh);
  vtkNew<vtkCellArray> list;
  list->SetData(cells.offsets, cells.vertices);
  if (cells.has_polyhedra) {
    data->SetCells(cells.types, list, cells.face_locations, cells.faces);
  } else {
    data->SetCells(cells.types, list);
  }
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  run_vtk_writer(writer, data, path, session);
}

}  // namespace

vtkSmartPointer<vtkPointSet> load_vtu(const FileContent& file, VtkSession& session,
                                      const VtkCellVisitor& visit) {
  check_vtk_xml(file, "UnstructuredGrid", session);
  vtkNew<VtkGridReader> reader;
  reader->set_limit(most_vtk_values(file.bytes));
  run_vtk_reader(static_cast<vtkXMLReader*>(reader.Get()), file);
  if (!reader->problem().empty()) throw IoError(reader->problem());
  check_vtk_reader(*reader);
  vtkUnstructuredGrid* const data = reader->GetOutput();
  const vtkIdType n_points = data->GetNumberOfPoints();
  if (vtkCellArray* const list = data->GetCells()) {
    vtkUnsignedCharArray* const types = data->GetCellTypesArray();
    const vtkIdType n_types = types == nullptr ? 0 : types->GetNumberOfValues();
    if (n_types != list->GetNumberOfCells())
      throw IoError(std::to_string(list->GetNumberOfCells()) + " cells but " +
                    std::to_string(n_types) + " cell types; the file is truncated or damaged");
    for_each_cell(list, [&](std::int64_t cell, std::span<const std::int64_t> points) {
      if (types->GetValue(cell) == VTK_POLYHEDRON) {
        visit.polyhedron(reader->polyhedron(cell), n_points);
      } else {
        visit.cell(types->GetValue(cell), points, n_points);
      }
    });
  }
  return data;
}

FormatEntry vtu_format() {
  return {.format = {"vtu", "VTK XML unstructured grid", {".vtu"}, true, true, true, true, true},
          .recognises = recognises_vtu,
          .read = read_vtu,
          .write = write_vtu,
          .write_volume = write_volume_vtu};
}

}  // namespace carat::detail
