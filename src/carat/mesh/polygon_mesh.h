#pragma once
// Polygonal surface meshes: compact arrays, no half-edges, no assumption of manifoldness.

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// The edges of a polygon mesh. A *corner* is one entry of the face lists; it stands for a face,
/// one of its vertices, and the face's side from that vertex to the next one.
struct EdgeTopology {
  /// End points of every edge, lower number first; edges sorted by (first, second).
  Array<std::array<Index, 2>> vertices;
  /// Edge -> corners whose side it is, ascending: 1 on the boundary, 2 inside, more where
  /// the mesh is not manifold.
  Csr corners;
  /// Corner -> its edge.
  Array<Index> of_corner;

  Index size() const { return static_cast<Index>(vertices.size()); }
};

/// An immutable polygonal surface mesh in 3-D.
///
/// Ordinary input: faces of any valence >= 3, planar or not, convex or not; boundaries; several
/// components; edges of more than two faces; faces turned against each other; vertices without
/// faces. Vertices and faces keep the number and order in which they were given.
/// Copies share the connectivity. Thread-safe.
class PolygonMesh {
 public:
  PolygonMesh();

  /// \param points  (n, 3) positions                                             [length]
  /// \param faces   vertex numbers, 0-based; a vertex repeated right after itself is dropped
  /// \throws InvalidMesh  a coordinate is not finite; a number is out of range; a face has fewer
  ///                      than 3 distinct vertices; offsets that do not ascend; 2^31 corners
  /// Cost: O(vertices + corners). The arrays are moved in, not copied.
  PolygonMesh(Points points, Csr faces);

  /// From one list of vertex numbers a face. Errors as above.
  static PolygonMesh from_faces(Points points, const std::vector<std::vector<Index>>& faces);

  /// From a (faces, k) array, rows filled up with -1 behind the last vertex. Errors as above.
  static PolygonMesh from_padded(
      Points points,
      const Eigen::Ref<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
          faces);

  /// The same connectivity at other positions.
  /// \throws InvalidMesh  another number of points, or a coordinate is not finite
  PolygonMesh with_points(Points points) const;

  Index n_vertices() const { return static_cast<Index>(points_.rows()); }
  Index n_faces() const { return topology_->faces.n_rows(); }
  Index n_corners() const { return static_cast<Index>(topology_->faces.indices.size()); }
  Index n_edges() const { return edges().size(); }

  const Points& points() const { return points_; }
  Vec3 point(Index v) const { return points_.row(v).transpose(); }

  /// Face -> vertices, in the order around the face.
  const Csr& faces() const { return topology_->faces; }
  std::span<const Index> face(Index f) const { return topology_->faces.row(f); }

  /// Number of repeated vertices (the same twice in a row) that were dropped on construction.
  Index n_dropped_corners() const { return topology_->n_dropped_corners; }

  /// Corner -> its face. Built on first use, O(corners).
  const Array<Index>& corner_faces() const;
  /// Vertex -> its corners, ascending. Built on first use, O(corners).
  /// \param threads  0: all the machine has. The result does not depend on it.
  const Csr& vertex_corners(int threads = 1) const;
  /// Edges and their sides. Built on first use, O(corners) by counting. Threads likewise.
  const EdgeTopology& edges(int threads = 1) const;

  /// The corner that follows `corner` around its face `f`.
  Index next_corner(Index f, Index corner) const {
    return corner + 1 == faces().end(f) ? faces().begin(f) : corner + 1;
  }

 private:
  struct Topology {
    Csr faces;
    Index n_dropped_corners = 0;
    std::once_flag corner_faces_once, vertex_corners_once, edges_once;
    Array<Index> corner_faces;
    Csr vertex_corners;
    EdgeTopology edges;
  };
  Points points_;
  std::shared_ptr<Topology> topology_;
};

}  // namespace carat
