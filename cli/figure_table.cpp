// A plain table.

#include <algorithm>

#include "cli/figure_drawing.h"

namespace carat::cli {
namespace {

constexpr Font kHeadFont{12, true, kBlack};
constexpr Font kCellFont{12, false, kBlack};
constexpr double kLine = 16;
constexpr double kRowHeight = 22;
/// Titles wrap to this width where the cells are narrower.
constexpr double kTitleWidth = 110;
constexpr double kLeastGap = 22;
constexpr double kLargestGap = 60;

}  // namespace

Size draw_table(const Canvas& canvas, const TableFigure& figure, double top) {
  struct Layout {
    std::vector<std::string> title;
    double width = 0;
  };
  std::vector<Layout> layouts;
  double text_width = 0;
  std::size_t n_title_lines = 1;
  std::size_t n_rows = 0;
  for (const auto& column : figure.columns) {
    Layout& layout = layouts.emplace_back();
    for (const std::string& cell : column.cells)
      layout.width = std::max(layout.width, canvas.text_width(cell, kCellFont));
    layout.title = canvas.wrap(column.title, kHeadFont, std::max(kTitleWidth, layout.width));
    for (const std::string& line : layout.title)
      layout.width = std::max(layout.width, canvas.text_width(line, kHeadFont));
    text_width += layout.width;
    n_title_lines = std::max(n_title_lines, layout.title.size());
    n_rows = column.cells.size();
  }
  const double n_gaps = std::max(1.0, static_cast<double>(figure.columns.size()) - 1);
  const double gap = std::clamp((kFigureWidth - 2 * kFigureMargin - 16 - text_width) / n_gaps,
                                kLeastGap, kLargestGap);
  const double content = text_width + n_gaps * gap + 16;
  const double width = std::max(kFigureWidth, content + 2 * kFigureMargin);
  const double left = (width - content) / 2;
  const double right = left + content;

  const double rule = top + 6;
  const double first = rule + kLine * static_cast<double>(n_title_lines) + 12;
  canvas.line({{left, rule}, {right, rule}}, 1.4, kBlack);
  canvas.line({{left, first}, {right, first}}, 0.8, kBlack);
  for (std::size_t i = 1; i < n_rows; ++i) {
    const auto& groups = figure.columns[0].cells;
    const double y = first + kRowHeight * static_cast<double>(i) + 3;
    if (groups[i] != groups[i - 1]) canvas.line({{left, y}, {right, y}}, 0.6, kLightGray);
  }
  double x = left + 8;
  for (std::size_t j = 0; j < layouts.size(); ++j) {
    const bool number = figure.columns[j].number;
    const double at = number ? x + layouts[j].width : x;
    const Align align = number ? Align::Right : Align::Left;
    // Titles stand on the rule.
    double y = first - 6 - kLine * (static_cast<double>(layouts[j].title.size()) - 0.5);
    for (const std::string& line : layouts[j].title) {
      canvas.text({at, y}, line, kHeadFont, align);
      y += kLine;
    }
    y = first + 3 + kRowHeight / 2;
    for (const std::string& cell : figure.columns[j].cells) {
      canvas.text({at, y}, cell, kCellFont, align);
      y += kRowHeight;
    }
    x += layouts[j].width + gap;
  }
  const double end = first + kRowHeight * static_cast<double>(n_rows) + 6;
  canvas.line({{left, end}, {right, end}}, 1.4, kBlack);
  return {width, end + kFigureMargin};
}

}  // namespace carat::cli
