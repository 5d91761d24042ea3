#pragma once
// Meshes made from meshes.

#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// The dual mesh: one vertex a face (the mean of its vertices), one polygon around each vertex.
///
/// At the boundary the polygon of a vertex is closed by the midpoints of its two boundary edges
/// and the vertex itself, so that the domain stays the same. A vertex that touches several fans
/// of faces gets one polygon a fan. Vertices are numbered: faces, then midpoints of boundary
/// edges by edge, then boundary vertices. Faces are ordered by vertex, then by fan.
/// A polygon of fewer than 3 corners (a closed fan of two faces) is left out.
/// \throws InvalidMesh  edges of more than two faces, or neighbours turned against each other:
///                      their dual is not a polygon mesh; the message names the first edge
PolygonMesh dual_mesh(const PolygonMesh& mesh);

/// The same vertices with every face cut into triangles by diagonals, in the face's mean plane;
/// ear clipping, so non-convex faces stay covered once. Faces that are no simple polygon in that
/// plane are cut as a fan.
/// \param source_faces  if given, receives the original face of every triangle
PolygonMesh triangulate(const PolygonMesh& mesh, std::vector<Index>* source_faces = nullptr);

}  // namespace carat
