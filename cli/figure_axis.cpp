#include "cli/figure_axis.h"

#include <algorithm>
#include <cmath>

#include "cli/figure_numbers.h"

namespace carat::cli {
namespace {

/// The least number of labels that tell the scale of a logarithmic axis.
constexpr std::size_t kEnoughDecades = 3;

bool holds(const Range& range, double at) {
  const double slack = 1e-9 * range.extent();
  return at >= range.low - slack && at <= range.high + slack;
}

/// 1, 2 or 5 times a power of ten, not below `least`.
double nice_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

std::vector<Tick> linear_ticks(const Range& values, double step) {
  const double largest = std::max(std::abs(values.low), std::abs(values.high));
  const bool plain = largest < 1e5 && step >= 1e-4;
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  std::vector<Tick> ticks;
  for (double i = std::ceil(values.low / step - 1e-9); holds(values, i * step); ++i) {
    const double value = i * step;
    ticks.push_back({value, plain ? fixed_text(value, decimals) : number_text(value, 6)});
    // Ticks from 100 000 on are round numbers, which a power of ten shortens.
    if (!plain && std::abs(value) >= 1e5) {
      const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
      ticks.back().label = power_text(number_text(value / std::pow(10.0, exponent), 4), exponent);
    }
  }
  return ticks;
}

/// Coordinates of the digits times every power of ten in a range.
struct LogTick {
  int digit;
  int exponent;
  double at() const { return std::log10(digit) + exponent; }
};

std::vector<LogTick> log_ticks(const Range& range, std::initializer_list<int> digits,
                               int stride = 1) {
  std::vector<LogTick> ticks;
  for (int exponent = static_cast<int>(std::floor(range.low)); exponent <= std::ceil(range.high);
       ++exponent)
    for (const int digit : digits)
      if (exponent % stride == 0 && holds(range, LogTick{digit, exponent}.at()))
        ticks.push_back({digit, exponent});
  return ticks;
}

std::vector<Tick> labelled(const std::vector<LogTick>& ticks) {
  const bool plain = std::all_of(ticks.begin(), ticks.end(), [](const LogTick& tick) {
    return tick.exponent >= -3 && tick.exponent <= 3;
  });
  std::vector<Tick> out;
  for (const LogTick& tick : ticks)
    out.push_back({tick.at(), plain ? number_text(tick.digit * std::pow(10.0, tick.exponent), 1)
                                    : power_text(std::to_string(tick.digit), tick.exponent)});
  return out;
}

void add_log_ticks(Axis& axis, double spacing) {
  const Range& range = axis.range;
  const double least = spacing * range.extent();
  const int stride = std::max(1, static_cast<int>(std::ceil(least)));
  const std::vector<LogTick> decades = log_ticks(range, {1}, stride);
  const auto minor =
      stride == 1 ? log_ticks(range, {1, 2, 3, 4, 5, 6, 7, 8, 9}) : log_ticks(range, {1});
  for (const LogTick& tick : minor) axis.minor_ticks.push_back(tick.at());
  axis.ticks = labelled(decades);
  if (stride > 1 || decades.size() >= kEnoughDecades) return;
  struct Choice {
    std::vector<LogTick> ticks;
    double distance;
  };
  for (const Choice& choice :
       {Choice{log_ticks(range, {1, 2, 5}), std::log10(2.0)},
        Choice{log_ticks(range, {1, 3}), std::log10(3.0)},
        Choice{log_ticks(range, {1, 2, 3, 4, 5, 6, 7, 8, 9}), std::log10(10.0 / 9.0)}})
    if (choice.distance >= least && choice.ticks.size() >= 2) {
      axis.ticks = labelled(choice.ticks);
      return;
    }
  if (decades.size() >= 2) return;
  // So short that equal steps are nearly equal on the axis.
  const Range values{std::pow(10.0, range.low), std::pow(10.0, range.high)};
  axis.ticks = linear_ticks(values, nice_step(1.5 * spacing * values.extent()));
  for (Tick& tick : axis.ticks) tick.at = std::log10(tick.at);
}

}  // namespace

double coordinate(Scale scale, double value) {
  return scale == Scale::Log ? std::log10(value) : value;
}

bool can_show(Scale scale, double value) {
  return std::isfinite(value) && (scale == Scale::Linear || value > 0);
}

void Range::include(double value) {
  const bool first = empty();
  low = first ? value : std::min(low, value);
  high = first ? value : std::max(high, value);
}

void Range::include(const Range& other) {
  if (other.empty()) return;
  include(other.low);
  include(other.high);
}

Range Range::padded(double share) const {
  if (empty()) return {0, 1};
  const double least = 1e-9 * std::max(std::abs(low), std::abs(high));
  if (extent() <= least) return {low - 0.5, high + 0.5};
  return {low - share * extent(), high + share * extent()};
}

Axis make_axis(Scale scale, const Range& range, double spacing, bool integer) {
  Axis axis{scale, range, {}, {}};
  if (scale == Scale::Log) {
    add_log_ticks(axis, spacing);
    return axis;
  }
  const double step = nice_step(spacing * range.extent());
  axis.ticks = linear_ticks(range, integer ? std::max(1.0, step) : step);
  return axis;
}

}  // namespace carat::cli
