#include "carat/io/vtk_xml.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLReader.h>
#include <vtkXMLWriter.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/parallel_vtk.h"
#include "carat/io/vtk_session.h"

namespace carat::detail {
namespace {

/// Copies row by row; `to` has room for all values.
void copy_values(vtkDataArray* array, double* to) {
  const vtkIdType n = array->GetNumberOfTuples();
  const int components = array->GetNumberOfComponents();
  if (auto* const doubles = vtkDoubleArray::FastDownCast(array)) {
    const double* const first = doubles->GetPointer(0);
    std::copy(first, first + n * components, to);
    return;
  }
  for (vtkIdType i = 0; i < n; ++i)
    for (int k = 0; k < components; ++k) *to++ = array->GetComponent(i, k);
}

std::vector<Field> to_fields(vtkDataSetAttributes* attributes, vtkIdType n_rows,
                             const char* where) {
  std::vector<Field> fields;
  for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
    vtkDataArray* const array = attributes->GetArray(i);
    if (array == nullptr || array->GetName() == nullptr) continue;  // texts, for example
    if (array->GetNumberOfTuples() != n_rows || array->GetNumberOfComponents() < 1)
      throw IoError(std::string(where) + " array '" + array->GetName() + "' has " +
                    std::to_string(array->GetNumberOfTuples()) + " rows, the mesh needs " +
                    std::to_string(n_rows) + "; the file is truncated or damaged");
    Field field{array->GetName(), array->GetNumberOfComponents(), {}};
    field.values.resize(static_cast<std::size_t>(array->GetNumberOfValues()));
    copy_values(array, field.values.data());
    add_field(fields, std::move(field));
  }
  return fields;
}

Points to_points(vtkPoints* points) {
  if (points == nullptr) return Points(0, 3);
  vtkDataArray* const array = points->GetData();
  if (array->GetNumberOfComponents() != 3)
    throw IoError("the points have " + std::to_string(array->GetNumberOfComponents()) +
                  " coordinates instead of 3; the file is damaged");
  Points result(array->GetNumberOfTuples(), 3);
  copy_values(array, result.data());
  return result;
}

/// VTK wants arrays that it could change; writers only read them.
template <class ArrayType, class T>
vtkSmartPointer<ArrayType> share(const T* values, std::size_t n, int components = 1) {
  auto array = vtkSmartPointer<ArrayType>::New();
  array->SetNumberOfComponents(components);
  array->SetArray(const_cast<T*>(values), static_cast<vtkIdType>(n), 1);
  return array;
}

/// VTK takes elements of other parts for such only by bytes.
vtkSmartPointer<vtkDataArray> to_array(const Field& field) {
  if (field.name != kGhostField)
    return share<vtkDoubleArray>(field.values.data(), field.values.size(), field.components);
  auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
  bytes->SetNumberOfComponents(field.components);
  bytes->SetNumberOfTuples(field.n_rows());
  std::transform(field.values.begin(), field.values.end(), bytes->GetPointer(0),
                 [](double value) { return static_cast<unsigned char>(value); });
  return bytes;
}

void share_fields(vtkDataSetAttributes* attributes, const std::vector<Field>& fields) {
  std::vector<std::string> names;
  for (const Field& field : fields) {
    names.push_back(vtk_field_name(field.name, names));
    const vtkSmartPointer<vtkDataArray> array = to_array(field);
    array->SetName(names.back().c_str());
    attributes->AddArray(array);
  }
}

}  // namespace

std::string vtk_field_name(std::string name, const std::vector<std::string>& taken) {
  for (char& c : name)
    if (std::string_view("<>&\"'").find(c) != std::string_view::npos ||
        static_cast<unsigned char>(c) < ' ')
      c = '_';
  while (std::find(taken.begin(), taken.end(), name) != taken.end()) name += '_';
  return name;
}

void run_vtk_reader(vtkXMLReader* reader, const FileContent& file) {
  // The readers of VTK 9.1 look up a name that is not there when they word the error about an
  // array which they cannot read. Nobody hears it with the display off, and it is not worded.
  struct Silence {
    int previous = vtkObject::GetGlobalWarningDisplay();
    Silence() { vtkObject::SetGlobalWarningDisplay(0); }
    ~Silence() { vtkObject::SetGlobalWarningDisplay(previous); }
  };
  const Silence silence;
  reader->SetFileName(file.path.c_str());
  reader->Update();
}

void for_each_cell(
    vtkCellArray* cells,
    const std::function<void(std::int64_t cell, std::span<const std::int64_t> points)>& visit) {
  if (cells == nullptr) return;
  if (!cells->IsValid())
    throw IoError("the cell offsets do not fit the connectivity; the file is damaged");
  std::vector<std::int64_t> points;
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
    vtkIdType n = 0;
    const vtkIdType* first = nullptr;
    cells->GetCellAtId(i, n, first);
    points.assign(first, first + n);
    visit(i, points);
  }
}

VtkCellVisitor adding_to(VtkCells& cells) {
  return {[&cells](int type, std::span<const std::int64_t> points, std::int64_t n_points) {
            cells.add_cell(type, points, n_points);
          },
          [&cells](std::span<const std::int64_t> faces, std::int64_t n_points) {
            cells.add_polyhedron(faces, n_points);
          }};
}

Points points_of(vtkPointSet* data) { return to_points(data->GetPoints()); }
std::vector<Field> point_fields(vtkPointSet* data, std::int64_t n_points) {
  return to_fields(data->GetPointData(), n_points, "point");
}
std::vector<Field> cell_fields(vtkPointSet* data, std::int64_t n_cells) {
  return to_fields(data->GetCellData(), n_cells, "cell");
}

MeshData to_mesh(vtkPointSet* data, VtkCells& cells) {
  Points points = points_of(data);
  std::vector<Field> vertex_fields = point_fields(data, points.rows());
  return cells.build(std::move(points), std::move(vertex_fields),
                     cell_fields(data, cells.n_cells()));
}

void share_points_and_fields(vtkPointSet* data, const Points& positions,
                             const std::vector<Field>& vertex_fields,
                             const std::vector<Field>& cell_fields) {
  vtkNew<vtkPoints> points;
  points->SetData(
      share<vtkDoubleArray>(positions.data(), static_cast<std::size_t>(positions.size()), 3));
  data->SetPoints(points);
  share_fields(data->GetPointData(), vertex_fields);
  share_fields(data->GetCellData(), cell_fields);
}

vtkSmartPointer<vtkCellArray> share_faces(const PolygonMesh& mesh) {
  const Csr& faces = mesh.faces();
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(share<vtkTypeInt32Array>(faces.offsets.data(), faces.offsets.size()),
                 share<vtkTypeInt32Array>(faces.indices.data(), faces.indices.size()));
  return cells;
}

void run_vtk_writer(vtkXMLWriter* writer, vtkDataSet* data, const std::filesystem::path& path,
                    VtkSession& session) {
  // The first level compresses nearly as well as the default and takes a third of the time.
  constexpr int kCompressionLevel = 1;
  session.watch(writer);
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(kCompressionLevel);
  const bool written = writer->Write() == 1 && writer->GetErrorCode() == 0;
  if (!written || !session.first_error().empty())
    throw IoError("cannot be written: " + (session.first_error().empty()
                                               ? std::string("is the disk full?")
                                               : session.first_error()));
}

}  // namespace carat::detail
