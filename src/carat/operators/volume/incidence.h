#pragma once
// How volume operators hand their mesh to the assembly, which never sees one.

#include "carat/assembly/volume_pattern.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

inline VolumeIncidence volume_incidence(const PolyhedralMesh& mesh) {
  return {mesh.face_mesh().faces(), mesh.cells(),        mesh.face_cells(),
          mesh.cell_vertices(),     mesh.corner_cells(), mesh.vertex_cell_corners()};
}

}  // namespace carat
