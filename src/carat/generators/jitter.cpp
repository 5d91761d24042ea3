#include "carat/generators/jitter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carat/generators/random.h"

namespace carat {
namespace {

constexpr double kLeastMeasure = 0.1;  // of a corner or triangle, over what it was
constexpr int kHalvings = 6;           // then the vertex stays where it was

double turn_in_plane(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).head<2>().x() * (c - a).y() - (b - a).y() * (c - a).x();
}

Vec3 displace_in_square(const Vec3& x, const Vec2& offset) {
  Vec3 moved = x;
  for (int k = 0; k < 2; ++k)
    if (x[k] != 0 && x[k] != 1) moved[k] += offset[k];
  return moved;
}

double turn_on_sphere(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).dot(a);
}

/// x plus the offset in the plane normal to n.
Vec3 displace_across(const Vec3& x, const Vec3& normal, const Vec2& offset) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 u = normal.cross(Vec3(Vec3::Unit(axis))).normalized();
  return x + offset.x() * u + offset.y() * normal.cross(u);
}

Vec3 displace_on_sphere(const Vec3& x, const Vec2& offset) {
  return displace_across(x, x, offset).normalized();
}

Vec3 nearest_on_torus_axis(const Vec3& x) {
  return Vec3(x.x(), x.y(), 0) / std::hypot(x.x(), x.y());
}

double turn_on_torus(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 middle = (a + b + c) / 3;
  return (b - a).cross(c - a).dot((middle - nearest_on_torus_axis(middle)).normalized());
}

Vec3 displace_on_torus(const Vec3& x, const Vec2& offset) {
  const Vec3 normal = (x - nearest_on_torus_axis(x)).normalized();
  const Vec3 moved = displace_across(x, normal, offset);
  const Vec3 axis = nearest_on_torus_axis(moved);
  return axis + kTubeRadius * (moved - axis).normalized();
}

Vector shortest_edges(const PolygonMesh& mesh) {
  Vector shortest = Vector::Constant(mesh.n_vertices(), std::numeric_limits<double>::infinity());
  for (const auto& [a, b] : mesh.edges().vertices) {
    const double length = (mesh.point(b) - mesh.point(a)).norm();
    shortest[a] = std::min(shortest[a], length);
    shortest[b] = std::min(shortest[b], length);
  }
  return shortest;
}

/// Whether face f kept a tenth of every measure, with the vertices at `moved`.
bool is_sound(const PolygonMesh& mesh, const Domain& domain, const Points* kernel_points, Index f,
              const Points& moved) {
  const auto face = mesh.face(f);
  const auto at = [](const Points& points, Index i) -> Vec3 { return points.row(i).transpose(); };
  Index a = face[face.size() - 2], b = face.back();
  for (const Index c : face) {
    double before, after;
    if (kernel_points == nullptr) {
      before = domain.turn(mesh.point(a), mesh.point(b), mesh.point(c));
      after = domain.turn(at(moved, a), at(moved, b), at(moved, c));
    } else {
      const Vec3 centre = at(*kernel_points, f);
      before = domain.turn(mesh.point(b), mesh.point(c), centre);
      after = domain.turn(at(moved, b), at(moved, c), centre);
    }
    // An unmoved face is always sound, so that the halving ends.
    if (!(after >= std::min(kLeastMeasure * before, before))) return false;
    a = std::exchange(b, c);
  }
  return true;
}

}  // namespace

const Domain kSquare{turn_in_plane, displace_in_square};
const Domain kSphere{turn_on_sphere, displace_on_sphere};
const Domain kTorus{turn_on_torus, displace_on_torus};

PolygonMesh jitter_vertices(const PolygonMesh& mesh, const Domain& domain,
                            const FamilyOptions& options, const Points* kernel_points) {
  if (options.jitter == 0) return mesh;
  const Vector reach = options.jitter * shortest_edges(mesh);
  Points moved(mesh.n_vertices(), 3);
  const auto place = [&](Index v, int halvings) {
    RandomStream random(options.seed, static_cast<std::uint64_t>(v));
    const double scale = halvings > kHalvings ? 0 : std::ldexp(reach[v], -halvings);
    const Vec3 x = mesh.point(v);
    moved.row(v) = (scale == 0 ? x : domain.displace(x, scale * random.in_disc())).transpose();
  };
  for (Index v = 0; v < mesh.n_vertices(); ++v) place(v, 0);

  Array<int> halvings(static_cast<std::size_t>(mesh.n_vertices()), 0);
  std::vector<Index> shortened;
  do {
    shortened.clear();
    for (Index f = 0; f < mesh.n_faces(); ++f)
      if (!is_sound(mesh, domain, kernel_points, f, moved))
        for (const Index v : mesh.face(f)) shortened.push_back(v);
    std::sort(shortened.begin(), shortened.end());
    shortened.erase(std::unique(shortened.begin(), shortened.end()), shortened.end());
    for (const Index v : shortened) place(v, ++halvings[v]);
  } while (!shortened.empty());
  return mesh.with_points(std::move(moved));
}

}  // namespace carat
