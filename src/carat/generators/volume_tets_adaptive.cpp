#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"

namespace carat {
namespace {

// Coordinates are whole numbers, kSide across the unit cube, so that a vertex has one name.
constexpr int kSideBits = 20;
constexpr std::int64_t kSide = std::int64_t{1} << kSideBits;

// Longest edge of a tetrahedron at level 0: at most kFine where it is finest, growing with the
// distance (of the coordinate farthest off) to kCoarse.
constexpr double kFine = 0.11, kCoarse = 0.88;

using Place = std::array<std::int64_t, 3>;

/// Bisects tetrahedra at their longest edges. Those of a cube along its diagonal, and all that
/// come of them by bisection, have one longest edge, and there are three shapes of them.
class Bisection {
 public:
  explicit Bisection(double finest_at) : finest_at_(finest_at) {}

  /// Eight cubes of six tetrahedra each, around diagonals from the middle to the corners.
  void start() {
    constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (int octant = 0; octant < 8; ++octant)
      for (const auto& order : orders) {
        Place at{kSide / 2, kSide / 2, kSide / 2};
        Tet tet{{number(at)}, 0};
        for (int k = 0; k < 3; ++k) {
          at[order[k]] = (octant >> order[k] & 1) == 1 ? kSide : 0;
          tet.corners[k + 1] = number(at);
        }
        tets_.push_back(tet);
      }
  }

  /// Until no tetrahedron is too large where it lies.
  void grade() {
    bisect_while([this](const Tet& tet) {
      const auto [a, b] = longest_edge(tet);
      return is_too_large(tet.corners[a], tet.corners[b]);
    });
  }

  /// Bisects every tetrahedron 3 * `times` times: three bisections halve the size.
  void halve(int times) {
    for (Tet& tet : tets_) tet.due = 3 * times;
    bisect_while([](const Tet& tet) { return tet.due > 0; });
  }

  PolyhedralMesh build(const VolumeDomain& domain, double anisotropy) const {
    Points points(static_cast<Eigen::Index>(places_.size()), 3);
    for (std::size_t v = 0; v < places_.size(); ++v)
      for (int k = 0; k < 3; ++k)
        points(static_cast<Eigen::Index>(v), k) =
            static_cast<double>(places_[v][k]) / static_cast<double>(kSide);
    VolumeBuilder cells(place_points(domain, points, anisotropy));
    for (const Tet& tet : tets_) cells.add(CellType::Tetrahedron, tet.corners);
    return std::move(cells).build();
  }

 private:
  struct Tet {
    std::array<Index, 4> corners;
    int due;  ///< bisections
  };

  /// Until `is_wanted` holds for no tetrahedron, and none has a vertex in the middle of an edge.
  template <class IsWanted>
  void bisect_while(IsWanted&& is_wanted) {
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<Tet> next;
      next.reserve(2 * tets_.size());
      for (const Tet& tet : tets_) {
        if (!is_wanted(tet) && !has_hanging_vertex(tet)) {
          next.push_back(tet);
          continue;
        }
        changed = true;
        const auto [a, b] = longest_edge(tet);
        const Index middle = number(midpoint(tet.corners[a], tet.corners[b]));
        for (const int replaced : {b, a}) {
          next.push_back(tet);
          next.back().corners[replaced] = middle;
          --next.back().due;
        }
      }
      tets_ = std::move(next);
    }
  }

  static std::uint64_t key(const Place& at) {
    std::uint64_t key = 0;
    for (const std::int64_t x : at) key = key << (kSideBits + 1) | static_cast<std::uint64_t>(x);
    return key;
  }
  Index number(const Place& at) {
    const auto [entry, is_new] = numbers_.try_emplace(key(at), static_cast<Index>(places_.size()));
    if (is_new) places_.push_back(at);
    return entry->second;
  }
  Place midpoint(Index a, Index b) const {
    Place middle;
    for (int k = 0; k < 3; ++k) middle[k] = (places_[a][k] + places_[b][k]) / 2;
    return middle;
  }
  std::int64_t squared_length(Index a, Index b) const {
    std::int64_t sum = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t d = places_[a][k] - places_[b][k];
      sum += d * d;
    }
    return sum;
  }
  std::pair<int, int> longest_edge(const Tet& tet) const {
    std::pair<int, int> longest;
    std::int64_t most = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b)
        if (const std::int64_t length = squared_length(tet.corners[a], tet.corners[b]);
            length > most) {
          most = length;
          longest = {a, b};
        }
    return longest;
  }
  bool is_too_large(Index a, Index b) const {
    const Place middle = midpoint(a, b);
    double distance = 0;
    for (const std::int64_t x : middle)
      distance = std::max(
          distance, std::abs(static_cast<double>(x) / static_cast<double>(kSide) - finest_at_));
    const double share = distance / (1 - finest_at_);
    const double limit = kFine + (kCoarse - kFine) * share;
    return static_cast<double>(squared_length(a, b)) >
           limit * limit * static_cast<double>(kSide) * static_cast<double>(kSide);
  }
  /// A vertex in the middle of an edge is one that a neighbour was bisected at.
  bool has_hanging_vertex(const Tet& tet) const {
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b)
        if (numbers_.contains(key(midpoint(tet.corners[a], tet.corners[b])))) return true;
    return false;
  }

  double finest_at_;
  std::vector<Tet> tets_;
  std::vector<Place> places_;
  std::unordered_map<std::uint64_t, Index> numbers_;
};

}  // namespace

/// Tetrahedra of three shapes by repeated bisection, eight times larger far from the corner (0, 0,
/// 0) of the cube, or from the centre of the ball, than there.
PolyhedralMesh generate_volume_tets_adaptive(const VolumeDomain& domain,
                                             const FamilyOptions& options) {
  constexpr double kCornersPerCube = 306 * 12;  // at level 0
  volume_lattice_size(options.level, 1, kCornersPerCube);
  Bisection tets(domain.finest_at);
  tets.start();
  tets.grade();
  tets.halve(options.level);
  return finish_volume(tets.build(domain, options.anisotropy), domain, options);
}

}  // namespace carat
