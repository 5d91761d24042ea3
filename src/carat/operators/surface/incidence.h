#pragma once
// How surface operators hand their mesh to the assembly, which never sees one.

#include "carat/assembly/pattern.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// \param threads  for what the mesh has not derived yet; 0: all the machine has
inline SurfaceIncidence surface_incidence(const PolygonMesh& mesh, int threads = 1) {
  const EdgeTopology& edges = mesh.edges(threads);
  return {mesh.faces(), mesh.corner_faces(), edges.of_corner, edges.corners,
          mesh.vertex_corners(threads)};
}

}  // namespace carat
