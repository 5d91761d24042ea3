#include "carat/kernels/half_space_center.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace carat {
namespace {

// Distances from the planes below this part of the region's size are rounding noise.
constexpr double kNoise = 1e-12;
constexpr int kMaxSteps = 100;

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

/// Minimises -sum |n| log(depth) + pull * s over x and s, where the planes lie s farther out:
/// depth = s + (offset - n.x) / |n|. With pull = 0, s stays as it is.
class Barrier {
 public:
  explicit Barrier(std::span<const HalfSpace> planes) : planes_(planes) {
    for (const HalfSpace& plane : planes) total_ += plane.normal.norm();
  }

  double total() const { return total_; }

  /// Newton's method with halved steps. \param enough  stop as soon as s is below it
  void minimise(Vec4& at, double pull, double enough) const {
    for (int step = 0; step < kMaxSteps && at[3] > enough; ++step) {
      Vec4 gradient = Vec4::Zero();
      Mat4 hessian = Mat4::Zero();
      const double value = evaluate(at, pull, &gradient, &hessian);
      Vec4 newton = Vec4::Zero();
      if (pull > 0) {
        newton = -hessian.ldlt().solve(gradient);
      } else {
        newton.head<3>() = -hessian.topLeftCorner<3, 3>().ldlt().solve(gradient.head<3>());
      }
      const double decrease = gradient.dot(newton);
      if (!newton.allFinite() || !(decrease < -1e-14 * total_)) return;
      double length = 1;
      while (length > kNoise && !(evaluate(at + length * newton, pull, nullptr, nullptr) <=
                                  value + 0.1 * length * decrease))
        length /= 2;
      if (length <= kNoise) return;
      at += length * newton;
    }
  }

 private:
  double evaluate(const Vec4& at, double pull, Vec4* gradient, Mat4* hessian) const {
    double value = pull * at[3];
    if (gradient != nullptr) (*gradient)[3] += pull;
    for (const HalfSpace& plane : planes_) {
      const double weight = plane.normal.norm();
      if (!(weight > 0)) continue;
      const double depth = at[3] + (plane.offset - plane.normal.dot(at.head<3>())) / weight;
      if (!(depth > 0)) return std::numeric_limits<double>::infinity();
      value -= weight * std::log(depth);
      if (gradient == nullptr) continue;
      Vec4 slope;
      slope << -plane.normal / weight, 1;
      *gradient -= weight / depth * slope;
      *hessian += weight / (depth * depth) * slope * slope.transpose();
    }
    return value;
  }

  std::span<const HalfSpace> planes_;
  double total_ = 0;
};

}  // namespace

bool half_space_center(std::span<const HalfSpace> planes, Vec3& center) {
  const Barrier barrier(planes);
  if (!(barrier.total() > 0)) return false;
  // Push the planes out until 0 is inside, then pull them in again.
  Vec4 at = Vec4::Zero();
  for (const HalfSpace& plane : planes) {
    const double weight = plane.normal.norm();
    if (weight > 0) at[3] = std::max(at[3], -plane.offset / weight);
  }
  at[3] = 1.5 * at[3] + kNoise;
  const double start = at[3];
  for (double pull = barrier.total() / start; at[3] > -kNoise; pull *= 8) {
    if (pull > barrier.total() / kNoise) return false;
    barrier.minimise(at, pull, -kNoise);
  }
  // Planes as deep as they are given: s = 0.
  at[3] = 0;
  barrier.minimise(at, 0, -1);
  center = at.head<3>();
  for (const HalfSpace& plane : planes)
    if (plane.offset - plane.normal.dot(center) <= kNoise * plane.normal.norm()) return false;
  return true;
}

}  // namespace carat
