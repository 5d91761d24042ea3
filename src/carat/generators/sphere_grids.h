#pragma once
// Platonic solids subdivided and blown up to the unit sphere.

#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// Every face of the icosahedron in n * n triangles.
PolygonMesh icosahedral_triangles(Index n);

/// Every face of the cube in n * n quads, equiangular; faces patch by patch, row by row.
PolygonMesh cubed_sphere_quads(Index n);

}  // namespace carat
