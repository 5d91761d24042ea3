#include "carat/mesh/statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "carat/mesh/accumulate.h"

namespace carat {
namespace {

using detail::DisjointSets;
using detail::RangeOf;
using detail::Sum;

constexpr double kPlanarity = 1e-6;   // distance from the mean plane over the diameter
constexpr double kReflexSine = 1e-6;  // below it a corner counts as straight
constexpr double kFlatFace = 1e-13;   // area over the squared diameter
constexpr double kVanishing = 1e-13;  // sum of vector areas over the sum of their norms

DisjointSets join_face_vertices(const PolygonMesh& mesh) {
  DisjointSets sets(mesh.n_vertices());
  for (Index f = 0; f < mesh.n_faces(); ++f)
    for (const Index v : mesh.face(f)) sets.join(mesh.face(f)[0], v);
  return sets;
}

Vec3 face_area_vector(const PolygonMesh& mesh, std::span<const Index> face) {
  const Vec3 origin = mesh.point(face[0]);
  Vec3 twice = Vec3::Zero();
  Vec3 previous = mesh.point(face[1]) - origin;
  for (std::size_t i = 2; i < face.size(); ++i) {
    const Vec3 next = mesh.point(face[i]) - origin;
    twice += previous.cross(next);
    previous = next;
  }
  return twice / 2;
}

/// The mean is taken about the first vertex, so that it keeps its digits far from the origin.
Vec3 face_mean(const PolygonMesh& mesh, std::span<const Index> face) {
  const Vec3 origin = mesh.point(face[0]);
  Vec3 sum = Vec3::Zero();
  for (const Index v : face) sum += mesh.point(v) - origin;
  return origin + sum / static_cast<double>(face.size());
}

bool has_reflex_corner(const PolygonMesh& mesh, std::span<const Index> face, const Vec3& normal) {
  const auto in_plane = [&](std::size_t from, std::size_t to) -> Vec3 {
    const Vec3 side = mesh.point(face[to]) - mesh.point(face[from]);
    return side - side.dot(normal) * normal;
  };
  Vec3 incoming = in_plane(face.size() - 1, 0);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 outgoing = in_plane(i, i + 1 == face.size() ? 0 : i + 1);
    if (incoming.cross(outgoing).dot(normal) < -kReflexSine * incoming.norm() * outgoing.norm())
      return true;
    incoming = outgoing;
  }
  return false;
}

void measure_faces(const PolygonMesh& mesh, MeshStatistics& s) {
  RangeOf areas, qualities;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    const double n = static_cast<double>(face.size());
    if (s.faces_of_valence.size() <= face.size()) s.faces_of_valence.resize(face.size() + 1, 0);
    ++s.faces_of_valence[face.size()];

    const Vec3 area_vector = face_area_vector(mesh, face);
    const Vec3 mean = face_mean(mesh, face);
    const double area = area_vector.norm();
    double radius = 0, perimeter = 0;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 x = mesh.point(face[i]);
      radius = std::max(radius, (x - mean).norm());
      perimeter += (mesh.point(face[i + 1 == face.size() ? 0 : i + 1]) - x).norm();
    }
    const double diameter = 2 * radius;
    areas.add(area);
    qualities.add(perimeter > 0
                      ? 4 * (area / perimeter / perimeter) * n * std::tan(std::numbers::pi / n)
                      : 0);
    if (area <= kFlatFace * diameter * diameter) {
      ++s.degenerate_faces;
      continue;
    }
    if (face.size() == 3) continue;
    const Vec3 normal = area_vector / area;
    double height = 0;
    for (const Index v : face)
      height = std::max(height, std::abs(normal.dot(mesh.point(v) - mean)));
    if (height > kPlanarity * diameter) ++s.nonplanar_faces;
    if (has_reflex_corner(mesh, face, normal)) ++s.nonconvex_faces;
  }
  s.area = areas.sum();
  s.face_area = areas.range();
  s.face_quality = qualities.range();
}

/// \return whether every edge is run along as often in one direction as in the other
bool measure_edges(const PolygonMesh& mesh, MeshStatistics& s) {
  const EdgeTopology& edges = mesh.edges();
  RangeOf lengths;
  DisjointSets boundary(mesh.n_vertices());
  Array<Index> boundary_ends;
  bool balanced = true;
  for (Index e = 0; e < edges.size(); ++e) {
    const auto [first, second] = edges.vertices[e];
    lengths.add((mesh.point(second) - mesh.point(first)).norm());
    Index forward = 0;
    for (const Index corner : edges.corners.row(e))
      forward += mesh.faces().indices[corner] == first ? 1 : 0;
    const Index sides = edges.corners.size(e);
    balanced = balanced && 2 * static_cast<std::int64_t>(forward) == sides;
    if (sides == 2 && forward != 1) ++s.inconsistent_edges;
    if (sides > 2) ++s.nonmanifold_edges;
    if (sides == 1) {
      ++s.boundary_edges;
      boundary.join(first, second);
      boundary_ends.push_back(first);
    }
  }
  // A piece is counted at its lowest vertex, which is the lower end of one of its edges.
  std::sort(boundary_ends.begin(), boundary_ends.end());
  boundary_ends.erase(std::unique(boundary_ends.begin(), boundary_ends.end()), boundary_ends.end());
  for (const Index v : boundary_ends) s.boundary_loops += boundary.root(v) == v ? 1 : 0;
  s.edge_length = lengths.range();
  return balanced;
}

Index count_nonmanifold_vertices(const PolygonMesh& mesh) {
  const EdgeTopology& edges = mesh.edges();
  const Array<Index>& corner_faces = mesh.corner_faces();
  DisjointSets fans(mesh.n_corners());
  for (Index e = 0; e < edges.size(); ++e) {
    Index at_first = -1, at_second = -1;
    for (const Index side : edges.corners.row(e)) {
      Index here = side, there = mesh.next_corner(corner_faces[side], side);
      if (mesh.faces().indices[here] != edges.vertices[e][0]) std::swap(here, there);
      if (at_first >= 0) {
        fans.join(at_first, here);
        fans.join(at_second, there);
      }
      at_first = here;
      at_second = there;
    }
  }
  Index count = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const auto corners = mesh.vertex_corners().row(v);
    count += std::any_of(corners.begin(), corners.end(),
                         [&](Index corner) { return fans.root(corner) != fans.root(corners[0]); });
  }
  return count;
}

/// Faces are compared as sorted vertex sets, only with those of the same lowest vertex.
Index count_duplicate_faces(const PolygonMesh& mesh) {
  const Csr& faces = mesh.faces();
  Array<Index> sorted(faces.indices.begin(), faces.indices.end());
  Array<Index> set_size(static_cast<std::size_t>(mesh.n_faces()));
  Array<Index> start(static_cast<std::size_t>(mesh.n_vertices()) + 1, 0);
  const auto begin_of = [&](Index f) { return sorted.data() + faces.begin(f); };
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    Index* const begin = begin_of(f);
    std::sort(begin, begin + faces.size(f));
    set_size[f] = static_cast<Index>(std::unique(begin, begin + faces.size(f)) - begin);
    ++start[*begin + 1];
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v) start[v + 1] += start[v];
  Array<Index> order(static_cast<std::size_t>(mesh.n_faces()));
  Array<Index> next(start.begin(), start.end() - 1);
  for (Index f = 0; f < mesh.n_faces(); ++f) order[next[*begin_of(f)]++] = f;

  const auto before = [&](Index f, Index g) {
    return std::lexicographical_compare(begin_of(f), begin_of(f) + set_size[f], begin_of(g),
                                        begin_of(g) + set_size[g]);
  };
  Index count = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    Index* const first = order.data() + start[v];
    Index* const last = order.data() + start[v + 1];
    std::sort(first, last, before);
    for (const Index* f = first; last - f > 1; ++f) count += before(f[0], f[1]) ? 0 : 1;
  }
  return count;
}

}  // namespace

MeshStatistics mesh_statistics(const PolygonMesh& mesh) {
  MeshStatistics s;
  s.vertices = mesh.n_vertices();
  s.edges = mesh.n_edges();
  s.faces = mesh.n_faces();
  s.dropped_corners = mesh.n_dropped_corners();
  if (s.vertices > 0) {
    s.lower = mesh.points().colwise().minCoeff().transpose();
    s.upper = mesh.points().colwise().maxCoeff().transpose();
  }
  for (const Index component : vertex_components(mesh)) {
    s.components = std::max(s.components, component + 1);
    s.unreferenced_vertices += component < 0 ? 1 : 0;
  }
  measure_faces(mesh, s);
  const bool balanced = measure_edges(mesh, s);
  s.nonmanifold_vertices = count_nonmanifold_vertices(mesh);
  s.duplicate_faces = count_duplicate_faces(mesh);
  s.euler_characteristic = s.vertices - s.unreferenced_vertices - s.edges + s.faces;
  s.closed = s.faces > 0 && s.boundary_edges == 0;
  if (s.closed && balanced) {
    const Vec3 centre = s.lower + (s.upper - s.lower) / 2;
    Sum volume;
    for (Index f = 0; f < mesh.n_faces(); ++f)
      volume.add(
          (face_mean(mesh, mesh.face(f)) - centre).dot(face_area_vector(mesh, mesh.face(f))) / 3);
    s.enclosed_volume = volume.value();
  }
  return s;
}

Points face_area_vectors(const PolygonMesh& mesh) {
  Points area_vectors(mesh.n_faces(), 3);
  for (Index f = 0; f < mesh.n_faces(); ++f)
    area_vectors.row(f) = face_area_vector(mesh, mesh.face(f)).transpose();
  return area_vectors;
}

Points vertex_normals(const PolygonMesh& mesh) {
  Points normals = Points::Zero(mesh.n_vertices(), 3);
  Vector total = Vector::Zero(mesh.n_vertices());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Vec3 area_vector = face_area_vector(mesh, mesh.face(f));
    for (const Index v : mesh.face(f)) {
      normals.row(v) += area_vector.transpose();
      total[v] += area_vector.norm();
    }
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double norm = normals.row(v).norm();
    if (norm > kVanishing * total[v])
      normals.row(v) /= norm;
    else
      normals.row(v).setZero();
  }
  return normals;
}

std::vector<Index> vertex_components(const PolygonMesh& mesh) {
  DisjointSets sets = join_face_vertices(mesh);
  const Csr& corners = mesh.vertex_corners();
  std::vector<Index> component(static_cast<std::size_t>(mesh.n_vertices()), -1);
  Index count = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (corners.size(v) == 0) continue;
    const Index root = sets.root(v);
    component[v] = root == v ? count++ : component[root];
  }
  return component;
}

std::vector<bool> boundary_vertices(const PolygonMesh& mesh) {
  std::vector<bool> on_boundary(static_cast<std::size_t>(mesh.n_vertices()), false);
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e)
    if (edges.corners.size(e) == 1)
      for (const Index v : edges.vertices[e]) on_boundary[v] = true;
  return on_boundary;
}

}  // namespace carat
