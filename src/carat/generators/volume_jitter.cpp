#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/random.h"
#include "carat/generators/volume_domain.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {
namespace {

constexpr double kLeastVolume = 0.1;  // of a virtual tetrahedron, over what it was
constexpr int kHalvings = 6;          // then the vertex stays where it was

/// Six times the volumes of the virtual tetrahedra of one cell, positive if not inverted.
class VirtualVolumes {
 public:
  explicit VirtualVolumes(const PolyhedralMesh& mesh) : mesh_(mesh), kernel_({}) {}

  const std::vector<double>& compute(const Points& points, Index c) {
    add_triangles(points, c);
    // The point of least sum of squared volumes.   [BBA21 (29)]
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Vec3 right_side = Vec3::Zero();
    const Vec3 origin = triangles_.front().point;
    for (const Triangle& t : triangles_) {
      normal_matrix += t.area * t.area.transpose();
      right_side += t.area * t.area.dot(t.point - origin);
    }
    point_ = origin + normal_matrix.ldlt().solve(right_side);
    volumes_.clear();
    for (const Triangle& t : triangles_) volumes_.push_back(t.area.dot(t.point - point_));
    return volumes_;
  }
  /// The virtual vertex of the last cell.
  const Vec3& point() const { return point_; }
  /// Whether no face of the last cell had its virtual vertex moved to keep its triangles unflipped.
  bool is_regular() const { return regular_; }

 private:
  struct Triangle {
    Vec3 area;   ///< twice the area vector, out of the cell
    Vec3 point;  ///< the face point
  };

  void add_triangles(const Points& points, Index c) {
    triangles_.clear();
    regular_ = true;
    for (const Index f : mesh_.cell(c)) {
      const auto face = mesh_.face(f);
      weights_.resize(face.size());
      parts_.resize(face.size());
      regular_ = kernel_.compute(points, face, weights_.data(), parts_.data()) ==
                     VirtualVertexStatus::Regular &&
                 regular_;
      const Vec3 centre = kernel_.point();
      const double sign = mesh_.face_cells()[f].below == c ? 1 : -1;
      Vec3 previous = Vec3(points.row(face.back()).transpose()) - centre;
      for (const Index v : face) {
        const Vec3 next = Vec3(points.row(v).transpose()) - centre;
        triangles_.push_back({sign * previous.cross(next), centre});
        previous = next;
      }
    }
  }

  const PolyhedralMesh& mesh_;
  VirtualVertexKernel kernel_;
  std::vector<double> weights_, volumes_;
  std::vector<VirtualTriangle> parts_;
  std::vector<Triangle> triangles_;
  Vec3 point_;
  bool regular_ = true;
};

Vector shortest_edges(const PolyhedralMesh& mesh) {
  Vector shortest = Vector::Constant(mesh.n_vertices(), std::numeric_limits<double>::infinity());
  for (const auto& [a, b] : mesh.face_mesh().edges().vertices) {
    const double length = (mesh.point(b) - mesh.point(a)).norm();
    shortest[a] = std::min(shortest[a], length);
    shortest[b] = std::min(shortest[b], length);
  }
  return shortest;
}

/// Whether a cell kept a tenth of every volume, with the vertices at `moved`.
class CellCheck {
 public:
  explicit CellCheck(const PolyhedralMesh& mesh) : mesh_(mesh), before_(mesh), after_(mesh) {}
  bool is_sound(const Points& moved, Index c) {
    const std::vector<double>& before = before_.compute(mesh_.points(), c);
    const std::vector<double>& after = after_.compute(moved, c);
    if (before_.is_regular() && !after_.is_regular()) return false;
    for (std::size_t t = 0; t < before.size(); ++t)
      // An unmoved cell is always sound, so that the halving ends.
      if (!(after[t] >= std::min(kLeastVolume * before[t], before[t]))) return false;
    return true;
  }

 private:
  const PolyhedralMesh& mesh_;
  VirtualVolumes before_, after_;
};

void sort_unique(std::vector<Index>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

PolyhedralMesh jitter_cells(const PolyhedralMesh& mesh, const VolumeDomain& domain, double jitter,
                            std::uint64_t seed) {
  if (jitter == 0) return mesh;
  const Vector reach = jitter * shortest_edges(mesh);
  const std::vector<bool> border = boundary_vertices(mesh);
  Points moved(mesh.n_vertices(), 3);
  const auto place = [&](Index v, int halvings) {
    RandomStream random(seed, static_cast<std::uint64_t>(v));
    const double scale = halvings > kHalvings ? 0 : std::ldexp(reach[v], -halvings);
    const Vec3 x = mesh.point(v);
    moved.row(v) =
        (scale == 0 ? x : domain.displace(x, scale * random.in_ball(), border[v])).transpose();
  };
  for (Index v = 0; v < mesh.n_vertices(); ++v) place(v, 0);

  Array<int> halvings(static_cast<std::size_t>(mesh.n_vertices()), 0);
  CellCheck check(mesh);
  std::vector<Index> cells(static_cast<std::size_t>(mesh.n_cells())), shortened;
  for (Index c = 0; c < mesh.n_cells(); ++c) cells[c] = c;
  while (!cells.empty()) {
    shortened.clear();
    for (const Index c : cells)
      if (!check.is_sound(moved, c))
        for (const Index v : mesh.cell_vertices().row(c)) shortened.push_back(v);
    sort_unique(shortened);
    cells.clear();
    for (const Index v : shortened) {
      place(v, ++halvings[v]);
      for (const Index corner : mesh.vertex_cell_corners().row(v))
        cells.push_back(mesh.corner_cells()[corner]);
    }
    sort_unique(cells);
  }
  return mesh.with_points(std::move(moved));
}

Points cell_points(const PolyhedralMesh& mesh) {
  VirtualVolumes volumes(mesh);
  Points points(mesh.n_cells(), 3);
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    volumes.compute(mesh.points(), c);
    points.row(c) = volumes.point().transpose();
  }
  return points;
}

std::vector<Index> inverted_cells(const PolyhedralMesh& mesh) {
  VirtualVolumes volumes(mesh);
  std::vector<Index> cells;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    const std::vector<double>& all = volumes.compute(mesh.points(), c);
    // Written so that a NaN is found.
    if (!std::all_of(all.begin(), all.end(), [](double volume) { return volume > 0; }))
      cells.push_back(c);
  }
  return cells;
}

PolyhedralMesh finish_volume(const PolyhedralMesh& mesh, const VolumeDomain& domain,
                             const FamilyOptions& options) {
  if (options.anisotropy != 1)
    if (const std::vector<Index> inverted = inverted_cells(mesh); !inverted.empty())
      throw InvalidOption("anisotropy " + std::to_string(options.anisotropy) + ": cell " +
                          std::to_string(inverted.front()) +
                          " would be inverted; choose a smaller one, or a higher level");
  return jitter_cells(mesh, domain, options.jitter, options.seed);
}

}  // namespace carat
