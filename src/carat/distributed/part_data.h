#pragma once
// A part of a mesh with what came with the mesh.

#include <variant>
#include <vector>

#include "carat/io/mesh_file.h"
#include "carat/mesh/mesh_part.h"

namespace carat {

/// A part with the fields of its vertices and elements, those of the halo too.
template <class Mesh>
struct PartData {
  MeshPart<Mesh> part;
  MeshFields fields;
  /// Volumes: all patches of the whole mesh in its order, with the faces that the part has of them.
  std::vector<BoundaryPatch> patches;
};

/// A part of a mesh with what belongs to it. Cost: that of the part, and the patches' of the mesh.
PartData<PolygonMesh> part_data_of(const SurfaceData& data, const MeshDivision& division,
                                   Index part);
PartData<PolyhedralMesh> part_data_of(const VolumeData& data, const MeshDivision& division,
                                      Index part);

using AnyPartData = std::variant<PartData<PolygonMesh>, PartData<PolyhedralMesh>>;

}  // namespace carat
