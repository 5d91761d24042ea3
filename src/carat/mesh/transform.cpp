#include "carat/mesh/transform.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/mesh/ear_clipping.h"
#include "carat/mesh/statistics.h"

namespace carat {
namespace {

constexpr std::int64_t kIndexLimit = std::numeric_limits<Index>::max();

// ---- dual ----------------------------------------------------------------------------------

std::string describe_edge(const EdgeTopology& edges, Index e) {
  return "edge " + std::to_string(e) + " (vertices " + std::to_string(edges.vertices[e][0]) + " " +
         std::to_string(edges.vertices[e][1]) + ")";
}

void check_has_dual(const PolygonMesh& mesh) {
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e) {
    const auto sides = edges.corners.row(e);
    if (sides.size() > 2)
      throw InvalidMesh(describe_edge(edges, e) + " belongs to " + std::to_string(sides.size()) +
                            " faces; a dual mesh needs at most 2 an edge: separate the sheets",
                        {e});
    if (sides.size() == 2 && mesh.faces().indices[sides[0]] == mesh.faces().indices[sides[1]])
      throw InvalidMesh(describe_edge(edges, e) + ": faces " +
                            std::to_string(mesh.corner_faces()[sides[0]]) + " and " +
                            std::to_string(mesh.corner_faces()[sides[1]]) +
                            " run along it in the same direction; a dual mesh needs consistently "
                            "oriented faces: turn one of them over",
                        {e});
  }
}

/// Numbers of the dual vertices that come from the boundary; -1 elsewhere.
struct DualNumbering {
  Array<Index> of_edge, of_vertex;
  Index size = 0;
};

DualNumbering number_dual_vertices(const PolygonMesh& mesh) {
  const EdgeTopology& edges = mesh.edges();
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  DualNumbering number;
  number.of_edge.assign(static_cast<std::size_t>(edges.size()), -1);
  number.of_vertex.assign(static_cast<std::size_t>(mesh.n_vertices()), -1);
  std::int64_t size = mesh.n_faces();
  for (Index e = 0; e < edges.size(); ++e)
    if (edges.corners.size(e) == 1) number.of_edge[e] = static_cast<Index>(size++);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[v]) number.of_vertex[v] = static_cast<Index>(size++);
  if (size > kIndexLimit)
    throw InvalidMesh("the dual mesh would have " + std::to_string(size) + " vertices: at most " +
                      std::to_string(kIndexLimit) + " are supported; split the mesh");
  number.size = static_cast<Index>(size);
  return number;
}

Points dual_points(const PolygonMesh& mesh, const DualNumbering& number) {
  Points points(number.size, 3);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    // About the first vertex, so that the mean keeps its digits far from the origin.
    const Vec3 origin = mesh.point(mesh.face(f)[0]);
    Vec3 sum = Vec3::Zero();
    for (const Index v : mesh.face(f)) sum += mesh.point(v) - origin;
    points.row(f) = (origin + sum / static_cast<double>(mesh.face(f).size())).transpose();
  }
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e)
    if (number.of_edge[e] >= 0)
      points.row(number.of_edge[e]) =
          mesh.points().row(edges.vertices[e][0]) / 2 + mesh.points().row(edges.vertices[e][1]) / 2;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (number.of_vertex[v] >= 0) points.row(number.of_vertex[v]) = mesh.points().row(v);
  return points;
}

/// Walks from face to face around a vertex, for consistently oriented meshes.
class FanWalk {
 public:
  explicit FanWalk(const PolygonMesh& mesh)
      : mesh_(mesh), edges_(mesh.edges()), corner_faces_(mesh.corner_faces()) {}

  Index face(Index corner) const { return corner_faces_[corner]; }
  Index outgoing_edge(Index corner) const { return edges_.of_corner[corner]; }
  Index incoming_edge(Index corner) const { return edges_.of_corner[previous(corner)]; }
  /// Next corner of the same vertex counter-clockwise; -1 behind the last one of an open fan.
  Index after(Index corner) const { return other_side(previous(corner)); }
  /// Next corner of the same vertex clockwise; -1 before the first one of an open fan.
  Index before(Index corner) const {
    const Index other = other_side(corner);
    return other < 0 ? -1 : mesh_.next_corner(face(other), other);
  }

 private:
  Index previous(Index corner) const {
    const Index f = corner_faces_[corner];
    return corner == mesh_.faces().begin(f) ? mesh_.faces().end(f) - 1 : corner - 1;
  }
  Index other_side(Index corner) const {
    const auto sides = edges_.corners.row(edges_.of_corner[corner]);
    if (sides.size() == 1) return -1;
    return sides[0] == corner ? sides[1] : sides[0];
  }

  const PolygonMesh& mesh_;
  const EdgeTopology& edges_;
  const Array<Index>& corner_faces_;
};

bool has_three_distinct(std::span<const Index> polygon) {
  const auto second =
      std::find_if(polygon.begin(), polygon.end(), [&](Index v) { return v != polygon.front(); });
  return std::any_of(second, polygon.end(),
                     [&](Index v) { return v != polygon.front() && v != *second; });
}

Csr dual_faces(const PolygonMesh& mesh, const DualNumbering& number) {
  const FanWalk walk(mesh);
  std::vector<bool> visited(static_cast<std::size_t>(mesh.n_corners()), false);
  Csr faces;
  faces.offsets.reserve(static_cast<std::size_t>(mesh.n_vertices()) + 1);
  faces.indices.reserve(static_cast<std::size_t>(mesh.n_corners()));
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (const Index corner : mesh.vertex_corners().row(v)) {
      if (visited[corner]) continue;
      Index first = corner;
      while (walk.before(first) >= 0) {
        first = walk.before(first);
        if (first == corner) break;
      }
      const bool open = walk.before(first) < 0;
      if (open) {
        faces.indices.push_back(number.of_vertex[v]);
        faces.indices.push_back(number.of_edge[walk.outgoing_edge(first)]);
      }
      Index last = first;
      for (Index c = first; c >= 0 && !visited[c]; c = walk.after(c)) {
        visited[c] = true;
        faces.indices.push_back(walk.face(c));
        last = c;
      }
      if (open) faces.indices.push_back(number.of_edge[walk.incoming_edge(last)]);
      const auto begin = static_cast<std::size_t>(faces.offsets.back());
      if (has_three_distinct({faces.indices.data() + begin, faces.indices.size() - begin}))
        faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
      else
        faces.indices.resize(begin);
    }
  return faces;
}

// ---- triangles -----------------------------------------------------------------------------

/// Positions of a face's vertices in its mean plane, about its first vertex, with extent 1.
/// \return false  the face has no mean plane
bool project_face(const PolygonMesh& mesh, std::span<const Index> face, const Vec3& area_vector,
                  std::vector<Vec2>& projected) {
  const double area = area_vector.norm();
  if (!(area > 0)) return false;
  const Vec3 normal = area_vector / area;
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 u = normal.cross(Vec3::Unit(axis)).normalized();
  const Vec3 w = normal.cross(u);
  projected.clear();
  double extent = 0;
  for (const Index v : face) {
    const Vec3 x = mesh.point(v) - mesh.point(face[0]);
    projected.emplace_back(x.dot(u), x.dot(w));
    extent = std::max(extent, projected.back().cwiseAbs().maxCoeff());
  }
  for (Vec2& x : projected) x /= extent;
  return true;
}

double signed_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) / 2;
}

/// Whether a quad is cut from its corner 0 to 2 rather than from 1 to 3: the diagonal inside, else
/// the shorter one, else the one at the lowest vertex number; whichever corner comes first.
bool cut_at_first_corner(const PolygonMesh& mesh, std::span<const Index> quad,
                         const std::vector<Vec2>& x) {
  const double even = std::min(signed_area(x[0], x[1], x[2]), signed_area(x[0], x[2], x[3]));
  const double odd = std::min(signed_area(x[1], x[2], x[3]), signed_area(x[1], x[3], x[0]));
  constexpr double kFlat = 1e-10;  // of the unit extent: a corner that is straight to rounding
  if ((even > kFlat) != (odd > kFlat)) return even > kFlat;
  const double length_02 = (mesh.point(quad[2]) - mesh.point(quad[0])).norm();
  const double length_13 = (mesh.point(quad[3]) - mesh.point(quad[1])).norm();
  constexpr double kTie = 1e-9;  // rounding must not decide between equal diagonals
  if (std::abs(length_02 - length_13) > kTie * (length_02 + length_13))
    return length_02 < length_13;
  return std::min(quad[0], quad[2]) < std::min(quad[1], quad[3]);
}

class TriangleList {
 public:
  TriangleList(Index n_triangles, std::vector<Index>* source_faces) : source_faces_(source_faces) {
    faces_.indices.reserve(3 * static_cast<std::size_t>(n_triangles));
    faces_.offsets.reserve(static_cast<std::size_t>(n_triangles) + 1);
    if (source_faces_ != nullptr) {
      source_faces_->clear();
      source_faces_->reserve(static_cast<std::size_t>(n_triangles));
    }
  }
  /// Leaves out what has fewer than 3 distinct vertices, from faces that visit a vertex twice.
  void add(Index source, Index a, Index b, Index c) {
    if (a == b || b == c || c == a) return;
    faces_.indices.insert(faces_.indices.end(), {a, b, c});
    faces_.offsets.push_back(static_cast<Index>(faces_.indices.size()));
    if (source_faces_ != nullptr) source_faces_->push_back(source);
  }
  Csr take() { return std::move(faces_); }

 private:
  Csr faces_;
  std::vector<Index>* source_faces_;
};

}  // namespace

PolygonMesh dual_mesh(const PolygonMesh& mesh) {
  check_has_dual(mesh);
  const DualNumbering number = number_dual_vertices(mesh);
  return PolygonMesh(dual_points(mesh, number), dual_faces(mesh, number));
}

PolygonMesh triangulate(const PolygonMesh& mesh, std::vector<Index>* source_faces) {
  const std::int64_t n_triangles = mesh.n_corners() - 2 * static_cast<std::int64_t>(mesh.n_faces());
  if (3 * n_triangles > kIndexLimit)
    throw InvalidMesh(std::to_string(n_triangles) + " triangles have more than " +
                      std::to_string(kIndexLimit) + " corners; split the mesh");
  TriangleList triangles(static_cast<Index>(n_triangles), source_faces);
  EarClipper clipper;
  std::vector<Vec2> projected;
  const Points area_vectors = face_area_vectors(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    const bool has_plane =
        face.size() > 3 && project_face(mesh, face, area_vectors.row(f).transpose(), projected);
    if (has_plane && face.size() == 4) {
      const std::size_t start = cut_at_first_corner(mesh, face, projected) ? 0 : 1;
      triangles.add(f, face[start], face[start + 1], face[start + 2]);
      triangles.add(f, face[start], face[start + 2], face[(start + 3) % 4]);
      continue;
    }
    if (has_plane) {
      const auto& cut = clipper.cut(projected);
      for (const auto& [a, b, c] : cut) triangles.add(f, face[a], face[b], face[c]);
      if (!cut.empty()) continue;
    }
    for (std::size_t i = 2; i < face.size(); ++i) triangles.add(f, face[0], face[i - 1], face[i]);
  }
  return PolygonMesh(mesh.points(), triangles.take());
}

}  // namespace carat
