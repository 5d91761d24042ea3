#include <cmath>
#include <numbers>
#include <utility>

#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"

namespace carat {
namespace {

/// Increasing map of the circle onto itself that draws points together at angle 0, where its slope
/// is 1/sqrt(anisotropy); opposite it is sqrt(anisotropy).
double grade_angle(double angle, double anisotropy) {
  if (anisotropy == 1) return angle;
  return 2 * std::atan2(std::sin(angle / 2), std::sqrt(anisotropy) * std::cos(angle / 2));
}

}  // namespace

/// 12 * 2^level vertices around the axis z, 6 * 2^level around the tube; every other ring is
/// shifted by half a step.
PolygonMesh generate_torus_triangles(const FamilyOptions& options) {
  const Index n_around = lattice_size(options.level, 12, 3);
  const Index n_tube = n_around / 2;
  Points points(static_cast<Eigen::Index>(n_around) * n_tube, 3);
  Csr faces;
  const auto id = [&](Index i, Index j) { return (j % n_tube) * n_around + i % n_around; };
  const auto add = [&](Index a, Index b, Index c) {
    faces.indices.insert(faces.indices.end(), {a, b, c});
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  };
  for (Index j = 0; j < n_tube; ++j) {
    const double tube_angle = 2 * std::numbers::pi * j / n_tube;
    const double radius = 1 + kTubeRadius * std::cos(tube_angle);
    const double height = kTubeRadius * std::sin(tube_angle);
    for (Index i = 0; i < n_around; ++i) {
      const double angle = grade_angle(
          2 * std::numbers::pi * (i + (j % 2 == 0 ? 0 : 0.5)) / n_around, options.anisotropy);
      points.row(id(i, j)) << radius * std::cos(angle), radius * std::sin(angle), height;
      const Index a = id(i, j), b = id(i + 1, j), c = id(i, j + 1), d = id(i + 1, j + 1);
      if (j % 2 == 0) {
        add(a, b, c);
        add(b, d, c);
      } else {
        add(a, b, d);
        add(a, d, c);
      }
    }
  }
  return jitter_vertices(PolygonMesh(std::move(points), std::move(faces)), kTorus, options);
}

}  // namespace carat
