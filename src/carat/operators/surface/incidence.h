#pragma once
// How surface operators hand their mesh to the assembly, which never sees one.

#include "carat/assembly/pattern.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

inline SurfaceIncidence surface_incidence(const PolygonMesh& mesh) {
  return {mesh.faces(), mesh.corner_faces(), mesh.edges().of_corner, mesh.edges().corners,
          mesh.vertex_corners()};
}

}  // namespace carat
