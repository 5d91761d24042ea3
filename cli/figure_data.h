#pragma once
// What the figures of an experiment show, read from its rows; nothing here draws.

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "carat/report/html_view.h"
#include "cli/figure_axis.h"
#include "cli/figure_render.h"
#include "cli/session.h"

namespace carat::cli {

struct CurvePoint {
  double x;
  double y;
};

/// The points of one series in one panel, in the order of the rows. A row without a value that can
/// be shown ends a piece.
struct Curve {
  int series;  ///< its place in LinesFigure::series
  std::vector<std::vector<CurvePoint>> pieces;
  /// By least squares through the last three points (two if there are no more), in the coordinates
  /// of the axes.
  std::optional<double> slope;
};

struct Panel {
  std::string title;
  std::vector<Curve> curves;  ///< those with points
};

struct Series {
  std::string label;
  int style;  ///< its place among all series of the experiment
};

struct Reference {
  std::string label;
  double slope;
};

struct AxisText {
  std::string title;  ///< with the unit
  Scale scale = Scale::Linear;
  bool integer = false;
};

/// One panel a value of a column, with the same axes.
struct LinesFigure {
  AxisText x;
  AxisText y;
  std::vector<Series> series;  ///< those with points
  std::vector<Panel> panels;
  std::vector<Reference> references;
  bool slopes = false;
};

/// Ratios by rows and columns; 1 is neutral.
struct MatrixFigure {
  std::string value_title;
  std::vector<std::string> row_titles;
  std::vector<std::vector<std::string>> rows;  ///< a text for each of row_titles
  std::vector<std::string> columns;
  std::vector<std::vector<std::optional<double>>> values;  ///< by row and column
  bool low_is_good = true;
};

struct TableFigure {
  struct Column {
    std::string title;
    bool number;
    std::vector<std::string> cells;
  };
  std::vector<Column> columns;
};

/// Surfaces with values, coloured on one scale.
struct PictureFigure {
  std::string value_title;
  ColorScale scale{};
  std::vector<std::pair<std::string, Image>> images{};  ///< with their titles
};

struct Figure {
  std::string id;
  std::string title;
  std::variant<LinesFigure, MatrixFigure, TableFigure, PictureFigure> content;
};

/// Those of kind "picture" show `surfaces`, each with one field of its vertices; without any they
/// are left out.
/// \throws InvalidOption  a figure names a column that does not exist, shows text as numbers, has
///                        two rows for one place of a matrix, or lacks something
std::vector<Figure> read_figures(const Json& experiment,
                                 const std::vector<ViewItem>& surfaces = {});

/// The least-squares slope, if the x differ.
std::optional<double> fitted_slope(const std::vector<CurvePoint>& points);

}  // namespace carat::cli
