#include "carat/distributed/part_data.h"

namespace carat {
namespace {

std::vector<Field> select(const std::vector<Field>& fields, const Array<Index>& rows) {
  std::vector<Field> selected;
  for (const Field& field : fields) {
    selected.push_back({field.name, field.components, {}});
    std::vector<double>& values = selected.back().values;
    values.reserve(rows.size() * static_cast<std::size_t>(field.components));
    for (const Index row : rows) {
      const auto first = field.values.begin() + static_cast<std::ptrdiff_t>(row) * field.components;
      values.insert(values.end(), first, first + field.components);
    }
  }
  return selected;
}

}  // namespace

PartData<PolygonMesh> part_data_of(const SurfaceData& data, const MeshDivision& division,
                                   Index part) {
  PartData<PolygonMesh> result;
  result.part = part_of(data.mesh, division, part);
  result.fields.vertex = select(data.fields.vertex, result.part.numbers.vertices);
  result.fields.face = select(data.fields.face, result.part.numbers.elements);
  return result;
}

PartData<PolyhedralMesh> part_data_of(const VolumeData& data, const MeshDivision& division,
                                      Index part) {
  PartData<PolyhedralMesh> result;
  result.part = part_of(data.mesh, division, part);
  const PartNumbers& numbers = result.part.numbers;
  result.fields.vertex = select(data.fields.vertex, numbers.vertices);
  result.fields.cell = select(data.fields.cell, numbers.elements);
  for (const BoundaryPatch& patch : data.patches) {
    result.patches.push_back({patch.name, patch.type, {}});
    // Both ascend.
    std::size_t at = 0;
    for (const Index f : patch.faces) {
      while (at < numbers.interfaces.size() && numbers.interfaces[at] < f) ++at;
      if (at < numbers.interfaces.size() && numbers.interfaces[at] == f)
        result.patches.back().faces.push_back(static_cast<Index>(at));
    }
  }
  return result;
}

}  // namespace carat
