#include "carat/mesh/hanging_vertices.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <span>

namespace carat {
namespace {

constexpr double kTouching = 1e-6;  // distance over the edge's length, over the face's diameter
constexpr std::int64_t kStepsPerCorner = 1000;  // 20 to 60 in meshes of simulations

/// Points in a balanced tree of boxes, to find those in a box.
class PointTree {
 public:
  PointTree(const Points& points, std::vector<Index> ids) : points_(points), ids_(std::move(ids)) {
    axes_.assign(ids_.size(), 0);
    build(0, ids_.size());
  }

  /// Calls visit(id) for the points in the box. `steps` counts the work done.
  template <class Visit>
  void find(const Vec3& lower, const Vec3& upper, std::int64_t& steps, const Visit& visit) const {
    find(0, ids_.size(), lower, upper, steps, visit);
  }

 private:
  void build(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Vec3 lower = point(begin), upper = lower;
    for (std::size_t i = begin + 1; i < end; ++i) {
      lower = lower.cwiseMin(point(i));
      upper = upper.cwiseMax(point(i));
    }
    int axis = 0;
    (upper - lower).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return ids_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [&](Index a, Index b) { return points_(a, axis) < points_(b, axis); });
    axes_[middle] = static_cast<unsigned char>(axis);
    build(begin, middle);
    build(middle + 1, end);
  }

  template <class Visit>
  void find(std::size_t begin, std::size_t end, const Vec3& lower, const Vec3& upper,
            std::int64_t& steps, const Visit& visit) const {
    if (begin >= end) return;
    ++steps;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3 x = point(middle);
    const int axis = axes_[middle];
    if (lower[axis] <= x[axis]) find(begin, middle, lower, upper, steps, visit);
    if ((lower.array() <= x.array()).all() && (x.array() <= upper.array()).all())
      visit(ids_[middle]);
    if (x[axis] <= upper[axis]) find(middle + 1, end, lower, upper, steps, visit);
  }

  Vec3 point(std::size_t i) const { return points_.row(ids_[i]).transpose(); }

  const Points& points_;
  std::vector<Index> ids_;
  std::vector<unsigned char> axes_;
};

/// A face with its mean plane, to tell what lies in it.
class FlatFace {
 public:
  FlatFace(const PolyhedralMesh& mesh, std::span<const Index> face) : mesh_(mesh), face_(face) {
    const Vec3 first = mesh.point(face[0]);
    Vec3 sum = Vec3::Zero();
    lower = upper = first;
    for (const Index v : face) {
      const Vec3 x = mesh.point(v);
      sum += x - first;
      lower = lower.cwiseMin(x);
      upper = upper.cwiseMax(x);
    }
    mean_ = first + sum / static_cast<double>(face.size());
    tolerance_ = kTouching * (upper - lower).norm();
    lower.array() -= tolerance_;
    upper.array() += tolerance_;
    Vec3 normal = Vec3::Zero();
    for_sides([&](const Vec3& a, const Vec3& b) { normal += (a - mean_).cross(b - mean_); });
    normal_ = normal.normalized();
    if (normal_.squaredNorm() > 0) {
      u_ = normal_.unitOrthogonal();
      w_ = normal_.cross(u_);
    }
  }

  /// Inside a side or the interior; at the ends of the sides is not inside.
  bool contains(const Vec3& x) const {
    bool near_side = false, in_side = false, inside = false;
    const Vec2 p = flat(x);
    for_sides([&](const Vec3& a, const Vec3& b) {
      const Vec3 side = b - a;
      const double length = side.norm();
      const double t = side.dot(x - a) / (length * length);
      const double distance = (x - a - std::clamp(t, 0.0, 1.0) * side).norm();
      if (distance <= kTouching * length) {
        near_side = true;
        in_side = in_side || (t > kTouching && t < 1 - kTouching);
      }
      const Vec2 s = flat(a), e = flat(b);
      if ((s.y() > p.y()) != (e.y() > p.y()) &&
          p.x() < s.x() + (p.y() - s.y()) / (e.y() - s.y()) * (e.x() - s.x()))
        inside = !inside;
    });
    if (near_side) return in_side;
    return inside && std::abs(normal_.dot(x - mean_)) <= tolerance_;
  }

  Vec3 lower, upper;  ///< what it can contain lies between

 private:
  template <class Visit>
  void for_sides(const Visit& visit) const {
    Vec3 a = mesh_.point(face_.back());
    for (const Index v : face_) {
      const Vec3 b = mesh_.point(v);
      visit(a, b);
      a = b;
    }
  }
  Vec2 flat(const Vec3& x) const { return {u_.dot(x - mean_), w_.dot(x - mean_)}; }

  const PolyhedralMesh& mesh_;
  std::span<const Index> face_;
  Vec3 mean_, normal_, u_ = Vec3::Zero(), w_ = Vec3::Zero();
  double tolerance_;
};

}  // namespace

HangingVertices hanging_vertices(const PolyhedralMesh& mesh) {
  std::vector<Index> candidates;
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[v]) candidates.push_back(v);
  std::int64_t n_corners = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[f].boundary())
      n_corners += static_cast<std::int64_t>(mesh.face(f).size());

  HangingVertices result;
  const PointTree tree(mesh.points(), std::move(candidates));
  std::vector<bool> hangs(static_cast<std::size_t>(mesh.n_vertices()), false);
  std::vector<Index> named_by(static_cast<std::size_t>(mesh.n_vertices()), -1);
  std::int64_t steps = 0;
  const std::int64_t limit = kStepsPerCorner * n_corners;
  for (Index f = 0; f < mesh.n_faces() && result.complete; ++f) {
    if (!mesh.face_cells()[f].boundary()) continue;
    for (const Index v : mesh.face(f)) named_by[v] = f;
    const FlatFace face(mesh, mesh.face(f));
    tree.find(face.lower, face.upper, steps, [&](Index v) {
      if (named_by[v] == f || hangs[v] || steps > limit) return;
      steps += static_cast<std::int64_t>(mesh.face(f).size());
      hangs[v] = face.contains(mesh.point(v));
    });
    result.complete = steps <= limit;
  }
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (hangs[v]) result.vertices.push_back(v);
  return result;
}

}  // namespace carat
