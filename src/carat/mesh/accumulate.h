#pragma once
// What both kinds of statistics sum up with.

#include <algorithm>
#include <limits>

#include "carat/base/types.h"
#include "carat/mesh/statistics.h"

namespace carat::detail {

/// Compensated sum: plain sums of 10^6 equal areas lose five digits.
class Sum {
 public:
  void add(double value) {
    const double corrected = value - carry_;
    const double next = sum_ + corrected;
    carry_ = (next - sum_) - corrected;
    sum_ = next;
  }
  double value() const { return sum_; }

 private:
  double sum_ = 0, carry_ = 0;
};

/// Minimum, mean and maximum of what is added.
class RangeOf {
 public:
  void add(double value) {
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
    sum_.add(value);
    ++n_;
  }
  double sum() const { return sum_.value(); }
  Range range() const {
    if (n_ == 0) return {};
    // The rounded mean of equal values may leave their range by one unit.
    return {min_, std::clamp(sum_.value() / n_, min_, max_), max_};
  }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  Sum sum_;
  double n_ = 0;
};

/// Disjoint sets of numbers; the root of a set is its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(static_cast<std::size_t>(n)) {
    for (Index i = 0; i < n; ++i) parent_[i] = i;
  }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Index i, Index j) {
    i = root(i);
    j = root(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  Array<Index> parent_;
};

}  // namespace carat::detail
