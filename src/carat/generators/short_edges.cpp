#include "carat/generators/short_edges.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "carat/generators/volume_lattice.h"

namespace carat {
namespace {

/// Merges groups of vertices, and takes apart those that do harm.
class EdgeMerger {
 public:
  EdgeMerger(const PolyhedralMesh& mesh, const VolumeDomain& domain, double length)
      : mesh_(mesh), domain_(domain), border_(boundary_vertices(mesh)) {
    group_.resize(static_cast<std::size_t>(mesh.n_vertices()));
    split_.resize(group_.size(), false);
    for (Index v = 0; v < mesh.n_vertices(); ++v) group_[v] = v;
    for (const auto& [a, b] : mesh.face_mesh().edges().vertices) {
      const Index g = first_of(a), h = first_of(b);
      if ((mesh.point(b) - mesh.point(a)).norm() < length) group_[std::max(g, h)] = std::min(g, h);
    }
    for (Index v = 0; v < mesh.n_vertices(); ++v) group_[v] = first_of(v);
    find_anchors();
  }

  PolyhedralMesh merged() {
    while (true) {
      do
        for (Index c = 0; c < mesh_.n_cells(); ++c)
          if (!is_whole(c)) mark(c);
      while (split_marked());
      PolyhedralMesh result = build();
      for (const Index c : inverted_cells(result)) mark(c);
      if (!split_marked()) return result;
    }
  }

 private:
  Index first_of(Index v) const {
    while (group_[v] != v) v = group_[v];
    return v;
  }

  /// The walls of the cube that a vertex lies on, or one for the sphere.
  unsigned walls(Index v) const {
    if (!border_[v]) return 0;
    if (domain_.is_ball) return 1;
    unsigned walls = 0;
    for (int k = 0; k < 3; ++k) {
      if (mesh_.point(v)[k] == 0) walls |= 1u << (2 * k);
      if (mesh_.point(v)[k] == 1) walls |= 2u << (2 * k);
    }
    return walls;
  }

  /// Finds a vertex in every group that lies on all walls of the group; without one it is split.
  void find_anchors() {
    anchor_.assign(group_.size(), -1);
    std::vector<unsigned> all_walls(group_.size(), 0);
    for (Index v = 0; v < mesh_.n_vertices(); ++v) all_walls[group_[v]] |= walls(v);
    for (Index v = mesh_.n_vertices() - 1; v >= 0; --v)
      if (walls(v) == all_walls[group_[v]]) anchor_[group_[v]] = v;
    for (Index v = 0; v < mesh_.n_vertices(); ++v) split_[group_[v]] = anchor_[group_[v]] < 0;
    split_marked();
  }

  void mark(Index c) {
    for (const Index v : mesh_.cell_vertices().row(c)) split_[group_[v]] = true;
  }
  /// Whether there was anything to split.
  bool split_marked() {
    bool any = false;
    for (Index v = mesh_.n_vertices() - 1; v >= 0; --v) {
      const Index g = group_[v];
      if (!split_[g]) continue;
      any = any || g != v;
      group_[v] = anchor_[v] = v;
    }
    std::fill(split_.begin(), split_.end(), false);
    return any;
  }

  /// The groups around a face, each once in a row.
  void trace(Index f, std::vector<Index>& face) const {
    face.clear();
    for (const Index v : mesh_.face(f))
      if (face.empty() || face.back() != group_[v]) face.push_back(group_[v]);
    if (face.size() > 1 && face.front() == face.back()) face.pop_back();
  }

  /// Whether the faces of a cell that are left are simple polygons that close around it.
  bool is_whole(Index c) {
    edges_.clear();
    vertices_.clear();
    std::ptrdiff_t n_faces = 0;
    for (const Index f : mesh_.cell(c)) {
      trace(f, face_);
      if (face_.size() < 3) continue;
      ++n_faces;
      Index previous = face_.back();
      for (const Index v : face_) {
        edges_.push_back({std::min(previous, v), std::max(previous, v)});
        previous = v;
      }
      vertices_.insert(vertices_.end(), face_.begin(), face_.end());
      std::sort(face_.begin(), face_.end());
      if (std::adjacent_find(face_.begin(), face_.end()) != face_.end()) return false;
    }
    const auto n_edges = static_cast<std::ptrdiff_t>(edges_.size()) / 2;
    std::sort(edges_.begin(), edges_.end());
    for (std::size_t i = 0; i + 1 < edges_.size(); i += 2)
      if (edges_[i] != edges_[i + 1]) return false;
    const auto n_different = std::unique(edges_.begin(), edges_.end()) - edges_.begin();
    std::sort(vertices_.begin(), vertices_.end());
    const auto n_vertices = std::unique(vertices_.begin(), vertices_.end()) - vertices_.begin();
    return n_faces >= 4 && n_different == n_edges && n_vertices - n_edges + n_faces == 2;
  }

  /// Groups go to the mean of those of their vertices that lie on all walls of the group.
  Points group_points() const {
    std::vector<Vec3> offset(group_.size(), Vec3::Zero());
    std::vector<int> count(group_.size(), 0);
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      const Index anchor = anchor_[group_[v]];
      if (walls(v) != walls(anchor)) continue;
      offset[group_[v]] += mesh_.point(v) - mesh_.point(anchor);
      ++count[group_[v]];
    }
    Points points = mesh_.points();
    for (Index v = 0; v < mesh_.n_vertices(); ++v)
      if (group_[v] == v && count[v] > 1)
        points.row(v) =
            domain_.displace(mesh_.point(anchor_[v]), offset[v] / count[v], border_[anchor_[v]])
                .transpose();
      else if (group_[v] == v)
        points.row(v) = mesh_.point(anchor_[v]).transpose();
    return points;
  }

  PolyhedralMesh build() {
    VolumeBuilder cells(group_points());
    for (Index c = 0; c < mesh_.n_cells(); ++c) {
      for (const Index f : mesh_.cell(c)) {
        trace(f, face_);
        if (face_.size() > 2) cells.add_face(face_);
      }
      cells.end_cell();
    }
    return std::move(cells).build();
  }

  const PolyhedralMesh& mesh_;
  const VolumeDomain& domain_;
  std::vector<bool> border_;
  std::vector<bool> split_;             // groups to take apart
  std::vector<Index> group_, anchor_;   // vertex -> its group, named after its first vertex
  std::vector<Index> face_, vertices_;  // scratch
  std::vector<std::array<Index, 2>> edges_;
};

}  // namespace

PolyhedralMesh merge_short_edges(const PolyhedralMesh& mesh, const VolumeDomain& domain,
                                 double length) {
  return EdgeMerger(mesh, domain, length).merged();
}

}  // namespace carat
