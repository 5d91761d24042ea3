// Ratios as a table of colours and numbers.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cli/figure_drawing.h"
#include "cli/figure_numbers.h"

namespace carat::cli {
namespace {

constexpr Font kCellFont{11, false, kBlack};
constexpr Font kHeadFont{11.5, false, kBlack};
constexpr double kRowHeight = 24;
constexpr double kKeyGap = 14;
constexpr double kNarrowest = 44;
constexpr double kWidest = 84;
constexpr double kHeadAngle = 45;

/// Colours from neutral to strong.
constexpr std::array kGood{rgb(0xf7f7f7), rgb(0x92c5de), rgb(0x2166ac)};
constexpr std::array kBad{rgb(0xf7f7f7), rgb(0xfdb863), rgb(0xb35806)};
constexpr Color kNone = rgb(0xffffff);

Color mix(Color a, Color b, double t) {
  return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
          a.blue + t * (b.blue - a.blue)};
}

/// Colours of ratios between 1/limit and limit.
class RatioColors {
 public:
  explicit RatioColors(const MatrixFigure& figure) : low_is_good_(figure.low_is_good) {
    double largest = 0;
    for (const auto& row : figure.values)
      for (const auto& value : row)
        if (value && *value > 0) largest = std::max(largest, std::abs(std::log(*value)));
    for (const double limit : {1.25, 1.5, 2.0, 3.0, 5.0, 10.0}) {
      limit_ = limit;
      if (std::log(limit) >= largest) break;
    }
    exceeded_ = largest > std::log(limit_);
  }

  double limit() const { return limit_; }
  /// Whether there are ratios beyond the limit.
  bool exceeded() const { return exceeded_; }

  Color operator()(double ratio) const {
    const double t = ratio > 0 ? std::clamp(std::log(ratio) / std::log(limit_), -1.0, 1.0) : -1.0;
    const auto& colors = (t < 0) == low_is_good_ ? kGood : kBad;
    const double at = 2 * std::abs(t);
    return at < 1 ? mix(colors[0], colors[1], at) : mix(colors[1], colors[2], at - 1);
  }

 private:
  bool low_is_good_;
  double limit_ = 1;
  bool exceeded_ = false;
};

Color ink_on(Color color) {
  const double light = 0.299 * color.red + 0.587 * color.green + 0.114 * color.blue;
  return light < 0.55 ? kWhite : kBlack;
}

/// The texts of the best values of a row; what is printed alike is as good.
std::string best_text(const std::vector<std::optional<double>>& row, bool low_is_good) {
  std::optional<double> best;
  for (const auto& value : row)
    if (value && (!best || (low_is_good ? *value < *best : *value > *best))) best = value;
  return best ? ratio_text(*best) : std::string();
}

void draw_bar(const Canvas& canvas, const MatrixFigure& figure, const RatioColors& colors,
              double middle, double y) {
  constexpr double kWidth = 240;
  constexpr double kHeight = 10;
  constexpr int kSteps = 120;
  const double left = middle - kWidth / 2;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2 * (i + 0.5) / kSteps - 1;
    // Overlapping, so that no seams show.
    canvas.fill_rectangle({left + kWidth * i / kSteps, y},
                          {kWidth / kSteps * (i + 1 < kSteps ? 1.5 : 1), kHeight},
                          colors(std::pow(colors.limit(), t)));
  }
  canvas.stroke_rectangle({left, y}, {kWidth, kHeight}, 0.6, kGray);
  canvas.line({{middle, y}, {middle, y + kHeight}}, 0.6, kGray);
  const std::string low = (colors.exceeded() ? "\u2264 " : "") + number_text(1 / colors.limit(), 2);
  const std::string high = (colors.exceeded() ? "\u2265 " : "") + number_text(colors.limit(), 3);
  canvas.text({left, y + kHeight + 11}, low, kCellFont, Align::Center);
  canvas.text({middle, y + kHeight + 11}, "1", kCellFont, Align::Center);
  canvas.text({left + kWidth, y + kHeight + 11}, high, kCellFont, Align::Center);
  canvas.text(
      {middle, y - 13},
      figure.value_title + (figure.low_is_good ? ", lower is better" : ", higher is better"),
      kHeadFont, Align::Center);
}

}  // namespace

Size draw_matrix(const Canvas& canvas, const MatrixFigure& figure, double top) {
  const std::size_t n_keys = figure.row_titles.size();
  std::vector<double> key_widths;
  double keys_width = 0;
  for (std::size_t k = 0; k < n_keys; ++k) {
    double width = canvas.text_width(figure.row_titles[k], kHeadFont);
    for (const auto& row : figure.rows)
      width = std::max(width, canvas.text_width(row[k], kHeadFont));
    key_widths.push_back(width + kKeyGap);
    keys_width += width + kKeyGap;
  }
  const double n_columns = static_cast<double>(figure.columns.size());
  double widest_head = 0;
  for (const std::string& column : figure.columns)
    widest_head = std::max(widest_head, canvas.text_width(column, kHeadFont));

  // Heads stand upright on the cells if they are wider than those, and the last ones lean over the
  // right end.
  const double slant = std::sin(kHeadAngle * std::numbers::pi / 180);
  const auto overhang = [&](double cell) {
    double over = 0;
    for (std::size_t j = 0; j < figure.columns.size(); ++j)
      over = std::max(over, (static_cast<double>(j) + 0.5 - n_columns) * cell + 6 +
                                slant * canvas.text_width(figure.columns[j], kHeadFont));
    return over;
  };
  const double room = kFigureWidth - 2 * kFigureMargin - keys_width;
  double cell = std::clamp(room / std::max(1.0, n_columns), kNarrowest, kWidest);
  const bool turned = widest_head + 8 > cell;
  if (turned)
    cell = std::clamp((room - overhang(cell)) / std::max(1.0, n_columns), kNarrowest, kWidest);
  const double over = turned ? overhang(cell) : 0;
  const double content = keys_width + n_columns * cell + over;
  const double width = std::max(kFigureWidth, content + 2 * kFigureMargin);

  const double keys_left = (width - content) / 2;
  const double left = keys_left + keys_width;
  const double first = top + (turned ? slant * widest_head + 18 : 28);
  double x = keys_left;
  for (std::size_t k = 0; k < n_keys; ++k) {
    canvas.text({x, first - 12}, figure.row_titles[k], {kHeadFont.size, true, kBlack}, Align::Left);
    x += key_widths[k];
  }
  for (std::size_t j = 0; j < figure.columns.size(); ++j) {
    const double middle = left + (static_cast<double>(j) + 0.5) * cell;
    if (turned) {
      canvas.text({middle, first - 8}, figure.columns[j], kHeadFont, Align::Left, kHeadAngle);
    } else {
      canvas.text({middle, first - 12}, figure.columns[j], kHeadFont, Align::Center);
    }
  }

  const RatioColors colors(figure);
  for (std::size_t i = 0; i < figure.rows.size(); ++i) {
    const double y = first + static_cast<double>(i) * kRowHeight;
    const bool new_group = i == 0 || figure.rows[i][0] != figure.rows[i - 1][0];
    if (n_keys > 1 && new_group)
      canvas.line({{keys_left, y}, {left + n_columns * cell, y}}, 0.8, kGray);
    x = keys_left;
    for (std::size_t k = 0; k < n_keys; ++k) {
      // A key that stays is written once.
      if (k > 0 || new_group || n_keys == 1)
        canvas.text({x, y + kRowHeight / 2}, figure.rows[i][k], kHeadFont, Align::Left);
      x += key_widths[k];
    }
    const std::string best = best_text(figure.values[i], figure.low_is_good);
    for (std::size_t j = 0; j < figure.columns.size(); ++j) {
      const auto& value = figure.values[i][j];
      const Color color = value ? colors(*value) : kNone;
      const double cell_left = left + static_cast<double>(j) * cell;
      canvas.fill_rectangle({cell_left + 1, y + 1}, {cell - 2, kRowHeight - 2}, color);
      const std::string text = value ? ratio_text(*value) : "\u2013";
      canvas.text({cell_left + cell / 2, y + kRowHeight / 2}, text,
                  {kCellFont.size, value && text == best, value ? ink_on(color) : kGray},
                  Align::Center);
    }
  }
  const double end = first + static_cast<double>(figure.rows.size()) * kRowHeight;
  if (n_keys > 1) canvas.line({{keys_left, end}, {left + n_columns * cell, end}}, 0.8, kGray);
  draw_bar(canvas, figure, colors, width / 2, end + 42);
  return {width, end + 42 + 28 + kFigureMargin};
}

}  // namespace carat::cli
