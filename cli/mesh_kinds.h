#pragma once
// What commands need to know of surfaces and volumes to treat both alike.

#include <span>
#include <string>
#include <vector>

#include "carat/io/mesh_file.h"
#include "carat/operators/registry.h"
#include "carat/solve/spd_solver.h"
#include "cli/session.h"

namespace carat::cli {

/// The words for a kind of mesh. Elements are what cells of a volume and faces of a surface are;
/// sides, the pieces of the boundary, are faces or edges.
struct KindWords {
  const char* name;     ///< "surface"
  const char* plural;   ///< "surfaces", for lists
  const char* element;  ///< "face"
  const char* side;     ///< "edge"
  const char* measure;  ///< "area"
};

inline constexpr KindWords kSurfaceWords{"surface", "surfaces", "face", "edge", "area"};
inline constexpr KindWords kVolumeWords{"volume", "volumes", "cell", "face", "volume"};

inline const KindWords& words(const PolygonMesh&) { return kSurfaceWords; }
inline const KindWords& words(const PolyhedralMesh&) { return kVolumeWords; }

inline int dimension(const PolygonMesh&) { return 2; }
inline int dimension(const PolyhedralMesh&) { return 3; }

inline Index n_elements(const PolygonMesh& mesh) { return mesh.n_faces(); }
inline Index n_elements(const PolyhedralMesh& mesh) { return mesh.n_cells(); }

inline std::vector<Field>& element_fields(SurfaceData& data) { return data.fields.face; }
inline std::vector<Field>& element_fields(VolumeData& data) { return data.fields.cell; }

inline const std::vector<const SurfaceOperator*>& operators_of(const PolygonMesh&) {
  return surface_operators();
}
inline const std::vector<const VolumeOperator*>& operators_of(const PolyhedralMesh&) {
  return volume_operators();
}

/// Named parts of the boundary; surfaces have none.
inline std::span<const BoundaryPatch> patches(const SurfaceData&) { return {}; }
inline std::span<const BoundaryPatch> patches(const VolumeData& data) { return data.patches; }

/// How large a mesh is.
struct MeshSizes {
  std::int64_t vertices = 0, edges = 0, faces = 0, corners = 0, cells = -1;  ///< surfaces: no cells

  MeshSizes() = default;
  MeshSizes(const PolygonMesh& mesh)
      : vertices(mesh.n_vertices()),
        edges(mesh.n_edges()),
        faces(mesh.n_faces()),
        corners(mesh.n_corners()) {}
  MeshSizes(const PolyhedralMesh& mesh) : MeshSizes(mesh.face_mesh()) { cells = mesh.n_cells(); }
};

/// "12 vertices, 30 edges, 20 faces", of volumes also the cells.
std::string describe_sizes(const MeshSizes& sizes);

/// The same as an object for JSON.
Json sizes_to_json(const MeshSizes& sizes);

/// A side of the boundary with its vertices and its centre.
struct BoundarySide {
  Index id;
  std::span<const Index> vertices;
  Vec3 centre;
};
/// Midpoint of an edge.
BoundarySide boundary_side(const PolygonMesh& mesh, Index edge);
/// Centroid of a face, by the area of its triangles about the mean of its vertices.
BoundarySide boundary_side(const PolyhedralMesh& mesh, Index face);

/// The same mesh without the connectivity that has been derived so far: what has to derive it pays.
PolygonMesh underived(const PolygonMesh& mesh);
PolyhedralMesh underived(const PolyhedralMesh& mesh);

/// What the symbolic phase has to move at least: connectivity, and the columns of every matrix.
double symbolic_bytes(const PolygonMesh& mesh, const Discretization& discretization);
double symbolic_bytes(const PolyhedralMesh& mesh, const Discretization& discretization);
/// What the numeric phase has to move at least: points and connectivity once, of every matrix the
/// columns read and the values written, or what products read in its place.
double assembly_bytes(const PolygonMesh& mesh, const Discretization& discretization);
double assembly_bytes(const PolyhedralMesh& mesh, const Discretization& discretization);
/// What setting a solver up has to write at least: its factor or preconditioner.
double setup_bytes(const SolverInfo& solver);

/// Edges of one face, faces of one cell; ascending.
std::vector<Index> boundary_sides(const PolygonMesh& mesh);
std::vector<Index> boundary_sides(const PolyhedralMesh& mesh);

}  // namespace carat::cli
