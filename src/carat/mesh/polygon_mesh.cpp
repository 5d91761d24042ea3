#include "carat/mesh/polygon_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "carat/base/bucket_sort.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

constexpr std::size_t kIndexLimit = std::numeric_limits<Index>::max();

void check_points(const Points& points) {
  if (static_cast<std::size_t>(points.rows()) > kIndexLimit)
    throw InvalidMesh(std::to_string(points.rows()) + " vertices: at most " +
                      std::to_string(kIndexLimit) + " are supported; split the mesh");
  if (points.array().isFinite().all()) return;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(points(v, k)))
        throw InvalidMesh("vertex " + std::to_string(v) + ": coordinate " + "xyz"[k] + " is " +
                              std::to_string(points(v, k)) +
                              "; every coordinate must be a finite number",
                          {static_cast<Index>(v)});
}

std::string describe_face(Index f, std::span<const Index> face) {
  std::string text = "face " + std::to_string(f) + " (vertices";
  for (std::size_t i = 0; i < face.size() && i < 8; ++i) text += " " + std::to_string(face[i]);
  return text + (face.size() > 8 ? " ...)" : ")");
}

bool has_three_distinct(std::span<const Index> face) {
  const auto second =
      std::find_if(face.begin(), face.end(), [&](Index v) { return v != face.front(); });
  return std::any_of(second, face.end(),
                     [&](Index v) { return v != face.front() && v != *second; });
}

void check_faces(const Csr& faces, Index n_vertices) {
  if (faces.offsets.empty() || faces.offsets.front() != 0 ||
      static_cast<std::size_t>(faces.offsets.back()) != faces.indices.size())
    throw InvalidMesh("face offsets must start at 0 and end at the number of corners (" +
                      std::to_string(faces.indices.size()) + ")");
  for (Index f = 0; f < faces.n_rows(); ++f)
    if (faces.size(f) < 0)
      throw InvalidMesh("face " + std::to_string(f) + ": face offsets must not descend", {f});
  for (Index f = 0; f < faces.n_rows(); ++f) {
    for (const Index v : faces.row(f))
      if (v < 0 || v >= n_vertices)
        throw InvalidMesh(describe_face(f, faces.row(f)) + ": vertex " + std::to_string(v) +
                              " does not exist; the mesh has " +
                              (n_vertices > 0 ? "vertices 0 to " + std::to_string(n_vertices - 1)
                                              : std::string("no vertices")),
                          {f});
    if (!has_three_distinct(faces.row(f)))
      throw InvalidMesh(
          describe_face(f, faces.row(f)) + ": a face needs at least 3 distinct vertices; remove it",
          {f});
  }
}

/// Drops every vertex that repeats its predecessor around the face (such a side has no length).
Index drop_repeated_corners(Csr& faces) {
  Index kept = 0;
  Index begin = 0;
  for (Index f = 0; f < faces.n_rows(); ++f) {
    const Index end = faces.offsets[f + 1];
    const Index first_kept = kept;
    for (Index c = begin; c < end; ++c) {
      const Index v = faces.indices[c];
      if (kept == first_kept || faces.indices[kept - 1] != v) faces.indices[kept++] = v;
    }
    while (kept - first_kept > 1 && faces.indices[kept - 1] == faces.indices[first_kept]) --kept;
    begin = end;
    faces.offsets[f + 1] = kept;
  }
  const Index dropped = static_cast<Index>(faces.indices.size()) - kept;
  faces.indices.resize(static_cast<std::size_t>(kept));
  return dropped;
}

bool repeats_a_corner(const Csr& faces) {
  for (Index f = 0; f < faces.n_rows(); ++f) {
    Index previous = faces.indices[faces.end(f) - 1];
    for (const Index v : faces.row(f)) {
      if (v == previous) return true;
      previous = v;
    }
  }
  return false;
}

EdgeTopology build_edges(const Csr& faces, Index n_vertices, int threads) {
  // Sides in buckets by their lower vertex, there by the upper one and the corner.
  const Buckets sides = sort_into_buckets(
      n_vertices, faces.n_rows(), threads, [&](Index first, Index last, auto&& emit) {
        for (Index f = first; f < last; ++f) {
          const Index begin = faces.begin(f), end = faces.end(f);
          Index v = faces.indices[begin];
          for (Index c = begin; c < end; ++c) {
            const Index next = faces.indices[c + 1 == end ? begin : c + 1];
            emit(std::min(v, next), make_key(std::max(v, next), static_cast<std::uint32_t>(c)));
            v = next;
          }
        }
      });
  std::vector<Index> n_before(static_cast<std::size_t>(resolve_threads(threads)) + 1, 0);
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    Index n = 0;
    for (Index v = begin; v < end; ++v) {
      Index previous = -1;
      for (Index k = sides.offsets[v]; k < sides.offsets[v + 1]; ++k) {
        const Index upper = major_of(sides.keys[k]);
        n += static_cast<Index>(upper != previous);
        previous = upper;
      }
    }
    n_before[static_cast<std::size_t>(block) + 1] = n;
  });
  std::partial_sum(n_before.begin(), n_before.end(), n_before.begin());
  EdgeTopology edges;
  edges.vertices.resize(static_cast<std::size_t>(n_before.back()));
  edges.corners.offsets.resize(edges.vertices.size() + 1);
  edges.corners.indices.resize(faces.indices.size());
  edges.of_corner.resize(faces.indices.size());
  edges.corners.offsets[0] = 0;
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    Index e = n_before[static_cast<std::size_t>(block)] - 1;
    for (Index v = begin; v < end; ++v) {
      Index previous = -1;
      for (Index k = sides.offsets[v]; k < sides.offsets[v + 1]; ++k) {
        const Index upper = major_of(sides.keys[k]);
        const auto corner = static_cast<Index>(minor_of(sides.keys[k]));
        // Written again for every side of an edge: cheaper than a branch.
        e += static_cast<Index>(upper != previous);
        edges.vertices[e] = {v, upper};
        edges.corners.offsets[e + 1] = k + 1;
        edges.corners.indices[k] = corner;
        edges.of_corner[corner] = e;
        previous = upper;
      }
    }
  });
  return edges;
}

}  // namespace

PolygonMesh::PolygonMesh() : topology_(std::make_shared<Topology>()) {}

PolygonMesh::PolygonMesh(Points points, Csr faces)
    : points_(std::move(points)), topology_(std::make_shared<Topology>()) {
  check_points(points_);
  if (faces.indices.size() > kIndexLimit)
    throw InvalidMesh(std::to_string(faces.indices.size()) + " face corners: at most " +
                      std::to_string(kIndexLimit) + " are supported; split the mesh");
  check_faces(faces, n_vertices());
  if (repeats_a_corner(faces)) topology_->n_dropped_corners = drop_repeated_corners(faces);
  topology_->faces = std::move(faces);
}

PolygonMesh PolygonMesh::from_faces(Points points, const std::vector<std::vector<Index>>& faces) {
  Csr csr;
  csr.offsets.reserve(faces.size() + 1);
  for (const std::vector<Index>& face : faces) {
    if (csr.indices.size() + face.size() > kIndexLimit)
      throw InvalidMesh("more than " + std::to_string(kIndexLimit) +
                        " face corners; split the mesh");
    csr.indices.insert(csr.indices.end(), face.begin(), face.end());
    csr.offsets.push_back(static_cast<Index>(csr.indices.size()));
  }
  return PolygonMesh(std::move(points), std::move(csr));
}

PolygonMesh PolygonMesh::from_padded(
    Points points,
    const Eigen::Ref<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
        faces) {
  Csr csr;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    Eigen::Index size = faces.cols();
    while (size > 0 && faces(f, size - 1) == -1) --size;
    for (Eigen::Index k = 0; k < size; ++k) csr.indices.push_back(faces(f, k));
    csr.offsets.push_back(static_cast<Index>(csr.indices.size()));
  }
  return PolygonMesh(std::move(points), std::move(csr));
}

PolygonMesh PolygonMesh::with_points(Points points) const {
  if (points.rows() != points_.rows())
    throw InvalidMesh(std::to_string(points.rows()) + " points for a mesh of " +
                      std::to_string(points_.rows()) + " vertices; the numbers must be equal");
  check_points(points);
  PolygonMesh moved = *this;
  moved.points_ = std::move(points);
  return moved;
}

const Array<Index>& PolygonMesh::corner_faces() const {
  std::call_once(topology_->corner_faces_once, [this] {
    Array<Index> corner_faces(static_cast<std::size_t>(n_corners()));
    for (Index f = 0; f < n_faces(); ++f)
      for (Index c = faces().begin(f); c < faces().end(f); ++c) corner_faces[c] = f;
    topology_->corner_faces = std::move(corner_faces);
  });
  return topology_->corner_faces;
}

const Csr& PolygonMesh::vertex_corners(int threads) const {
  std::call_once(topology_->vertex_corners_once, [this, threads] {
    const Array<Index>& vertices = faces().indices;
    Csr& result = topology_->vertex_corners;
    BlockPlaces next(static_cast<std::size_t>(resolve_threads(threads)));
    parallel_blocks(n_corners(), threads, [&](int block, Index begin, Index end) {
      Array<Index>& counts = next[static_cast<std::size_t>(block)];
      counts.assign(static_cast<std::size_t>(n_vertices()) + 1, 0);  // never empty
      for (Index c = begin; c < end; ++c) ++counts[vertices[c]];
    });
    counts_to_places(n_vertices(), next, result.offsets);
    result.indices.resize(vertices.size());
    parallel_blocks(n_corners(), threads, [&](int block, Index begin, Index end) {
      Index* const place = next[static_cast<std::size_t>(block)].data();
      for (Index c = begin; c < end; ++c) result.indices[place[vertices[c]]++] = c;
    });
  });
  return topology_->vertex_corners;
}

const EdgeTopology& PolygonMesh::edges(int threads) const {
  std::call_once(topology_->edges_once, [this, threads] {
    topology_->edges = build_edges(faces(), n_vertices(), threads);
  });
  return topology_->edges;
}

}  // namespace carat
