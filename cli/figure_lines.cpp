// Curves in panels of the same axes.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cli/figure_drawing.h"
#include "cli/figure_numbers.h"

namespace carat::cli {
namespace {

// Colours that people who see red and green alike tell apart, after Okabe and Ito.
constexpr std::array kColors{rgb(0x0072b2), rgb(0xd55e00), rgb(0x009e73), rgb(0xcc79a7),
                             rgb(0xe69f00), rgb(0x56b4e9), rgb(0x000000)};
/// A marker is a polygon: corners, turned by degrees, and the radius of every other corner.
struct Marker {
  int corners;  ///< 0: a circle
  double turned;
  double size;  ///< so that all look alike in size
  double notch;
};
constexpr std::array<Marker, 7> kMarkers{{{0, 0, 1, 1},
                                          {4, 45, 1.25, 1},
                                          {3, 0, 1.35, 1},
                                          {4, 0, 1.3, 1},
                                          {3, 180, 1.35, 1},
                                          {10, 0, 1.55, 0.45},
                                          {5, 0, 1.2, 1}}};
constexpr double kMarkerRadius = 3.6;

constexpr Font kTickFont{11, false, kBlack};
constexpr Font kAxisFont{12, false, kBlack};
constexpr Font kPanelFont{12, true, kBlack};
constexpr Font kSmallFont{10.5, false, kGray};
constexpr double kSmallLine = 15;

/// Share of the data's range that is left free around it.
constexpr double kPadding = 0.05;
/// Panels share the x axis unless that makes the longest of them shorter than its part.
constexpr double kSharedPart = 0.6;

/// A dashed line in the coordinates of the axes.
struct ReferenceLine {
  CurvePoint from;
  CurvePoint to;  ///< where its label is
  std::string label;
};

struct PanelLayout {
  const Panel* panel = nullptr;
  Range x;
  Range y;
  std::vector<ReferenceLine> references;
};

void draw_marker(const Canvas& canvas, Place center, int style) {
  const int n = static_cast<int>(kColors.size());
  const Color color = kColors[static_cast<std::size_t>(style % n)];
  const Marker& marker = kMarkers[static_cast<std::size_t>((style + style / n) % n)];
  const bool open = style / n % 2 == 1;
  const Color fill = open ? kWhite : color;
  const Color outline = open ? color : kWhite;
  const double width = open ? 1.3 : 0.7;
  const double radius = marker.size * (open ? kMarkerRadius - 0.4 : kMarkerRadius);
  if (marker.corners == 0) {
    canvas.circle(center, radius, fill, outline, width);
    return;
  }
  std::vector<Place> corners;
  for (int i = 0; i < marker.corners; ++i) {
    const double angle = (marker.turned + 360.0 * i / marker.corners) * std::numbers::pi / 180;
    const double r = i % 2 == 1 ? marker.notch * radius : radius;
    corners.push_back({center.x + r * std::sin(angle), center.y - r * std::cos(angle)});
  }
  canvas.polygon(corners, fill, outline, width);
}

Color series_color(int style) { return kColors[static_cast<std::size_t>(style) % kColors.size()]; }

/// Calls visit(piece) with the coordinates of every piece of a panel.
template <class Visit>
void for_each_piece(const LinesFigure& figure, const Panel& panel, Visit&& visit) {
  for (const Curve& curve : panel.curves)
    for (const auto& piece : curve.pieces) {
      std::vector<CurvePoint> points;
      for (const CurvePoint& point : piece)
        points.push_back(
            {coordinate(figure.x.scale, point.x), coordinate(figure.y.scale, point.y)});
      visit(curve, points);
    }
}

/// How far a line through the origin of that slope must be moved up to touch the curves from below
/// between two x; infinite if there are none.
double support(const LinesFigure& figure, const Panel& panel, double slope, const Range& window) {
  double lowest = std::numeric_limits<double>::infinity();
  const auto meet = [&](double x, double y) { lowest = std::min(lowest, y - slope * x); };
  for_each_piece(figure, panel, [&](const Curve&, const std::vector<CurvePoint>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const CurvePoint a = points[i];
      const CurvePoint b = points[std::min(i + 1, points.size() - 1)];
      const double low = std::max(std::min(a.x, b.x), window.low);
      const double high = std::min(std::max(a.x, b.x), window.high);
      if (low > high) continue;
      for (const double x : {low, high})
        meet(x, a.x == b.x ? std::min(a.y, b.y) : a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x));
    }
  });
  return lowest;
}

/// Lines from one point, below all curves; they open towards the side where those are high.
void add_references(const LinesFigure& figure, PanelLayout& layout) {
  if (figure.references.empty() || layout.x.empty() || !(layout.x.extent() > 0)) return;
  const bool rising = figure.references.front().slope >= 0;
  const double low_end = rising ? layout.x.low : layout.x.high;
  const double length = rising ? layout.x.extent() : -layout.x.extent();
  const double from = low_end + 0.1 * length;
  const double to = low_end + 0.5 * length;
  Range window;
  window.include(from);
  window.include(low_end + 0.75 * length);  // the label too is below the curves
  double start = std::numeric_limits<double>::infinity();
  for (const Reference& reference : figure.references)
    start = std::min(
        start, support(figure, *layout.panel, reference.slope, window) + reference.slope * from);
  if (!std::isfinite(start)) return;
  start -= 0.07 * (layout.y.extent() > 0 ? layout.y.extent() : 1);
  for (const Reference& reference : figure.references) {
    const double end = start + reference.slope * (to - from);
    layout.references.push_back({{from, start}, {to, end}, reference.label});
    layout.y.include(end);
  }
  layout.y.include(start);
}

std::vector<PanelLayout> lay_out(const LinesFigure& figure) {
  std::vector<PanelLayout> layouts;
  for (const Panel& panel : figure.panels) {
    PanelLayout& layout = layouts.emplace_back();
    layout.panel = &panel;
    for_each_piece(figure, panel, [&](const Curve&, const std::vector<CurvePoint>& points) {
      for (const CurvePoint& point : points) {
        layout.x.include(point.x);
        layout.y.include(point.y);
      }
    });
    add_references(figure, layout);
  }
  Range shared;
  double longest = 0;
  for (const PanelLayout& layout : layouts) {
    shared.include(layout.x);
    longest = std::max(longest, layout.x.extent());
  }
  for (PanelLayout& layout : layouts)
    if (layout.x.empty() || longest >= kSharedPart * shared.extent()) layout.x = shared;
  return layouts;
}

/// A panel's frame with its axes.
struct Frame {
  Place corner;
  Size size;
  Axis x;
  Axis y;

  Place at(const CurvePoint& point) const {
    return {corner.x + size.width * x.fraction(point.x),
            corner.y + size.height * (1 - y.fraction(point.y))};
  }
};

void draw_frame(const Canvas& canvas, const Frame& frame, bool y_labels) {
  const double right = frame.corner.x + frame.size.width;
  const double bottom = frame.corner.y + frame.size.height;
  for (const Tick& tick : frame.x.ticks) {
    const double x = frame.at({tick.at, 0}).x;
    canvas.line({{x, frame.corner.y}, {x, bottom}}, 0.8, kLightGray);
    canvas.text({x, bottom + 12}, tick.label, kTickFont, Align::Center);
  }
  for (const Tick& tick : frame.y.ticks) {
    const double y = frame.at({0, tick.at}).y;
    canvas.line({{frame.corner.x, y}, {right, y}}, 0.8, kLightGray);
    if (y_labels) canvas.text({frame.corner.x - 6, y}, tick.label, kTickFont, Align::Right);
  }
  for (const double at : frame.x.minor_ticks) {
    const double x = frame.at({at, 0}).x;
    canvas.line({{x, bottom - 3}, {x, bottom}}, 0.7, kGray);
  }
  for (const double at : frame.y.minor_ticks) {
    const double y = frame.at({0, at}).y;
    canvas.line({{frame.corner.x, y}, {frame.corner.x + 3, y}}, 0.7, kGray);
  }
  canvas.stroke_rectangle(frame.corner, frame.size, 0.8, kGray);
}

void draw_references(const Canvas& canvas, const Frame& frame,
                     const std::vector<ReferenceLine>& references) {
  // Labels from the lowest upwards, each above the one before.
  std::vector<ReferenceLine> sorted = references;
  std::sort(sorted.begin(), sorted.end(), [&](const ReferenceLine& a, const ReferenceLine& b) {
    return frame.at(a.to).y > frame.at(b.to).y;
  });
  double highest = std::numeric_limits<double>::infinity();
  for (const ReferenceLine& reference : sorted) {
    const Place from = frame.at(reference.from);
    const Place to = frame.at(reference.to);
    const bool rightwards = to.x >= from.x;
    canvas.line({from, to}, 1.1, kGray, {4, 3});
    highest = std::min(to.y, highest - 13);
    canvas.text({to.x + (rightwards ? 5 : -5), highest}, reference.label, kSmallFont,
                rightwards ? Align::Left : Align::Right);
  }
}

void draw_curves(const Canvas& canvas, const LinesFigure& figure, const Frame& frame,
                 const Panel& panel) {
  const auto style = [&](const Curve& curve) {
    return figure.series[static_cast<std::size_t>(curve.series)].style;
  };
  for_each_piece(figure, panel, [&](const Curve& curve, const std::vector<CurvePoint>& points) {
    std::vector<Place> places;
    for (const CurvePoint& point : points) places.push_back(frame.at(point));
    canvas.line(places, 1.6, series_color(style(curve)));
  });
  for_each_piece(figure, panel, [&](const Curve& curve, const std::vector<CurvePoint>& points) {
    for (const CurvePoint& point : points) draw_marker(canvas, frame.at(point), style(curve));
  });
}

/// The slopes of a panel above its frame, line by line.
class SlopeStrip {
 public:
  SlopeStrip(const Canvas& canvas, double width) : canvas_(canvas) {
    start_ = canvas.text_width(kTitle, kSmallFont) + 8;
    per_line_ = std::max(1, static_cast<int>((width - start_) / kEntry));
  }

  double height(const LinesFigure& figure) const {
    std::size_t most = 0;
    for (const Panel& panel : figure.panels) most = std::max(most, slopes(panel).size());
    const int n = static_cast<int>(most);
    return kSmallLine * ((n + per_line_ - 1) / per_line_);
  }

  void draw(const LinesFigure& figure, const Panel& panel, Place corner) const {
    const std::vector<const Curve*> curves = slopes(panel);
    if (curves.empty()) return;
    canvas_.text({corner.x, corner.y + kSmallLine / 2}, kTitle, kSmallFont, Align::Left);
    for (int i = 0; i < static_cast<int>(curves.size()); ++i) {
      const Curve& curve = *curves[static_cast<std::size_t>(i)];
      const Place place{corner.x + start_ + kEntry * (i % per_line_) + 4,
                        corner.y + kSmallLine * (i / per_line_ + 0.5)};
      draw_marker(canvas_, place, figure.series[static_cast<std::size_t>(curve.series)].style);
      canvas_.text({place.x + 7, place.y}, fixed_text(*curve.slope, 2),
                   {kSmallFont.size, false, kBlack}, Align::Left);
    }
  }

 private:
  static constexpr const char* kTitle = "slope";
  static constexpr double kEntry = 49;

  static std::vector<const Curve*> slopes(const Panel& panel) {
    std::vector<const Curve*> curves;
    for (const Curve& curve : panel.curves)
      if (curve.slope) curves.push_back(&curve);
    return curves;
  }

  const Canvas& canvas_;
  double start_;
  int per_line_;
};

/// Returns the height.
double draw_legend(const Canvas& canvas, const LinesFigure& figure, double top) {
  const int n = static_cast<int>(figure.series.size());
  if (n < 2 && (n == 0 || figure.series[0].label.empty())) return 0;
  constexpr double kSample = 34;
  constexpr double kGap = 22;
  constexpr double kLine = 19;
  double widest = 0;
  for (const Series& series : figure.series)
    widest = std::max(widest, kSample + canvas.text_width(series.label, kAxisFont));
  const double room = kFigureWidth - 2 * kFigureMargin;
  const int fit = std::clamp(static_cast<int>((room + kGap) / (widest + kGap)), 1, n);
  const int n_lines = (n + fit - 1) / fit;
  const int per_line = (n + n_lines - 1) / n_lines;
  const double left = (kFigureWidth - per_line * widest - (per_line - 1) * kGap) / 2;
  for (int i = 0; i < n; ++i) {
    const Series& series = figure.series[static_cast<std::size_t>(i)];
    const Place place{left + (i % per_line) * (widest + kGap), top + kLine * (i / per_line + 0.5)};
    canvas.line({place, {place.x + kSample - 8, place.y}}, 1.6, series_color(series.style));
    draw_marker(canvas, {place.x + (kSample - 8) / 2, place.y}, series.style);
    canvas.text({place.x + kSample, place.y}, series.label, kAxisFont, Align::Left);
  }
  return kLine * n_lines;
}

int panels_per_line(int n) {
  if (n <= 3) return n;
  if (n == 4) return 2;
  return n <= 9 ? 3 : 4;
}

}  // namespace

Size draw_lines(const Canvas& canvas, const LinesFigure& figure, double top) {
  const std::vector<PanelLayout> layouts = lay_out(figure);
  const int n = static_cast<int>(layouts.size());
  if (n == 0) {
    canvas.text({kFigureWidth / 2, top + 30}, "no rows", kAxisFont, Align::Center);
    return {kFigureWidth, top + 60 + kFigureMargin};
  }
  const int across = panels_per_line(n);
  constexpr std::array kPanelHeights{400.0, 290.0, 220.0, 180.0};
  constexpr double kGap = 26;
  const double height = kPanelHeights[static_cast<std::size_t>(across - 1)];
  Range y_range;
  for (const PanelLayout& layout : layouts) y_range.include(layout.y);
  const Axis y_axis =
      make_axis(figure.y.scale, y_range.padded(kPadding), 24 / height, figure.y.integer);
  double labels = 0;
  for (const Tick& tick : y_axis.ticks)
    labels = std::max(labels, canvas.text_width(tick.label, kTickFont));
  const double left = kFigureMargin + 24 + labels + 6;
  const double width = (kFigureWidth - kFigureMargin - 4 - left - (across - 1) * kGap) / across;

  const SlopeStrip strip(canvas, width);
  const bool titled = n > 1 || !figure.panels[0].title.empty();
  const double strip_height = figure.slopes ? strip.height(figure) : 0;
  const double header = (titled ? 20 : 0) + strip_height + 5;
  const double pitch = header + height + 34;
  for (int i = 0; i < n; ++i) {
    const PanelLayout& layout = layouts[static_cast<std::size_t>(i)];
    const Place corner{left + (i % across) * (width + kGap), top + (i / across) * pitch};
    if (titled) {
      Font font = kPanelFont;
      font.size *= std::min(1.0, width / canvas.text_width(layout.panel->title, font));
      canvas.text({corner.x + width / 2, corner.y + 8}, layout.panel->title, font, Align::Center);
    }
    if (figure.slopes) strip.draw(figure, *layout.panel, {corner.x, corner.y + (titled ? 20 : 0)});
    const Frame frame{
        {corner.x, corner.y + header},
        {width, height},
        make_axis(figure.x.scale, layout.x.padded(kPadding), 46 / width, figure.x.integer),
        y_axis};
    draw_frame(canvas, frame, i % across == 0);
    canvas.begin_clip(frame.corner, frame.size);
    draw_references(canvas, frame, layout.references);
    draw_curves(canvas, figure, frame, *layout.panel);
    canvas.end_clip();
    if (layout.panel->curves.empty())
      canvas.text({frame.corner.x + width / 2, frame.corner.y + height / 2}, "no values",
                  {kAxisFont.size, false, kGray}, Align::Center);
  }

  const int lines = (n + across - 1) / across;
  const double bottom = top + lines * pitch - 10;
  canvas.text({kFigureMargin + 8, (top + header + bottom - 24) / 2}, figure.y.title, kAxisFont,
              Align::Center, 90);
  const double middle = left + (across * (width + kGap) - kGap) / 2;
  canvas.text({middle, bottom + 10}, figure.x.title, kAxisFont, Align::Center);
  const double legend = draw_legend(canvas, figure, bottom + 32);
  return {kFigureWidth, bottom + 20 + (legend > 0 ? legend + 12 : 0) + kFigureMargin - 4};
}

}  // namespace carat::cli
