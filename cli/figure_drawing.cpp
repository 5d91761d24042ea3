#include "cli/figure_drawing.h"

#include <cairo-svg.h>

#include <cmath>
#include <memory>

#include "carat/base/error.h"

namespace carat::cli {
namespace {

/// The most pixels of an image in one direction.
constexpr double kLargestImage = 32000;

struct DestroySurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(bytes)->append(data, data + length);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status, const Figure& figure) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw Error("figure '" + figure.id + "' cannot be drawn: " + cairo_status_to_string(status));
}

/// \param width  of the figure, once it is known
Size draw(cairo_surface_t* surface, const Figure& figure, double width) {
  const Canvas canvas(surface);
  canvas.fill_rectangle({0, 0}, {kLargestImage, kLargestImage}, kWhite);
  const Font font{15, true, kBlack};
  double y = kFigureMargin + 6;
  for (const std::string& line :
       canvas.wrap(figure.title, font, kFigureWidth - 2 * kFigureMargin)) {
    canvas.text({width / 2, y}, line, font, Align::Center);
    y += 20;
  }
  struct Draw {
    const Canvas& canvas;
    double top;
    Size operator()(const LinesFigure& lines) const { return draw_lines(canvas, lines, top); }
    Size operator()(const MatrixFigure& matrix) const { return draw_matrix(canvas, matrix, top); }
    Size operator()(const TableFigure& table) const { return draw_table(canvas, table, top); }
    Size operator()(const PictureFigure& picture) const {
      return draw_picture(canvas, picture, top);
    }
  };
  const Size size = std::visit(Draw{canvas, y}, figure.content);
  return {std::ceil(size.width), std::ceil(size.height)};
}

}  // namespace

Picture draw_figure(const Figure& figure) {
  // Drawn once for its size.
  const Surface trial(cairo_recording_surface_create(CAIRO_CONTENT_COLOR, nullptr));
  const Size size = draw(trial.get(), figure, kFigureWidth);
  if (kImageScale * std::max(size.width, size.height) > kLargestImage)
    throw InvalidOption("figure '" + figure.id + "' would be " +
                        std::to_string(std::lround(size.width)) + " wide and " +
                        std::to_string(std::lround(size.height)) +
                        " high, too large for an image; filter its rows");

  Picture picture;
  const Surface svg(
      cairo_svg_surface_create_for_stream(append, &picture.svg, size.width, size.height));
  cairo_svg_surface_set_document_unit(svg.get(), CAIRO_SVG_UNIT_PX);
  draw(svg.get(), figure, size.width);
  cairo_surface_finish(svg.get());
  check(cairo_surface_status(svg.get()), figure);

  const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                                 kImageScale * static_cast<int>(size.width),
                                                 kImageScale * static_cast<int>(size.height)));
  cairo_surface_set_device_scale(image.get(), kImageScale, kImageScale);
  draw(image.get(), figure, size.width);
  check(cairo_surface_status(image.get()), figure);
  check(cairo_surface_write_to_png_stream(image.get(), append, &picture.png), figure);
  return picture;
}

}  // namespace carat::cli
