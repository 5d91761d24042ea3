#include "carat/generators/voronoi_cell.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace carat {

void VoronoiCell::start(const Vec3& site, double low, double high) {
  site_ = site;
  sound_ = true;
  corners_.clear();
  for (int at = 0; at < 8; ++at) {
    const bool x = (at & 1) != 0, y = (at & 2) != 0, z = (at & 4) != 0;
    Corner corner{{x ? kHighX : kLowX, y ? kHighY : kLowY, z ? kHighZ : kLowZ},
                  {x ? high : low, y ? high : low, z ? high : low}};
    if ((x != y) == z) std::swap(corner.surfaces[1], corner.surfaces[2]);
    corners_.push_back(corner);
  }
  update_radius();
}

void VoronoiCell::update_radius() {
  double squared = 0;
  for (const Corner& corner : corners_)
    squared = std::max(squared, (corner.x - site_).squaredNorm());
  radius_ = std::sqrt(squared);
}

const VoronoiCell::Corner* VoronoiCell::kept_end(Index left, Index right) const {
  for (const Corner& corner : kept_)
    for (int m = 0; m < 3; ++m)
      if (corner.surfaces[m] == right && corner.surfaces[(m + 1) % 3] == left) return &corner;
  return nullptr;
}

bool VoronoiCell::edges_form_one_ring() const {
  if (edges_.size() < 3) return false;
  std::size_t steps = 0;
  for (Index at = edges_.front().left; steps <= edges_.size(); ++steps) {
    if (steps > 0 && at == edges_.front().left) break;
    const auto next = std::find_if(edges_.begin(), edges_.end(),
                                   [&](const Edge& edge) { return edge.left == at; });
    if (next == edges_.end()) return false;
    at = next->right;
  }
  return steps == edges_.size();
}

template <class Excess, class Cross>
void VoronoiCell::cut(Index name, Excess&& excess, Cross&& cross) {
  kept_.clear();
  lost_.clear();
  for (const Corner& corner : corners_) (excess(corner.x) > 0 ? lost_ : kept_).push_back(corner);
  if (lost_.empty()) return;
  edges_.clear();
  corners_ = kept_;
  for (const Corner& corner : lost_)
    for (int m = 0; m < 3; ++m) {
      const Index left = corner.surfaces[m], right = corner.surfaces[(m + 1) % 3];
      const Corner* const end = kept_end(left, right);
      if (end == nullptr) continue;
      edges_.push_back({left, right});
      corners_.push_back({{left, right, name}, cross(end->x, corner.x)});
    }
  sound_ = sound_ && edges_form_one_ring();
  update_radius();
}

void VoronoiCell::cut_by_site(Index other, const Vec3& at) {
  const Vec3 normal = at - site_;
  if (normal.squaredNorm() >= 4 * radius_ * radius_) return;
  const double half = normal.squaredNorm() / 2;
  const auto excess = [&](const Vec3& x) { return (x - site_).dot(normal) - half; };
  cut(other, excess, [&](const Vec3& kept, const Vec3& lost) -> Vec3 {
    const double inside = excess(kept), outside = excess(lost);
    return kept + inside / (inside - outside) * (lost - kept);
  });
}

void VoronoiCell::cut_by_tangent_plane() {
  const Vec3 normal = site_.norm() > 0 ? site_.normalized() : Vec3::UnitX();
  const auto excess = [&](const Vec3& x) { return x.dot(normal) - 1; };
  cut(kTangent, excess, [&](const Vec3& kept, const Vec3& lost) -> Vec3 {
    const double inside = excess(kept), outside = excess(lost);
    return kept + inside / (inside - outside) * (lost - kept);
  });
}

void VoronoiCell::cut_by_sphere() {
  cut(
      kSphere, [](const Vec3& x) { return x.squaredNorm() - 1; },
      [](const Vec3& kept, const Vec3& lost) -> Vec3 {
        // |kept + t * along| = 1 with t > 0
        const Vec3 along = lost - kept;
        const double a = along.squaredNorm(), b = kept.dot(along), c = kept.squaredNorm() - 1;
        const double root = std::sqrt(b * b - a * c);
        const double t = b > 0 ? -c / (b + root) : (root - b) / a;
        return (kept + t * along).normalized();
      });
}

}  // namespace carat
