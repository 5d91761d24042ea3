#pragma once
// Polyhedral volume meshes: all faces as one polygon mesh, and cells as lists of faces.

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "carat/base/types.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// What the construction of a polyhedral mesh set right.
struct MeshRepairs {
  std::vector<Index> turned_cells;  ///< given with their faces turned inwards
  std::vector<Index> turned_faces;  ///< did not point from their owner to their neighbour
  /// Faces, as they are numbered now, that were given more than once.
  std::vector<Index> merged_faces;
};

/// An immutable mesh of polyhedra in 3-D.
///
/// Ordinary input: cells of any number of faces, convex or not; faces of any valence, planar or
/// not; several components; vertices without cells; faces without cells. Vertices, faces and cells
/// keep the number and order in which they were given, except for faces that were given twice.
/// Which side of a face a cell lies on is found from the cells' closed surfaces, so the orientation
/// of the input does not matter; a cell that is folded over against its neighbours keeps a
/// negative volume. Copies share the connectivity. Thread-safe.
class PolyhedralMesh {
 public:
  PolyhedralMesh();

  /// \param points  (n, 3) positions                                             [length]
  /// \param faces   face -> vertices, around the face in either direction
  /// \param cells   cell -> faces; faces with the same vertices in the same cycle are merged
  /// \throws InvalidMesh  as PolygonMesh; a face number out of range or twice in a cell; a cell of
  ///                      fewer than 4 faces; a cell that is not closed, or of several parts; a
  ///                      face of more than two cells; two cells on the same side of a face
  /// Cost: O(sizes). The arrays are moved in, not copied.
  PolyhedralMesh(Points points, Csr faces, Csr cells);

  /// From the cells on both sides of every face, as OpenFOAM holds them. Nothing is merged: faces
  /// with the same vertices are the two sides of a baffle.
  /// \param owner      one cell a face
  /// \param neighbour  one cell for each of the first neighbour.size() faces, the inner ones
  static PolyhedralMesh from_owner_neighbour(Points points, Csr faces, std::span<const Index> owner,
                                             std::span<const Index> neighbour);

  /// From what another mesh knows already, as for a part of it: nothing is merged or turned.
  /// \param cells       cell -> faces
  /// \param face_cells  face -> the cells on its sides
  /// \throws InvalidMesh  as the constructor; cells of a face that do not name it
  static PolyhedralMesh from_face_cells(Points points, Csr faces, Csr cells,
                                        Array<FaceCells> face_cells);

  using CellArray =
      Eigen::Ref<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  /// From (n, 4) and (n, 8) arrays of vertices, hexahedra in the order of VTK.
  static PolyhedralMesh from_tets(Points points, const CellArray& tets);
  static PolyhedralMesh from_hexes(Points points, const CellArray& hexes);

  /// The same connectivity at other positions.
  /// \throws InvalidMesh  another number of points, or a coordinate is not finite
  PolyhedralMesh with_points(Points points) const;

  Index n_vertices() const { return face_mesh_.n_vertices(); }
  Index n_edges() const { return face_mesh_.n_edges(); }
  Index n_faces() const { return face_mesh_.n_faces(); }
  Index n_cells() const { return topology_->cells.n_rows(); }

  const Points& points() const { return face_mesh_.points(); }
  Vec3 point(Index v) const { return face_mesh_.point(v); }

  /// All faces as a surface mesh: inner edges have more than two faces. Its corners number the
  /// (face, edge of it) pairs, and so the minimal diamonds.
  const PolygonMesh& face_mesh() const { return face_mesh_; }
  std::span<const Index> face(Index f) const { return face_mesh_.face(f); }
  /// Cell -> faces.
  const Csr& cells() const { return topology_->cells; }
  std::span<const Index> cell(Index c) const { return topology_->cells.row(c); }
  /// Face -> its cells.
  const Array<FaceCells>& face_cells() const { return topology_->face_cells; }

  /// Cell -> its vertices, each once, in the order in which its faces name them. Built on first
  /// use. An entry is a *cell corner*.
  const Csr& cell_vertices() const;
  /// Cell corner -> its cell. Built on first use.
  const Array<Index>& corner_cells() const;
  /// Vertex -> its cell corners, ascending. Built on first use.
  const Csr& vertex_cell_corners() const;

  const MeshRepairs& repairs() const { return topology_->repairs; }

 private:
  friend class CellCollector;
  struct Topology {
    Csr cells;
    Array<FaceCells> face_cells;
    MeshRepairs repairs;
    std::once_flag cell_vertices_once, corner_cells_once, vertex_cell_corners_once;
    Csr cell_vertices;
    Array<Index> corner_cells;
    Csr vertex_cell_corners;
  };
  struct Parts;
  explicit PolyhedralMesh(Parts parts);

  PolygonMesh face_mesh_;
  std::shared_ptr<Topology> topology_;
};

/// Cells by their vertices; the numbers are those of VTK's cell types.
enum class CellType : unsigned char {
  Tetrahedron = 10,
  Voxel = 11,
  Hexahedron = 12,
  Wedge = 13,
  Pyramid = 14,
};

/// Collects cells that are given by their vertices, and numbers their faces.
class CellCollector {
 public:
  /// A cell with the vertices in VTK's order.
  /// \throws InvalidMesh  wrong number of vertices
  void add(CellType type, std::span<const Index> vertices);
  /// A polyhedron: add_face() for each of its faces, then end_cell().
  void add_face(std::span<const Index> vertices);
  void end_cell();

  Index n_cells() const { return faces_of_cells_.n_rows(); }

  /// \throws InvalidMesh  as the constructor of PolyhedralMesh
  PolyhedralMesh build(Points points) &&;

 private:
  Csr faces_;                   // as given, one for every side of a cell
  Csr faces_of_cells_;          // cell -> its entries of faces_
  std::vector<bool> oriented_;  // cell -> its first face was given pointing outwards
};

/// The boundary of a volume mesh, or part of it, as a surface mesh.
struct BoundarySurface {
  PolygonMesh mesh;               ///< faces point out of the volume
  std::vector<Index> vertex_ids;  ///< vertex of the surface -> vertex of the volume, ascending
  std::vector<Index> face_ids;    ///< face of the surface -> face of the volume, ascending
};

/// Faces of exactly one cell. Cost: O(sizes).
BoundarySurface boundary_surface(const PolyhedralMesh& mesh);

/// Whether each vertex lies on a face of exactly one cell.
std::vector<bool> boundary_vertices(const PolyhedralMesh& mesh);

}  // namespace carat
