#pragma once
// Counts and measures of a surface mesh: what `carat info` prints.

#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// Minimum, mean and maximum of a quantity.
struct Range {
  double min = 0, mean = 0, max = 0;
};

/// What there is to know about a mesh before computing on it.
struct MeshStatistics {
  Index vertices = 0, edges = 0, faces = 0;
  std::vector<Index> faces_of_valence;  ///< [k] = number of faces with k vertices
  Index components = 0;                 ///< connected by shared vertices; unreferenced ones apart
  Index boundary_edges = 0;             ///< edges of exactly one face
  Index boundary_loops = 0;             ///< connected pieces of the boundary
  Index nonmanifold_edges = 0;          ///< edges of more than two faces
  Index nonmanifold_vertices = 0;       ///< vertices whose faces form more than one fan
  Index inconsistent_edges = 0;  ///< edges of two faces that run along them in the same direction
  Index unreferenced_vertices = 0;
  Index nonplanar_faces = 0;       ///< farther than 1e-6 of their diameter from their mean plane
  Index nonconvex_faces = 0;       ///< a reflex corner, seen along their vector area
  Index degenerate_faces = 0;      ///< area <= 1e-13 of their squared diameter
  Index duplicate_faces = 0;       ///< the same vertex set as a face before
  Index dropped_corners = 0;       ///< vertices that repeated their predecessor in a face
  Index euler_characteristic = 0;  ///< V - E + F, without unreferenced vertices
  double area = 0;                 ///< sum of |vector area| of the faces          [length^2]
  double enclosed_volume = 0;      ///< signed; closed consistent meshes only      [length^3]
  bool closed = false;             ///< no boundary edge
  Range edge_length;               ///< [length]
  Range face_area;                 ///< [length^2]
  Range face_quality;  ///< 4 pi area / perimeter^2, over the regular polygon's: 1 is regular
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  ///< bounding box [length]
};

/// Cost: O(corners).
MeshStatistics mesh_statistics(const PolygonMesh& mesh);

/// Vector area of every face, Sum x_i x x_{i+1} / 2, computed about the face's first vertex.
Points face_area_vectors(const PolygonMesh& mesh);

/// Unit normals at the vertices: the mean of the vector areas of their faces. Zero where it
/// vanishes. Orientation is that of the faces.
Points vertex_normals(const PolygonMesh& mesh);

/// Connected components by shared vertices: component number of every vertex, in the order of
/// their first vertex; -1 for vertices without a face.
std::vector<Index> vertex_components(const PolygonMesh& mesh);

/// Whether each vertex lies on a boundary edge (an edge of exactly one face).
std::vector<bool> boundary_vertices(const PolygonMesh& mesh);

}  // namespace carat
