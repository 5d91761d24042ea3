#include "carat/kernels/virtual_vertex.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace carat {
namespace {

using Mat3 = Eigen::Matrix3d;

// A relative measure below this is rounding noise of the cross products that make it.
constexpr double kNoise = 1e-13;
// MinimumNorm: eigenvalues of C below this part of the largest count as zero (planar face). The
// square root, 1e-7, is the smallest relative height that double precision resolves through C.
constexpr double kRankCut = 1e-14;

Vec3 position(const Points& points, Index v) {
  const double* const x = points.data() + 3 * static_cast<std::ptrdiff_t>(v);
  return {x[0], x[1], x[2]};
}

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

template <int N>
void VirtualVertexKernel::load(const Points& points, const Index* face) {
  const int n = N > 0 ? N : n_;
  // Differences to one vertex are exact or nearly so, wherever the mesh lies; the mean is then
  // taken twice, so that the coordinates sum to zero to rounding.
  const Vec3 anchor = position(points, face[0]);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < n; ++i) {
    x_[i] = position(points, face[i]) - anchor;
    sum += x_[i];
  }
  const Vec3 shift = sum / n;
  sum.setZero();
  for (int i = 0; i < n; ++i) {
    x_[i] -= shift;
    sum += x_[i];
  }
  const Vec3 rest = sum / n;
  double size2 = 0;
  for (int i = 0; i < n; ++i) {
    x_[i] -= rest;
    size2 = std::max(size2, x_[i].squaredNorm());
  }
  size_ = std::sqrt(size2);
  mean_ = anchor + (shift + rest);
  Vec3 area = x_[n - 1].cross(x_[0]);
  for (int i = 0; i + 1 < n; ++i) area += x_[i].cross(x_[i + 1]);
  area_vector_ = area / 2;
}

template <int N>
bool VirtualVertexKernel::minimise_area() {
  const int n = N > 0 ? N : n_;
  // A x_f = sum (|e|^2 I - e e^T) x_i, A = sum (|e|^2 I - e e^T)     [BBA21 (19)]
  Mat3 a = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (int i = 0; i < n; ++i) {
    const Vec3 e = x_[i + 1 == n ? 0 : i + 1] - x_[i];
    const double e2 = e.squaredNorm();
    a(0, 0) += e2 - e.x() * e.x();
    a(1, 1) += e2 - e.y() * e.y();
    a(2, 2) += e2 - e.z() * e.z();
    a(0, 1) -= e.x() * e.y();
    a(0, 2) -= e.x() * e.z();
    a(1, 2) -= e.y() * e.z();
    b += e2 * x_[i] - e * e.dot(x_[i]);
  }
  const Vec3 r0(a(0, 0), a(0, 1), a(0, 2)), r1(a(0, 1), a(1, 1), a(1, 2)),
      r2(a(0, 2), a(1, 2), a(2, 2));
  const Vec3 c12 = r1.cross(r2), c20 = r2.cross(r0), c01 = r0.cross(r1);
  const double det = r0.dot(c12);
  const double trace = a.trace();
  if (!(det > kNoise * kNoise * trace * trace * trace)) return false;
  offset_ = (c12 * b.x() + c20 * b.y() + c01 * b.z()) / det;
  return true;
}

bool VirtualVertexKernel::set_weights_in_space(double* weights) {
  // a_i = 1/n + x_i^T C^+ x_f, C = sum x_i x_i^T
  Mat3 c = Mat3::Zero();
  for (int i = 0; i < n_; ++i) c += x_[i] * x_[i].transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(c);
  const Vec3& values = eigen.eigenvalues();
  Vec3 coefficient = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (values[k] > kRankCut * values[2])
      coefficient +=
          eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(offset_) / values[k]);
  for (int i = 0; i < n_; ++i) weights[i] = 1.0 / n_ + x_[i].dot(coefficient);
  return true;
}

template <int N>
bool VirtualVertexKernel::set_weights(double* weights) {
  const int n = N > 0 ? N : n_;
  if (rule_.weights == AffineWeights::MinimumNorm) {
    set_weights_in_space(weights);
  } else {
    // a_i = 1/n + y_i^T (sum y y^T)^-1 y_f, y the coordinates in the plane of the vector area
    double ss = 0, st = 0, tt = 0;
    for (int i = 0; i < n; ++i) {
      const double s = x_[i].dot(axis_s_), t = x_[i].dot(axis_t_);
      plane_[i] = {s, t};
      ss += s * s;
      st += s * t;
      tt += t * t;
    }
    const double fs = offset_.dot(axis_s_), ft = offset_.dot(axis_t_);
    const double det = ss * tt - st * st;
    if (!(det > kNoise * kNoise * (ss + tt) * (ss + tt))) return false;
    const double ws = (tt * fs - st * ft) / det, wt = (ss * ft - st * fs) / det;
    for (int i = 0; i < n; ++i) weights[i] = 1.0 / n + plane_[i].x() * ws + plane_[i].y() * wt;
  }
  offset_.setZero();
  for (int i = 0; i < n; ++i) offset_ += weights[i] * x_[i];
  return true;
}

template <int N>
bool VirtualVertexKernel::flips_a_triangle() const {
  const int n = N > 0 ? N : n_;
  // Signed against the vector area; a side shorter than noise has no triangle to flip.
  const double noise2 = kNoise * kNoise * size_ * size_;
  Vec3 previous = x_[n - 1] - offset_;
  for (int i = 0; i < n; ++i) {
    const Vec3 next = x_[i] - offset_;
    const double length2 = (next - previous).squaredNorm();
    const double signed_area = normal_.dot(previous.cross(next));
    if (length2 > noise2 && !(signed_area > 0 && signed_area * signed_area > noise2 * length2))
      return true;
    previous = next;
  }
  return false;
}

bool VirtualVertexKernel::find_kernel_centroid() {
  // The polygon's bounding box cut by the half-plane of every side; then its centre of area. It
  // is unique and does not depend on numbering or on the choice of axes.
  for (int i = 0; i < n_; ++i) plane_[i] = {x_[i].dot(axis_s_), x_[i].dot(axis_t_)};
  const double r = 2 * size_;
  clipped_.assign({Vec2(-r, -r), Vec2(r, -r), Vec2(r, r), Vec2(-r, r)});
  for (int i = 0; i < n_ && !clipped_.empty(); ++i) {
    const Vec2 origin = plane_[i];
    const Vec2 side = plane_[next(i)] - origin;
    clip_scratch_.clear();
    for (std::size_t k = 0; k < clipped_.size(); ++k) {
      const Vec2& a = clipped_[k];
      const Vec2& b = clipped_[k + 1 == clipped_.size() ? 0 : k + 1];
      const double da = cross(side, a - origin), db = cross(side, b - origin);
      if (da >= 0) clip_scratch_.push_back(a);
      if ((da > 0 && db < 0) || (da < 0 && db > 0))
        clip_scratch_.emplace_back(a + (b - a) * (da / (da - db)));
    }
    clipped_.swap(clip_scratch_);
  }
  if (clipped_.size() < 3) return false;
  const Vec2 anchor = clipped_[0];
  double area2 = 0;
  Vec2 moment = Vec2::Zero();
  for (std::size_t k = 1; k + 1 < clipped_.size(); ++k) {
    const Vec2 p = clipped_[k] - anchor, q = clipped_[k + 1] - anchor;
    area2 += cross(p, q);
    moment += cross(p, q) * (p + q) / 3;
  }
  if (!(area2 > kNoise * size_ * size_)) return false;
  const Vec2 centre = anchor + moment / area2;
  offset_ = centre.x() * axis_s_ + centre.y() * axis_t_;
  return true;
}

bool VirtualVertexKernel::minimise_trace() {
  // Trace of the fan's cotan stiffness, T(y) = sum (|e_i|^2 + |y - y_i|^2 + |y - y_{i+1}|^2) / (4
  // A_i): strictly convex inside the kernel, infinite at its border, so damped Newton finds its
  // only minimum from any point of the kernel.
  if (flips_a_triangle<0>() && !find_kernel_centroid()) return false;
  for (int i = 0; i < n_; ++i) plane_[i] = Vec2(x_[i].dot(axis_s_), x_[i].dot(axis_t_)) / size_;
  Vec2 y(offset_.dot(axis_s_) / size_, offset_.dot(axis_t_) / size_);
  const auto evaluate = [&](const Vec2& at, Vec2* gradient, Eigen::Matrix2d* hessian) {
    double value = 0;
    for (int i = 0; i < n_; ++i) {
      const Vec2& p = plane_[i];
      const Vec2& q = plane_[next(i)];
      const Vec2 e = q - p;
      const double a = 2 * cross(e, at - p);  // 4 A_i
      if (!(a > 0)) {
        if (e.squaredNorm() > kNoise * kNoise) return std::numeric_limits<double>::infinity();
        continue;
      }
      const double f = e.squaredNorm() + (at - p).squaredNorm() + (at - q).squaredNorm();
      value += f / a;
      if (gradient == nullptr) continue;
      const Vec2 da = 2 * Vec2(-e.y(), e.x());
      const Vec2 df = 2 * (2 * at - p - q);
      *gradient += df / a - (f / (a * a)) * da;
      *hessian += (4.0 / a) * Eigen::Matrix2d::Identity() -
                  (df * da.transpose() + da * df.transpose()) / (a * a) +
                  (2 * f / (a * a * a)) * (da * da.transpose());
    }
    return value;
  };
  constexpr int kMaxSteps = 60;
  for (int step = 0; step < kMaxSteps; ++step) {
    Vec2 gradient = Vec2::Zero();
    Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
    const double value = evaluate(y, &gradient, &hessian);
    if (!std::isfinite(value)) return false;
    const Vec2 newton = -hessian.inverse() * gradient;
    const double decrease = gradient.dot(newton);
    if (!newton.allFinite() || !(decrease < 0)) break;
    double length = 1;
    while (length > kNoise &&
           !(evaluate(y + length * newton, nullptr, nullptr) <= value + 0.1 * length * decrease))
      length /= 2;
    if (length <= kNoise) break;
    y += length * newton;
    if (newton.norm() <= 1e-15) break;
  }
  offset_ = size_ * (y.x() * axis_s_ + y.y() * axis_t_);
  return true;
}

template <int N>
VirtualVertexStatus VirtualVertexKernel::compute_polygon(const Points& points, const Index* face,
                                                         double* weights,
                                                         VirtualTriangle* triangles) {
  load<N>(points, face);
  const int n = N > 0 ? N : n_;
  auto status = VirtualVertexStatus::Regular;
  const double area = area_vector_.norm();
  offset_.setZero();
  bool found = area > kNoise * size_ * size_;
  if (found) {
    normal_ = area_vector_ / area;
    // Any basis of the plane serves; the coordinate axis farthest from the normal is stable.
    int k = 0;
    normal_.cwiseAbs().minCoeff(&k);
    axis_s_ = normal_.cross(Vec3::Unit(k)).normalized();
    axis_t_ = normal_.cross(axis_s_);
    if (rule_.point != VirtualPoint::Centroid) found = minimise_area<N>();
    // Without a kernel there is no trace minimum: the area minimiser stays.
    if (found && rule_.point == VirtualPoint::TraceMinimizer) minimise_trace();
    found = found && set_weights<N>(weights);
  }
  if (!found) {
    status = VirtualVertexStatus::Degenerate;
    offset_.setZero();
    std::fill(weights, weights + n, 1.0 / n);
  } else if (flips_a_triangle<N>()) {
    status = VirtualVertexStatus::Flipped;
    const Vec3 flipped = offset_;
    if (rule_.keep_in_kernel) {
      if (find_kernel_centroid() && set_weights<N>(weights) && !flips_a_triangle<N>()) {
        status = VirtualVertexStatus::Moved;
      } else {
        offset_ = flipped;
        set_weights<N>(weights);
      }
    }
  }
  for (int i = 0; i < n; ++i) {
    const Vec3 e = x_[i + 1 == n ? 0 : i + 1] - x_[i];
    const Vec3 d = offset_ - x_[i];
    const double e2 = e.squaredNorm();
    triangles[i] = {e2 > 0 ? e.dot(d) / e2 : 0.0, e.cross(d).norm()};
  }
  return status;
}

VirtualVertexStatus VirtualVertexKernel::compute_triangle(const Points& points, const Index* face,
                                                          double* weights,
                                                          VirtualTriangle* triangles) {
  // The centroid: its three virtual triangles have a third of the area each.
  const Vec3 x0 = position(points, face[0]);
  const Vec3 e0 = position(points, face[1]) - x0, e2 = x0 - position(points, face[2]);
  const Vec3 e1 = -(e0 + e2);
  const Vec3 normal = e2.cross(e0);
  const double l0 = e0.squaredNorm(), l1 = e1.squaredNorm(), l2 = e2.squaredNorm();
  const double double_area = normal.norm();
  weights[0] = weights[1] = weights[2] = 1.0 / 3.0;
  const double third = double_area / 3;
  // (x_f - x_i) . e_i = (e_i - e_{i-1}) . e_i / 3
  triangles[0] = {l0 > 0 ? (l0 - e2.dot(e0)) / (3 * l0) : 0.0, third};
  triangles[1] = {l1 > 0 ? (l1 - e0.dot(e1)) / (3 * l1) : 0.0, third};
  triangles[2] = {l2 > 0 ? (l2 - e1.dot(e2)) / (3 * l2) : 0.0, third};
  mean_ = x0;
  offset_ = (e0 - e2) / 3;
  area_vector_ = normal / 2;
  return double_area > 2 * kNoise * std::max({l0, l1, l2}) ? VirtualVertexStatus::Regular
                                                           : VirtualVertexStatus::Degenerate;
}

VirtualVertexStatus VirtualVertexKernel::compute(const Points& points, std::span<const Index> face,
                                                 double* weights, VirtualTriangle* triangles) {
  n_ = static_cast<int>(face.size());
  if (x_.size() < face.size()) {
    x_.resize(face.size());
    plane_.resize(face.size());
  }
  switch (n_) {
    case 3:
      return compute_triangle(points, face.data(), weights, triangles);
    case 4:
      return compute_polygon<4>(points, face.data(), weights, triangles);
    case 5:
      return compute_polygon<5>(points, face.data(), weights, triangles);
    case 6:
      return compute_polygon<6>(points, face.data(), weights, triangles);
    default:
      return compute_polygon<0>(points, face.data(), weights, triangles);
  }
}

}  // namespace carat
