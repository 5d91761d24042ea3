#pragma once
// A piece of a mesh, as one of several files holds it.

#include <cstdint>
#include <variant>
#include <vector>

#include "carat/io/mesh_file.h"

namespace carat {

/// Some elements of a mesh with their vertices. Every element is in one piece; vertices, and the
/// interfaces where pieces meet, are in several. Numbers in the whole mesh say which are the same.
/// They need not be dense: only their order counts. Empty lists: not known.
template <class Mesh>
struct MeshPiece {
  Mesh mesh;
  std::vector<std::int64_t> vertex_ids, element_ids;
  std::vector<std::int64_t> interface_ids;  ///< of volumes' faces; surfaces have none
  MeshFields fields;
  std::vector<BoundaryPatch> patches;  ///< of volumes
};

using AnyMeshPiece = std::variant<MeshPiece<PolygonMesh>, MeshPiece<PolyhedralMesh>>;

}  // namespace carat
