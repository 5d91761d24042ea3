#pragma once
// A Voronoi cell in space, cut out of a cube or ball.

#include <array>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// A bounded cell that is cut by one surface after the other. Three surfaces meet at every corner;
/// which ones, not where, is what neighbouring cells must agree on.
class VoronoiCell {
 public:
  /// Names of surfaces; other sites are >= 0.
  static constexpr Index kLowX = -1, kHighX = -2, kLowY = -3, kHighY = -4, kLowZ = -5, kHighZ = -6;
  static constexpr Index kSphere = -7, kTangent = -8;

  struct Corner {
    std::array<Index, 3> surfaces;  ///< counter-clockwise seen from outside
    Vec3 x;
  };

  /// The cube from `low` to `high` in all coordinates.
  void start(const Vec3& site, double low, double high);
  /// Cuts off what is nearer to another site.
  void cut_by_site(Index other, const Vec3& at);
  /// Cuts off what is beyond the plane that touches the unit sphere above the site. It keeps the
  /// cell small; cut_by_sphere() must follow.
  void cut_by_tangent_plane();
  /// Cuts off what is outside of the unit sphere.
  void cut_by_sphere();

  /// Sites farther away than this cannot touch the cell.
  double influence() const { return 2 * radius_; }
  const std::vector<Corner>& corners() const { return corners_; }
  /// False if a cut left nothing, or cut off more than one part.
  bool is_sound() const { return sound_; }

 private:
  struct Edge {
    Index left, right;  ///< of an edge that was cut, seen from outside towards the lost end
  };

  /// \param excess  positive at the points to cut off
  /// \param cross   where the edge from a kept to a lost point meets the surface
  template <class Excess, class Cross>
  void cut(Index name, Excess&& excess, Cross&& cross);
  /// The corner that was kept at the other end of the lost corner's edge, or null.
  const Corner* kept_end(Index left, Index right) const;
  bool edges_form_one_ring() const;
  void update_radius();

  Vec3 site_;
  double radius_ = 0;
  bool sound_ = true;
  std::vector<Corner> corners_, kept_, lost_;
  std::vector<Edge> edges_;
};

}  // namespace carat
