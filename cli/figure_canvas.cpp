#include "cli/figure_canvas.h"

#include <cstring>
#include <numbers>

namespace carat::cli {
namespace {

constexpr double kRaisedSize = 0.72;
/// Parts of the size of a font.
constexpr double kRaise = 0.36;
constexpr double kHalfCapital = 0.36;

struct Run {
  std::string text;
  bool raised;
};

std::vector<Run> split_runs(const std::string& text) {
  std::vector<Run> runs;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t open = text.find("^{", at);
    const std::size_t close = open == std::string::npos ? open : text.find('}', open);
    if (close == std::string::npos) break;
    runs.push_back({text.substr(at, open - at), false});
    runs.push_back({text.substr(open + 2, close - open - 2), true});
    at = close + 1;
  }
  runs.push_back({text.substr(at), false});
  return runs;
}

}  // namespace

Canvas::Canvas(cairo_surface_t* surface) : cairo_(cairo_create(surface)) {
  // The same widths on every surface.
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(cairo_.get(), options);
  cairo_font_options_destroy(options);
  cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
}

void Canvas::set_font(double size, bool bold) const {
  cairo_select_font_face(cairo_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_.get(), size);
}

void Canvas::set_color(Color color) const {
  cairo_set_source_rgb(cairo_.get(), color.red, color.green, color.blue);
}

double Canvas::text_width(const std::string& text, const Font& font) const {
  double width = 0;
  for (const Run& run : split_runs(text)) {
    set_font(run.raised ? kRaisedSize * font.size : font.size, font.bold);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_.get(), run.text.c_str(), &extents);
    width += extents.x_advance;
  }
  return width;
}

void Canvas::text(Place place, const std::string& text, const Font& font, Align align,
                  double angle) const {
  const double share = align == Align::Left ? 0 : align == Align::Center ? 0.5 : 1;
  const double start = -share * text_width(text, font);
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), place.x, place.y);
  cairo_rotate(cairo_.get(), -angle * std::numbers::pi / 180);
  set_color(font.color);
  double x = start;
  for (const Run& run : split_runs(text)) {
    set_font(run.raised ? kRaisedSize * font.size : font.size, font.bold);
    cairo_move_to(cairo_.get(), x, (kHalfCapital - (run.raised ? kRaise : 0)) * font.size);
    cairo_show_text(cairo_.get(), run.text.c_str());
    // The text leaves a current point behind, from which the next line would start.
    cairo_new_path(cairo_.get());
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_.get(), run.text.c_str(), &extents);
    x += extents.x_advance;
  }
  cairo_restore(cairo_.get());
}

std::vector<std::string> Canvas::wrap(const std::string& text, const Font& font,
                                      double width) const {
  std::vector<std::string> lines(1);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (text_width(line + " " + word, font) <= width) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
    at = end + 1;
  }
  return lines;
}

void Canvas::line(const std::vector<Place>& points, double width, Color color,
                  const std::vector<double>& dashes) const {
  set_color(color);
  cairo_set_line_width(cairo_.get(), width);
  cairo_set_dash(cairo_.get(), dashes.data(), static_cast<int>(dashes.size()), 0);
  for (const Place& point : points) cairo_line_to(cairo_.get(), point.x, point.y);
  cairo_stroke(cairo_.get());
}

void Canvas::fill_rectangle(Place corner, Size size, Color color) const {
  set_color(color);
  cairo_rectangle(cairo_.get(), corner.x, corner.y, size.width, size.height);
  cairo_fill(cairo_.get());
}

void Canvas::stroke_rectangle(Place corner, Size size, double width, Color color) const {
  set_color(color);
  cairo_set_dash(cairo_.get(), nullptr, 0, 0);
  cairo_set_line_width(cairo_.get(), width);
  cairo_rectangle(cairo_.get(), corner.x, corner.y, size.width, size.height);
  cairo_stroke(cairo_.get());
}

void Canvas::fill_and_stroke(Color fill, Color outline, double width) const {
  set_color(fill);
  cairo_fill_preserve(cairo_.get());
  set_color(outline);
  cairo_set_dash(cairo_.get(), nullptr, 0, 0);
  cairo_set_line_width(cairo_.get(), width);
  cairo_stroke(cairo_.get());
}

void Canvas::polygon(const std::vector<Place>& points, Color fill, Color outline,
                     double width) const {
  for (const Place& point : points) cairo_line_to(cairo_.get(), point.x, point.y);
  cairo_close_path(cairo_.get());
  fill_and_stroke(fill, outline, width);
}

void Canvas::image(Place corner, Size size, const Image& image) const {
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> pixels(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height),
      &cairo_surface_destroy);
  unsigned char* const bytes = cairo_image_surface_get_data(pixels.get());
  if (bytes == nullptr) return;
  const int stride = cairo_image_surface_get_stride(pixels.get());
  for (int y = 0; y < image.height; ++y)
    std::memcpy(bytes + static_cast<std::ptrdiff_t>(y) * stride,
                image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.width,
                4 * static_cast<std::size_t>(image.width));
  cairo_surface_mark_dirty(pixels.get());
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), corner.x, corner.y);
  cairo_scale(cairo_.get(), size.width / image.width, size.height / image.height);
  cairo_set_source_surface(cairo_.get(), pixels.get(), 0, 0);
  cairo_paint(cairo_.get());
  cairo_restore(cairo_.get());
}

void Canvas::circle(Place center, double radius, Color fill, Color outline, double width) const {
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), center.x, center.y, radius, 0, 2 * std::numbers::pi);
  cairo_close_path(cairo_.get());
  fill_and_stroke(fill, outline, width);
}

void Canvas::begin_clip(Place corner, Size size) const {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), corner.x, corner.y, size.width, size.height);
  cairo_clip(cairo_.get());
}

void Canvas::end_clip() const { cairo_restore(cairo_.get()); }

}  // namespace carat::cli
