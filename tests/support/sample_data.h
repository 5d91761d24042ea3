#pragma once
// Fields and patches for any mesh.

#include <cmath>
#include <type_traits>

#include "carat/io/mesh_file.h"
#include "support/mesh_parts.h"

namespace carat::test {

/// Fields of the whole mesh.
template <class Mesh>
MeshFields sample_fields(const Mesh& mesh) {
  const auto make = [](const char* name, Index components, Index rows, double seed) {
    Field field{name, components, {}};
    for (Index i = 0; i < rows * components; ++i) field.values.push_back(std::sin(seed * (i + 1)));
    return field;
  };
  MeshFields fields;
  fields.vertex = {make("height", 1, mesh.n_vertices(), 0.7),
                   make("velocity", 3, mesh.n_vertices(), 1.3)};
  std::vector<Field>& of_elements = std::is_same_v<Mesh, PolygonMesh> ? fields.face : fields.cell;
  of_elements = {make("tensor", 9, n_elements(mesh), 0.3)};
  return fields;
}

inline std::vector<BoundaryPatch> sample_patches(const PolygonMesh&) { return {}; }
inline std::vector<BoundaryPatch> sample_patches(const PolyhedralMesh& mesh) {
  std::vector<BoundaryPatch> patches{
      {"inlet", "patch", {}}, {"none", "", {}}, {"walls", "wall", {}}};
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[f].boundary()) {
      patches[f % 3 == 0 ? 0 : 2].faces.push_back(f);
      if (f % 6 == 0) patches[2].faces.push_back(f);
    }
  return patches;
}

inline SurfaceData sample_data(const PolygonMesh& mesh) { return {mesh, sample_fields(mesh)}; }
inline VolumeData sample_data(const PolyhedralMesh& mesh) {
  return {mesh, sample_fields(mesh), sample_patches(mesh)};
}

}  // namespace carat::test
