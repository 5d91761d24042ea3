#include "carat/mesh/ear_clipping.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace carat {
namespace {

constexpr Index kLeafSize = 8;
// A corner whose sine is below this is straight to rounding: cutting it would give an empty
// triangle, so it waits until its neighbours have changed.
constexpr double kStraightSine = 1e-10;
// Area of a rest that counts as empty, for polygons of extent 1.
constexpr double kFlatArea = 1e-10;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double orientation(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); }

bool holds_point(const std::array<Vec2, 3>& t, const Vec2& p) {
  return orientation(t[0], t[1], p) >= 0 && orientation(t[1], t[2], p) >= 0 &&
         orientation(t[2], t[0], p) >= 0 && p != t[0] && p != t[1] && p != t[2];
}

/// Largest orientation(a, b, p) over the box.
double reach(const Vec2& a, const Vec2& b, const Vec2& lower, const Vec2& upper) {
  const Vec2 d = b - a;
  const Vec2 p(d.y() > 0 ? lower.x() : upper.x(), d.x() > 0 ? upper.y() : lower.y());
  return cross(d, p - a);
}

}  // namespace

bool EarClipper::is_convex(Index corner) const {
  const Vec2 in = points_[corner] - points_[previous_[corner]];
  const Vec2 out = points_[next_[corner]] - points_[corner];
  const double doubled_area = cross(in, out);
  return doubled_area > 0 && doubled_area * doubled_area > kStraightSine * kStraightSine *
                                                               in.squaredNorm() * out.squaredNorm();
}

bool EarClipper::is_ear(Index corner) const {
  if (reflex_[corner]) return false;
  if (tree_.empty()) return true;
  return !holds_reflex({points_[previous_[corner]], points_[corner], points_[next_[corner]]}, 0, 0,
                       static_cast<Index>(tree_.size()));
}

bool EarClipper::holds_reflex(const std::array<Vec2, 3>& triangle, Index node, Index begin,
                              Index end) const {
  if (alive_[node] == 0) return false;
  const Box& box = boxes_[node];
  for (int k = 0; k < 3; ++k)
    if (reach(triangle[k], triangle[(k + 1) % 3], box.lower, box.upper) < 0) return false;
  if (end - begin > kLeafSize) {
    const Index middle = begin + (end - begin) / 2;
    return holds_reflex(triangle, 2 * node + 1, begin, middle) ||
           holds_reflex(triangle, 2 * node + 2, middle, end);
  }
  return std::any_of(tree_.begin() + begin, tree_.begin() + end, [&](Index corner) {
    return reflex_[corner] && holds_point(triangle, points_[corner]);
  });
}

void EarClipper::build_tree(Index node, Index begin, Index end) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  for (Index i = begin; i < end; ++i) {
    box.lower = box.lower.cwiseMin(points_[tree_[i]]);
    box.upper = box.upper.cwiseMax(points_[tree_[i]]);
  }
  boxes_[node] = box;
  alive_[node] = end - begin;
  if (end - begin <= kLeafSize) {
    for (Index i = begin; i < end; ++i) place_[tree_[i]] = i;
    return;
  }
  const Vec2 extent = box.upper - box.lower;
  const int axis = extent.x() >= extent.y() ? 0 : 1;
  const Index middle = begin + (end - begin) / 2;
  std::nth_element(
      tree_.begin() + begin, tree_.begin() + middle, tree_.begin() + end, [&](Index i, Index j) {
        return points_[i][axis] != points_[j][axis] ? points_[i][axis] < points_[j][axis] : i < j;
      });
  build_tree(2 * node + 1, begin, middle);
  build_tree(2 * node + 2, middle, end);
}

void EarClipper::remove_from_tree(Index corner) {
  reflex_[corner] = false;
  Index node = 0, begin = 0, end = static_cast<Index>(tree_.size());
  while (true) {
    --alive_[node];
    if (end - begin <= kLeafSize) return;
    const Index middle = begin + (end - begin) / 2;
    const bool in_first_half = place_[corner] < middle;
    node = 2 * node + (in_first_half ? 1 : 2);
    (in_first_half ? end : begin) = middle;
  }
}

void EarClipper::push_if_ear(Index corner) {
  ++version_[corner];
  if (reflex_[corner] && is_convex(corner)) remove_from_tree(corner);
  if (!is_ear(corner)) return;
  heap_.push_back({(points_[next_[corner]] - points_[previous_[corner]]).squaredNorm(), corner,
                   version_[corner]});
  std::push_heap(heap_.begin(), heap_.end(), Ear::comes_later);
}

/// Whether all that is left lies on a line, as on a side with many straight corners.
bool EarClipper::rest_is_flat() const {
  const Index first = first_left();
  for (Index i = next_[first]; next_[i] != first; i = next_[i])
    if (std::abs(orientation(points_[first], points_[i], points_[next_[i]])) > kFlatArea)
      return false;
  return true;
}

bool EarClipper::turns_once() const {
  Vec2 first = Vec2::Zero(), in = Vec2::Zero();
  double turning = 0;
  const auto turn_to = [&](const Vec2& out) { turning += std::atan2(cross(in, out), in.dot(out)); };
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2 out = points_[next_[i]] - points_[i];
    if (out.isZero(0)) continue;  // coincident vertices do not turn
    if (first.isZero(0))
      first = out;
    else
      turn_to(out);
    in = out;
  }
  turn_to(first);
  return std::abs(turning - 2 * std::numbers::pi) < 1;  // it is a multiple of 2 pi
}

const std::vector<EarClipper::Triangle>& EarClipper::cut(std::span<const Vec2> polygon) {
  points_ = polygon;
  const Index n = static_cast<Index>(polygon.size());
  previous_.resize(polygon.size());
  next_.resize(polygon.size());
  place_.resize(polygon.size());
  version_.assign(polygon.size(), 0);
  reflex_.assign(polygon.size(), false);
  tree_.clear();
  heap_.clear();
  triangles_.clear();
  for (Index i = 0; i < n; ++i) {
    previous_[i] = i == 0 ? n - 1 : i - 1;
    next_[i] = i + 1 == n ? 0 : i + 1;
  }
  if (!turns_once()) return triangles_;
  for (Index i = 0; i < n; ++i) {
    if (is_convex(i)) continue;
    reflex_[i] = true;
    tree_.push_back(i);
  }
  if (!tree_.empty()) {
    const std::size_t nodes = 4 * std::bit_ceil(tree_.size() / kLeafSize + 1);
    boxes_.resize(nodes);
    alive_.resize(nodes);
    build_tree(0, 0, static_cast<Index>(tree_.size()));
  }
  for (Index i = 0; i < n; ++i) push_if_ear(i);

  Index left = n;
  while (left > 3 && !heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), Ear::comes_later);
    const Ear ear = heap_.back();
    heap_.pop_back();
    if (ear.version != version_[ear.corner]) continue;
    const Index before = previous_[ear.corner], after = next_[ear.corner];
    triangles_.push_back({before, ear.corner, after});
    ++version_[ear.corner];
    next_[before] = after;
    previous_[after] = before;
    --left;
    push_if_ear(before);
    push_if_ear(after);
  }
  const Index first = first_left();
  const bool simple = left == 3 ? orientation(points_[first], points_[next_[first]],
                                              points_[previous_[first]]) > -kFlatArea
                                : rest_is_flat();
  if (!simple) {
    triangles_.clear();
    return triangles_;
  }
  for (Index i = next_[first]; next_[i] != first; i = next_[i])
    triangles_.push_back({first, i, next_[i]});
  return triangles_;
}

}  // namespace carat
