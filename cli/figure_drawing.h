#pragma once
// Figures as pictures.

#include <string>

#include "cli/figure_canvas.h"
#include "cli/figure_data.h"

namespace carat::cli {

/// A figure is this wide unless it needs more.
inline constexpr double kFigureWidth = 900;
/// Around a figure.
inline constexpr double kFigureMargin = 24;
/// Pixels of an image a unit of length.
inline constexpr int kImageScale = 2;

/// The bytes of two files.
struct Picture {
  std::string svg;
  std::string png;
};

/// \throws InvalidOption  more rows than an image can hold
Picture draw_figure(const Figure& figure);

/// The four kinds, from a line `top` downwards. They return the figure's size.
Size draw_lines(const Canvas& canvas, const LinesFigure& figure, double top);
Size draw_matrix(const Canvas& canvas, const MatrixFigure& figure, double top);
Size draw_table(const Canvas& canvas, const TableFigure& figure, double top);
Size draw_picture(const Canvas& canvas, const PictureFigure& figure, double top);

}  // namespace carat::cli
