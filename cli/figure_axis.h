#pragma once
// Axes of figures: coordinates and ticks.

#include <string>
#include <vector>

namespace carat::cli {

enum class Scale { Linear, Log };

/// Where a value is on an axis: itself, or its decimal logarithm.
double coordinate(Scale scale, double value);

/// Whether a value has a place on an axis: it is finite, and positive if that is logarithmic.
bool can_show(Scale scale, double value);

/// A range of coordinates, empty at first.
struct Range {
  double low = 1;
  double high = 0;

  bool empty() const { return low > high; }
  double extent() const { return high - low; }
  void include(double value);
  void include(const Range& other);
  /// With space around the values, and some if there is one value or none.
  Range padded(double share) const;
};

struct Tick {
  double at;          ///< coordinate
  std::string label;  ///< ^{...} is raised
};

struct Axis {
  Scale scale = Scale::Linear;
  Range range;
  std::vector<Tick> ticks;
  std::vector<double> minor_ticks;

  /// 0 at the low end, 1 at the high end.
  double fraction(double at) const { return (at - range.low) / range.extent(); }
};

/// \param range    coordinates, not empty
/// \param spacing  the least distance of labels as a share of the axis
/// \param integer  ticks at whole numbers alone
Axis make_axis(Scale scale, const Range& range, double spacing, bool integer);

}  // namespace carat::cli
