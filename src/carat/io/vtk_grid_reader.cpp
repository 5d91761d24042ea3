#include "carat/io/vtk_grid_reader.h"

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

/// Adds to the numbers of the points in a list of faces. One that is cut off is left for later.
void shift_points(std::span<std::int64_t> stream, std::int64_t start) {
  for (std::size_t i = 1; i < stream.size();) {
    const std::int64_t size = stream[i++];
    if (size < 0 || static_cast<std::uint64_t>(size) > stream.size() - i) return;
    for (std::int64_t k = 0; k < size; ++k) stream[i++] += start;
  }
}

}  // namespace

VtkGridReader* VtkGridReader::New() {
  auto* const reader = new VtkGridReader;
  reader->InitializeObjectBase();
  return reader;
}

std::span<const std::int64_t> VtkGridReader::polyhedron(std::int64_t cell) const {
  const auto c = static_cast<std::size_t>(cell);
  if (c >= ends_.size()) return {};
  const auto begin = static_cast<std::size_t>(c == 0 ? 0 : ends_[c - 1]);
  return std::span(streams_).subspan(begin, static_cast<std::size_t>(ends_[c]) - begin);
}

int VtkGridReader::ReadPieceData() {
  vtkXMLDataElement* const cells = CellElements[Piece];
  try {
    end_cells(StartCell);
    if (cells != nullptr && find(cells, "faces") != nullptr) {
      read_streams(cells);
    } else if (cells != nullptr && find(cells, "polyhedron_to_faces") != nullptr) {
      read_faces(cells);
    }
  } catch (const IoError& error) {
    // Nothing may fly through VTK.
    problem_ = error.what();
    return 0;
  }
  for (const char* name : {"faces", "faceoffsets"})
    if (cells != nullptr)
      if (vtkXMLDataElement* const element = find(cells, name)) cells->RemoveNestedElement(element);
  return vtkXMLUnstructuredGridReader::ReadPieceData();
}

vtkXMLDataElement* VtkGridReader::find(vtkXMLDataElement* cells, const char* name) {
  return FindDataArrayWithName(cells, name);
}

std::vector<std::int64_t> VtkGridReader::read(vtkXMLDataElement* element, std::int64_t n) {
  const std::string name = "array '" + std::string(element->GetAttribute("Name")) + "' of cells ";
  if (n < 0 || n > limit_)
    throw IoError(name + "should have " + std::to_string(n) +
                  " values, more than the file can hold; it is truncated or damaged");
  const auto raw = vtkSmartPointer<vtkAbstractArray>::Take(CreateArray(element));
  vtkDataArray* const array = vtkDataArray::SafeDownCast(raw);
  if (array == nullptr || array->GetNumberOfComponents() != 1)
    throw IoError(name + "does not have one number a row; the file is damaged");
  array->SetNumberOfTuples(n);
  if (array->GetNumberOfTuples() != n || (n > 0 && ReadArrayValues(element, 0, array, 0, n) == 0))
    throw IoError(name + "cannot be read or has fewer than " + std::to_string(n) +
                  " values; the file is truncated or damaged");
  std::vector<std::int64_t> values(static_cast<std::size_t>(n));
  for (std::int64_t i = 0; i < n; ++i) {
    const double value = array->GetComponent(i, 0);
    if (!(std::abs(value) < 9e15) || value != std::floor(value))
      throw IoError(name + "has a value that is no index; the file is damaged");
    values[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(value);
  }
  return values;
}

std::vector<std::int64_t> VtkGridReader::read_offsets(vtkXMLDataElement* element, std::int64_t n) {
  std::vector<std::int64_t> offsets = read(element, n);
  std::int64_t last = 0;
  for (const std::int64_t offset : offsets) {
    if (offset < last)
      throw IoError("array '" + std::string(element->GetAttribute("Name")) +
                    "' of cells must ascend from 0; the file is damaged");
    last = offset;
  }
  return offsets;
}

/// Cells without a list up to this one.
void VtkGridReader::end_cells(std::int64_t n_cells) {
  ends_.resize(static_cast<std::size_t>(n_cells), static_cast<std::int64_t>(streams_.size()));
}

void VtkGridReader::read_streams(vtkXMLDataElement* cells) {
  vtkXMLDataElement* const offsets_element = find(cells, "faceoffsets");
  if (offsets_element == nullptr)
    throw IoError("array 'faceoffsets' of cells is missing; the file is damaged");
  // -1 marks cells that are no polyhedra.
  const std::vector<std::int64_t> offsets = read(offsets_element, NumberOfCells[Piece]);
  std::int64_t last = 0;
  for (const std::int64_t offset : offsets) {
    if (offset >= 0 && offset < last)
      throw IoError("array 'faceoffsets' of cells descends; the file is damaged");
    last = std::max(last, offset);
  }
  const std::vector<std::int64_t> faces = read(find(cells, "faces"), last);
  const auto base = static_cast<std::int64_t>(streams_.size());
  streams_.insert(streams_.end(), faces.begin(), faces.end());
  std::int64_t end = 0;
  for (const std::int64_t offset : offsets) {
    const std::int64_t begin = std::exchange(end, std::max(end, offset));
    shift_points(std::span(streams_).subspan(static_cast<std::size_t>(base + begin),
                                             static_cast<std::size_t>(end - begin)),
                 StartPoint);
    ends_.push_back(base + end);
  }
}

void VtkGridReader::read_faces(vtkXMLDataElement* cells) {
  const auto need = [&](const char* name) {
    vtkXMLDataElement* const element = find(cells, name);
    if (element == nullptr)
      throw IoError("array '" + std::string(name) + "' of cells is missing; the file is damaged");
    return element;
  };
  const auto cell_ends = read_offsets(need("polyhedron_offsets"), NumberOfCells[Piece]);
  const auto cell_faces =
      read(need("polyhedron_to_faces"), cell_ends.empty() ? 0 : cell_ends.back());
  std::int64_t n_faces = 0;
  for (const std::int64_t f : cell_faces) n_faces = std::max(n_faces, f + 1);
  const auto face_ends = read_offsets(need("face_offsets"), n_faces);
  const auto points = read(need("face_connectivity"), face_ends.empty() ? 0 : face_ends.back());
  std::vector<unsigned char> n_uses(static_cast<std::size_t>(n_faces), 0);
  std::size_t next = 0;
  for (const std::int64_t end : cell_ends) {
    if (next < static_cast<std::size_t>(end))
      streams_.push_back(end - static_cast<std::int64_t>(next));
    for (; next < static_cast<std::size_t>(end); ++next) {
      const auto f = static_cast<std::size_t>(cell_faces[next]);
      // More uses would make the lists of all cells much longer than the file.
      if (f >= face_ends.size() || ++n_uses[f] > 2)
        throw IoError("face " + std::to_string(cell_faces[next]) +
                      " of the polyhedra does not exist or belongs to more than two cells; the "
                      "file is damaged");
      const std::int64_t begin = f == 0 ? 0 : face_ends[f - 1];
      streams_.push_back(face_ends[f] - begin);
      for (std::int64_t k = begin; k < face_ends[f]; ++k)
        streams_.push_back(points[static_cast<std::size_t>(k)] + StartPoint);
    }
    ends_.push_back(static_cast<std::int64_t>(streams_.size()));
  }
}

}  // namespace carat::detail
