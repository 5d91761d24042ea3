#include "carat/generators/volume_domain.h"

#include <cmath>
#include <numbers>

#include "carat/generators/lattice.h"

namespace carat {
namespace {

Vec3 place_in_cube(const Vec3& x) { return x; }

Vec3 squeeze_cube(const Vec3& x, double anisotropy) {
  return {grade(x.x(), anisotropy), x.y(), x.z()};
}

Vec3 displace_in_cube(const Vec3& x, const Vec3& offset, bool on_border) {
  Vec3 moved = x + offset;
  if (on_border)
    for (int k = 0; k < 3; ++k)
      if (x[k] == 0 || x[k] == 1) moved[k] = x[k];
  return moved;
}

constexpr double kCentreScale = 0.65;  // of the map of the cube [-1, 1]^3 to the ball, at 0

/// Blends a cube with half the edge kCentreScale, at the centre, into the sphere.
Vec3 place_in_ball(const Vec3& x) {
  const Vec3 cube = 2 * x - Vec3::Ones();
  const double level = cube.cwiseAbs().maxCoeff();
  if (level == 0) return Vec3::Zero();
  // Equal angles instead of equal lengths make the squares of the sphere nearly equal.
  Vec3 direction;
  for (int k = 0; k < 3; ++k) {
    const double u = cube[k] / level;
    direction[k] = std::abs(u) == 1 ? u : std::tan(std::numbers::pi / 4 * u);
  }
  direction.normalize();
  if (level == 1) return direction;
  return (1 - level) * kCentreScale * cube + level * level * direction;
}

/// Directions go to those of (x, y, z / anisotropy). Along a ray the map is increasing: linear at
/// the centre, so that it is smooth there, and the identity on the sphere.
Vec3 squeeze_ball(const Vec3& x, double anisotropy) {
  const double radius = x.norm();
  const Vec3 squeezed(x.x(), x.y(), x.z() / anisotropy);
  if (radius == 0) return x;
  if (radius * radius >= 1 - 1e-14) return squeezed.normalized();
  const double weight = radius * radius;
  return (1 - weight + weight * radius / squeezed.norm()) * squeezed;
}

Vec3 displace_in_ball(const Vec3& x, const Vec3& offset, bool on_border) {
  if (!on_border) return x + offset;
  return Vec3(x + offset - x.dot(offset) * x).normalized();
}

}  // namespace

const VolumeDomain kCube{false, 1, place_in_cube, squeeze_cube, displace_in_cube, 0};
const VolumeDomain kBall{
    true, std::cbrt(4 * std::numbers::pi / 3), place_in_ball, squeeze_ball, displace_in_ball, 0.5};

Points squeeze_points(const VolumeDomain& domain, const Points& points, double anisotropy) {
  if (anisotropy == 1) return points;
  Points squeezed(points.rows(), 3);
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    squeezed.row(v) = domain.squeeze(points.row(v).transpose(), anisotropy).transpose();
  return squeezed;
}

Points place_points(const VolumeDomain& domain, const Points& cube_points, double anisotropy) {
  Points points(cube_points.rows(), 3);
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    points.row(v) = domain.place(cube_points.row(v).transpose()).transpose();
  return squeeze_points(domain, points, anisotropy);
}

Points place_lattice_and_centres(const VolumeDomain& domain, const CubeLattice& lattice,
                                 double anisotropy) {
  // The image of a cube's centre is not good enough where the cube is flattened.
  Points points = place_points(domain, lattice.points(), anisotropy);
  const Points centres = cell_points(hexahedra(lattice, points));
  points.conservativeResize(lattice.n_points() + lattice.n_cells(), 3);
  points.bottomRows(lattice.n_cells()) = centres;
  return points;
}

}  // namespace carat
