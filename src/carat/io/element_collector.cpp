#include "carat/io/element_collector.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

/// A face of three or four vertices, whatever its direction and start.
struct FaceKey {
  std::array<Index, 4> vertices;
  Index face;

  FaceKey(std::span<const Index> corners, Index number) : vertices{-1, -1, -1, -1}, face(number) {
    std::copy(corners.begin(), corners.end(), vertices.begin());
    std::sort(vertices.begin(), vertices.end());
  }
  friend bool operator<(const FaceKey& a, const FaceKey& b) { return a.vertices < b.vertices; }
};

bool of_standard_shape(std::span<const Index> face) { return face.size() == 3 || face.size() == 4; }

std::vector<Field> group_field(const char* name, const std::vector<std::int64_t>& groups) {
  const bool one =
      std::adjacent_find(groups.begin(), groups.end(), std::not_equal_to<>()) == groups.end();
  if (one) return {};
  return {{name, 1, {groups.begin(), groups.end()}}};
}

CellType cell_type(ElementShape shape) {
  switch (shape) {
    case ElementShape::Tetrahedron:
      return CellType::Tetrahedron;
    case ElementShape::Hexahedron:
      return CellType::Hexahedron;
    case ElementShape::Wedge:
      return CellType::Wedge;
    default:
      return CellType::Pyramid;
  }
}

}  // namespace

std::size_t n_vertices_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::Triangle:
      return 3;
    case ElementShape::Quadrilateral:
    case ElementShape::Tetrahedron:
      return 4;
    case ElementShape::Hexahedron:
      return 8;
    case ElementShape::Wedge:
      return 6;
    default:
      return 5;
  }
}

void ElementCollector::add(ElementShape shape, std::span<const std::int64_t> vertices,
                           std::int64_t group) {
  if (shape == ElementShape::Triangle || shape == ElementShape::Quadrilateral) {
    for (const std::int64_t v : vertices) faces_.add_corner(v);
    faces_.end_face();
    face_groups_.push_back(group);
    return;
  }
  for (const std::int64_t v : vertices)
    if (v < 0 || v > std::numeric_limits<Index>::max())
      throw InvalidMesh("cell " + std::to_string(cells_.n_cells()) + ": vertex " +
                            std::to_string(v) + " does not exist",
                        {cells_.n_cells()});
  scratch_.assign(vertices.begin(), vertices.end());
  cells_.add(cell_type(shape), scratch_);
  cell_groups_.push_back(group);
}

std::vector<BoundaryPatch> ElementCollector::patches(
    const PolyhedralMesh& mesh,
    const std::function<std::string(std::int64_t group)>& name_of_patch) const {
  std::vector<FaceKey> boundary;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[static_cast<std::size_t>(f)].boundary() &&
        of_standard_shape(mesh.face(f)))
      boundary.emplace_back(mesh.face(f), f);
  std::sort(boundary.begin(), boundary.end());
  std::map<std::int64_t, BoundaryPatch> by_group;
  for (Index e = 0; e < faces_.size(); ++e) {
    const std::int64_t group = face_groups_[static_cast<std::size_t>(e)];
    if (group == 0) continue;
    const FaceKey key(faces_.faces().row(e), -1);
    const auto at = std::lower_bound(boundary.begin(), boundary.end(), key);
    if (at != boundary.end() && at->vertices == key.vertices)
      by_group[group].faces.push_back(at->face);
  }
  std::vector<BoundaryPatch> result;
  for (auto& [group, patch] : by_group) {
    patch.name = name_of_patch(group);
    std::sort(patch.faces.begin(), patch.faces.end());
    patch.faces.erase(std::unique(patch.faces.begin(), patch.faces.end()), patch.faces.end());
    result.push_back(std::move(patch));
  }
  return result;
}

MeshData ElementCollector::build(
    Points points, const char* field_name,
    const std::function<std::string(std::int64_t group)>& name_of_patch) {
  if (cell_groups_.empty())
    return SurfaceData{faces_.build(std::move(points)),
                       {{}, group_field(field_name, face_groups_)}};
  VolumeData data{std::move(cells_).build(std::move(points)), {}};
  data.fields.cell = group_field(field_name, cell_groups_);
  data.patches = patches(data.mesh, name_of_patch);
  return data;
}

}  // namespace carat::detail
