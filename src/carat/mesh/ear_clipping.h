#pragma once
// Cuts plane polygons into triangles; the buffers are kept from one polygon to the next.

#include <array>
#include <span>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Ear clipping, shortest diagonal first.
///
/// An ear is a convex corner whose triangle holds no reflex corner. The reflex corners are kept in
/// a k-d tree, so that a polygon of n corners costs O(n log n) for convex ones and about
/// O(n^1.5) at worst, not O(n^2).
class EarClipper {
 public:
  using Triangle = std::array<Index, 3>;

  /// \param polygon  corners in order, counter-clockwise, of extent about 1
  /// \return the n - 2 triangles as corner numbers, counter-clockwise; empty if the polygon is not
  ///         simple. Valid until the next call.
  const std::vector<Triangle>& cut(std::span<const Vec2> polygon);

 private:
  struct Ear {
    double diagonal;  ///< squared length
    Index corner, version;

    static bool comes_later(const Ear& a, const Ear& b) {
      return a.diagonal != b.diagonal ? a.diagonal > b.diagonal : a.corner > b.corner;
    }
  };
  struct Box {
    Vec2 lower, upper;
  };

  bool is_convex(Index corner) const;
  bool is_ear(Index corner) const;
  bool holds_reflex(const std::array<Vec2, 3>& triangle, Index node, Index begin, Index end) const;
  void build_tree(Index node, Index begin, Index end);
  void remove_from_tree(Index corner);
  void push_if_ear(Index corner);
  Index first_left() const { return triangles_.empty() ? 0 : triangles_.back()[2]; }
  bool rest_is_flat() const;
  bool turns_once() const;

  std::span<const Vec2> points_;
  std::vector<Index> previous_, next_, version_;
  std::vector<bool> reflex_;
  std::vector<Index> tree_;   ///< reflex corners, the halves of every range split in space
  std::vector<Index> place_;  ///< corner -> its entry in tree_
  std::vector<Box> boxes_;    ///< node -> bounding box of its range
  std::vector<Index> alive_;  ///< node -> reflex corners left in its range
  std::vector<Ear> heap_;
  std::vector<Triangle> triangles_;
};

}  // namespace carat
