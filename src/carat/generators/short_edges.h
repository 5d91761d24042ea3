#pragma once
// Volume meshes without short edges.

#include "carat/generators/volume_domain.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// Merges vertices that edges shorter than `length` connect, and drops the faces that become flat.
/// Vertices on the border stay there. Not merged is what would break a cell or invert one.
PolyhedralMesh merge_short_edges(const PolyhedralMesh& mesh, const VolumeDomain& domain,
                                 double length);

}  // namespace carat
