#pragma once
// Meshes to divide, and divisions of them.

#include <cstdint>
#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/mesh/mesh_part.h"
#include "support/meshes.h"
#include "support/volume_meshes.h"

namespace carat::test {

/// All families, jittered, and what is unusual.
inline std::vector<std::pair<std::string, PolygonMesh>> surfaces_to_divide() {
  std::vector<std::pair<std::string, PolygonMesh>> meshes;
  for (const FamilyEntry& family : mesh_families())
    meshes.emplace_back(family.name, family.generate({.level = 1, .jitter = 0.2}));
  for (const NamedMesh& named : unusual_meshes()) meshes.emplace_back(named.name, named.mesh);
  return meshes;
}

inline std::vector<std::pair<std::string, PolyhedralMesh>> volumes_to_divide() {
  std::vector<std::pair<std::string, PolyhedralMesh>> meshes;
  for (const VolumeFamilyEntry& family : volume_families())
    meshes.emplace_back(family.name, family.generate({.level = 0, .jitter = 0.2}));
  for (const NamedVolume& named : unusual_volumes()) meshes.emplace_back(named.name, named.mesh);
  meshes.emplace_back("folded_hexes", folded_hexes());
  return meshes;
}

inline Index n_elements(const PolygonMesh& mesh) { return mesh.n_faces(); }
inline Index n_elements(const PolyhedralMesh& mesh) { return mesh.n_cells(); }
inline Index n_interfaces(const PolygonMesh& mesh) { return mesh.n_edges(); }
inline Index n_interfaces(const PolyhedralMesh& mesh) { return mesh.n_faces(); }

/// A first number of interfaces. In 32 bits, which hold none of these, not even their order is
/// kept.
constexpr std::int64_t kManyInterfaces = (std::int64_t{3} << 31) - 10;

/// The part as it would be if so many interfaces came before those of the mesh.
template <class Mesh>
MeshPart<Mesh> with_first_interface(MeshPart<Mesh> part, std::int64_t first) {
  for (std::int64_t& number : part.numbers.interfaces) number += first;
  return part;
}

/// Blocks of consecutive elements.
inline std::vector<Index> in_blocks(Index n_elements, Index n_parts) {
  std::vector<Index> parts;
  for (Index e = 0; e < n_elements; ++e)
    parts.push_back(static_cast<Index>(std::int64_t{e} * n_parts / n_elements));
  return parts;
}

/// Without any order: parts meet everywhere, halos hold most of the mesh, some parts may be empty.
inline std::vector<Index> scattered(Index n_elements, Index n_parts) {
  std::vector<Index> parts;
  for (Index e = 0; e < n_elements; ++e)
    parts.push_back(static_cast<Index>((std::uint64_t(e) + 1) * 0x9E3779B97F4A7C15 >> 33) %
                    n_parts);
  return parts;
}

/// Calls visit(division) for 1 to 4 parts of either kind.
template <class Mesh, class Visit>
void for_divisions(const Mesh& mesh, const Visit& visit) {
  for (Index n_parts = 1; n_parts <= 4; ++n_parts) {
    visit(divide(mesh, n_parts, in_blocks(n_elements(mesh), n_parts)));
    if (n_parts > 1) visit(divide(mesh, n_parts, scattered(n_elements(mesh), n_parts)));
  }
}

}  // namespace carat::test
