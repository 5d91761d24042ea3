#pragma once
// What figures are drawn with: lines, areas and text on a cairo surface.

#include <cairo.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/figure_image.h"

namespace carat::cli {

inline constexpr Color kBlack = rgb(0x1a1a1a);
inline constexpr Color kGray = rgb(0x666666);
inline constexpr Color kLightGray = rgb(0xe2e2e2);
inline constexpr Color kWhite = rgb(0xffffff);

struct Place {
  double x;
  double y;  ///< downwards
};

struct Size {
  double width;
  double height;
};

struct Font {
  double size = 12;
  bool bold = false;
  Color color = kBlack;
};

/// Which part of a text is at its place.
enum class Align { Left, Center, Right };

class Canvas {
 public:
  explicit Canvas(cairo_surface_t* surface);

  /// One line of text, centred vertically; ^{...} is raised. Turned to the left by an angle in
  /// degrees around its place.
  void text(Place place, const std::string& text, const Font& font, Align align,
            double angle = 0) const;
  double text_width(const std::string& text, const Font& font) const;
  /// A text as lines of at most that width; a longer word has a line of its own.
  std::vector<std::string> wrap(const std::string& text, const Font& font, double width) const;

  void line(const std::vector<Place>& points, double width, Color color,
            const std::vector<double>& dashes = {}) const;
  void fill_rectangle(Place corner, Size size, Color color) const;
  void stroke_rectangle(Place corner, Size size, double width, Color color) const;
  /// A closed shape with an outline.
  void polygon(const std::vector<Place>& points, Color fill, Color outline, double width) const;
  void image(Place corner, Size size, const Image& image) const;
  void circle(Place center, double radius, Color fill, Color outline, double width) const;

  /// Nothing is drawn outside of a rectangle until end_clip.
  void begin_clip(Place corner, Size size) const;
  void end_clip() const;

 private:
  struct Destroy {
    void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
  };
  void set_font(double size, bool bold) const;
  void set_color(Color color) const;
  void fill_and_stroke(Color fill, Color outline, double width) const;

  std::unique_ptr<cairo_t, Destroy> cairo_;
};

}  // namespace carat::cli
