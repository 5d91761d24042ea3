#include "carat/kernels/virtual_cell.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace carat {
namespace {

// A relative measure below this is rounding noise of the products that make it.
constexpr double kNoise = 1e-13;

Vec3 position(const Points& points, Index v) {
  const double* const x = points.data() + 3 * static_cast<std::ptrdiff_t>(v);
  return {x[0], x[1], x[2]};
}

/// Solves a x = b for symmetric positive definite a. False if it is singular to rounding.
bool solve_spd(const FaceMoment& a, const Vec3& b, Vec3& x) {
  const Vec3 r0(a.xx, a.xy, a.xz), r1(a.xy, a.yy, a.yz), r2(a.xz, a.yz, a.zz);
  const Vec3 c12 = r1.cross(r2), c20 = r2.cross(r0), c01 = r0.cross(r1);
  const double det = r0.dot(c12);
  const double trace = a.xx + a.yy + a.zz;
  if (!(det > kNoise * trace * trace * trace)) return false;
  x = (c12 * b.x() + c20 * b.y() + c01 * b.z()) / det;
  return true;
}

Vec3 product(const FaceMoment& a, const Vec3& x) {
  return {a.xx * x.x() + a.xy * x.y() + a.xz * x.z(), a.xy * x.x() + a.yy * x.y() + a.yz * x.z(),
          a.xz * x.x() + a.yz * x.y() + a.zz * x.z()};
}

void add(FaceMoment& a, const FaceMoment& b) {
  a.xx += b.xx;
  a.yy += b.yy;
  a.zz += b.zz;
  a.xy += b.xy;
  a.xz += b.xz;
  a.yz += b.yz;
}

void add_square(FaceMoment& a, const Vec3& x) {
  a.xx += x.x() * x.x();
  a.yy += x.y() * x.y();
  a.zz += x.z() * x.z();
  a.xy += x.x() * x.y();
  a.xz += x.x() * x.z();
  a.yz += x.y() * x.z();
}

/// Whether x is not clearly behind one of the planes. A triangle without area has no side to be on.
/// \param size2  square of the cell's size
bool flips_a_tetrahedron(const CellGeometry& cell, const Vec3& x, double size2) {
  return std::any_of(cell.virtual_planes.begin(), cell.virtual_planes.end(),
                     [&](const HalfSpace& plane) {
                       const double area2 = plane.normal.squaredNorm();
                       const double depth = plane.offset - plane.normal.dot(x);
                       return area2 > kNoise * kNoise * size2 * size2 &&
                              !(depth > 0 && depth * depth > kNoise * kNoise * size2 * area2);
                     });
}

}  // namespace

FaceMoment face_moment(const Points& points, std::span<const Index> face, const Vec3& point) {
  FaceMoment moment{0, 0, 0, 0, 0, 0};
  Vec3 previous = position(points, face.back()) - point;
  for (const Index v : face) {
    const Vec3 next = position(points, v) - point;
    add_square(moment, previous.cross(next) / 2);
    previous = next;
  }
  return moment;
}

bool is_flat_tetrahedron(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const Vec3 e1 = x1 - x0, e2 = x2 - x0, e3 = x3 - x0;
  const double size2 = std::max({e1.squaredNorm(), e2.squaredNorm(), e3.squaredNorm()});
  const double six_volumes = e1.dot(e2.cross(e3));
  return !(six_volumes * six_volumes > kNoise * kNoise * (size2 * size2 * size2));
}

bool VirtualCellKernel::minimise_volume(const CellGeometry& cell) {
  // (sum a a^T) x_c = sum a (a . x_f)     [BBA21 (29)]
  FaceMoment a{0, 0, 0, 0, 0, 0};
  Vec3 b = Vec3::Zero();
  for (std::size_t f = 0; f < cell.moments.size(); ++f) {
    add(a, cell.moments[f]);
    b += product(cell.moments[f], cell.face_points[f]);
  }
  return solve_spd(a, b, offset_);
}

bool VirtualCellKernel::set_weights(const CellGeometry& cell, double* weights) {
  // a_j = 1/m + y_j^T (sum y y^T)^-1 y_c over vertices and face points
  FaceMoment c{0, 0, 0, 0, 0, 0};
  for (const Vec3& y : cell.vertices) add_square(c, y);
  for (const Vec3& y : cell.face_points) add_square(c, y);
  Vec3 w = Vec3::Zero();
  if (!solve_spd(c, offset_, w)) return false;
  const double mean = 1.0 / static_cast<double>(cell.vertices.size() + cell.face_points.size());
  for (const Vec3& y : cell.vertices) *weights++ = mean + y.dot(w);
  for (const Vec3& y : cell.face_points) *weights++ = mean + y.dot(w);
  return true;
}

VirtualVertexStatus VirtualCellKernel::compute(CellGeometry& cell, double* weights) {
  const std::size_t m = cell.vertices.size() + cell.face_points.size();
  const auto use_mean = [&] { std::fill(weights, weights + m, 1.0 / static_cast<double>(m)); };
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : cell.vertices) mean += x;
  for (const Vec3& x : cell.face_points) mean += x;
  mean /= static_cast<double>(m);
  double size2 = 0;
  for (const Vec3& x : cell.vertices) size2 = std::max(size2, (x - mean).squaredNorm());
  offset_.setZero();
  if (!(size2 > 0)) {
    use_mean();
    return VirtualVertexStatus::Degenerate;
  }
  // In units of the cell's size.
  const double scale = 1 / std::sqrt(size2);
  for (Vec3& x : cell.vertices) x = scale * (x - mean);
  for (Vec3& x : cell.face_points) x = scale * (x - mean);
  const double scale2 = scale * scale, scale4 = scale2 * scale2;
  for (FaceMoment& a : cell.moments)
    a = {scale4 * a.xx, scale4 * a.yy, scale4 * a.zz, scale4 * a.xy, scale4 * a.xz, scale4 * a.yz};
  if ((rule_.point != VirtualPoint::Centroid && !minimise_volume(cell)) ||
      !set_weights(cell, weights)) {
    use_mean();
    return VirtualVertexStatus::Degenerate;
  }
  if (!flips_a_tetrahedron(cell, mean + offset_ / scale, size2))
    return VirtualVertexStatus::Regular;
  for (HalfSpace& plane : cell.virtual_planes) {
    plane.normal *= scale2;
    plane.offset = scale * (scale2 * plane.offset) - plane.normal.dot(scale * mean);
  }
  const Vec3 flipped = offset_;
  if (rule_.keep_in_kernel && half_space_center(cell.virtual_planes, offset_) &&
      set_weights(cell, weights) && !flips_a_tetrahedron(cell, offset_, 1))
    return VirtualVertexStatus::Moved;
  offset_ = flipped;
  set_weights(cell, weights);
  return VirtualVertexStatus::Flipped;
}

}  // namespace carat
