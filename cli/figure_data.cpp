#include "cli/figure_data.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "carat/base/error.h"
#include "cli/figure_numbers.h"

namespace carat::cli {
namespace {

/// Digits of a number in a table.
constexpr int kTableDigits = 4;
/// Points of a curve that its slope is fitted to.
constexpr std::size_t kSlopePoints = 3;
const std::string kDash = "\u2013";

struct Column {
  std::size_t index;
  std::string name;
  std::string title;
  std::string unit;
  std::string kind;

  std::string full_title() const { return unit.empty() ? title : title + " (" + unit + ")"; }
};

/// The rows of an experiment as one figure sees them.
class Rows {
 public:
  Rows(const Json& experiment, std::string id) : experiment_(experiment), id_(std::move(id)) {
    for (const Json& column : experiment.at("columns"))
      columns_.push_back({columns_.size(), column.at("name"), column.at("title"),
                          column.value("unit", ""), column.value("kind", "number")});
    for (const Json& row : experiment.at("rows"))
      if (row.size() != columns_.size())
        fail("a row has " + std::to_string(row.size()) + " cells for " +
             std::to_string(columns_.size()) + " columns");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidOption("figure '" + id_ + "': " + what);
  }

  Column column(const std::string& name) const {
    for (const Column& column : columns_)
      if (column.name == name) return column;
    std::string names;
    for (const Column& column : columns_) names += (names.empty() ? "" : ", ") + column.name;
    fail("there is no column '" + name + "'; there are " + names);
  }

  std::vector<Column> columns(const Json& names) const {
    std::vector<Column> found;
    for (const Json& name : names) found.push_back(column(name));
    return found;
  }

  const Json& all() const { return experiment_.at("rows"); }

  std::vector<const Json*> filtered(const Json& figure) const {
    std::vector<const Json*> kept;
    for (const Json& row : all()) kept.push_back(&row);
    if (!figure.contains("filter") || figure["filter"].is_null()) return kept;
    for (const auto& [name, value] : figure["filter"].items()) {
      const std::size_t index = column(name).index;
      std::erase_if(kept,
                    [&, &wanted = value](const Json* row) { return (*row)[index] != wanted; });
    }
    return kept;
  }

  /// Nothing where a cell is null.
  std::optional<double> number(const Json& row, const Column& column) const {
    const Json& cell = row[column.index];
    if (cell.is_null()) return {};
    if (!cell.is_number())
      fail("column '" + column.name + "' holds " + cell.dump() + ", which is no number");
    return cell.get<double>();
  }

 private:
  const Json& experiment_;
  std::string id_;
  std::vector<Column> columns_;
};

/// The cell as a name: numbers follow the title of their column.
std::string key_text(const Json& row, const Column& column) {
  const Json& cell = row[column.index];
  if (cell.is_null()) return {};
  if (cell.is_string()) return cell;
  return column.title + " " + number_text(cell.get<double>(), 6);
}

std::string key_text(const Json& row, const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) {
    const std::string part = key_text(row, column);
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  }
  return text.empty() ? kDash : text;
}

/// The place of an entry in a list, at whose end it is put if it is new.
template <class T>
std::size_t place(std::vector<T>& list, const T& entry) {
  const auto found = std::find(list.begin(), list.end(), entry);
  const std::size_t index = static_cast<std::size_t>(found - list.begin());
  if (found == list.end()) list.push_back(entry);
  return index;
}

AxisText read_axis(const Json& figure, const char* name, const Rows& rows) {
  const Column column = rows.column(figure.at(name));
  const std::string scale = figure.value(std::string(name) + "_scale", "linear");
  if (scale != "log" && scale != "linear")
    rows.fail("the scale '" + scale + "' is neither log nor linear");
  return {column.full_title(), scale == "log" ? Scale::Log : Scale::Linear,
          column.kind == "integer"};
}

std::optional<double> last_slope(const Curve& curve, const LinesFigure& figure) {
  std::vector<CurvePoint> points;
  for (const auto& piece : curve.pieces)
    for (const CurvePoint& point : piece)
      points.push_back({coordinate(figure.x.scale, point.x), coordinate(figure.y.scale, point.y)});
  if (points.size() > kSlopePoints)
    points.erase(points.begin(), points.end() - static_cast<std::ptrdiff_t>(kSlopePoints));
  return fitted_slope(points);
}

/// A curve while its rows are read.
struct OpenCurve {
  Curve curve;
  bool broken = true;

  void add(const std::optional<CurvePoint>& point) {
    if (point && broken) curve.pieces.emplace_back();
    if (point) curve.pieces.back().push_back(*point);
    broken = !point;
  }
};

LinesFigure read_lines(const Json& figure, const Rows& rows) {
  LinesFigure lines;
  lines.x = read_axis(figure, "x", rows);
  lines.y = read_axis(figure, "y", rows);
  lines.slopes = figure.value("slopes", false);
  for (const Json& reference : figure.value("references", Json::array()))
    lines.references.push_back({reference.at("label"), reference.at("slope")});
  const Column x = rows.column(figure.at("x"));
  const Column y = rows.column(figure.at("y"));
  const std::vector<Column> series = rows.columns(figure.at("series"));
  std::vector<Column> panel;
  if (figure.contains("panel") && !figure["panel"].is_null())
    panel.push_back(rows.column(figure["panel"]));

  std::vector<std::string> labels;
  for (const Json& row : rows.all()) place(labels, key_text(row, series));
  std::vector<std::string> titles;
  std::vector<std::vector<OpenCurve>> curves;  // by panel and label
  for (const Json* row : rows.filtered(figure)) {
    const std::size_t p = place(titles, panel.empty() ? std::string() : key_text(*row, panel));
    if (p == curves.size()) curves.emplace_back(labels.size());
    std::optional<CurvePoint> point;
    const std::optional<double> at = rows.number(*row, x);
    const std::optional<double> value = rows.number(*row, y);
    if (at && value && can_show(lines.x.scale, *at) && can_show(lines.y.scale, *value))
      point = CurvePoint{*at, *value};
    curves[p][place(labels, key_text(*row, series))].add(point);
  }

  std::vector<int> series_of(labels.size(), -1);
  for (std::size_t label = 0; label < labels.size(); ++label)
    for (const auto& in_panel : curves)
      if (series_of[label] < 0 && !in_panel[label].curve.pieces.empty()) {
        series_of[label] = static_cast<int>(lines.series.size());
        lines.series.push_back({labels[label], static_cast<int>(label)});
      }
  for (std::size_t p = 0; p < titles.size(); ++p) {
    lines.panels.push_back({titles[p], {}});
    for (std::size_t label = 0; label < labels.size(); ++label) {
      Curve& curve = curves[p][label].curve;
      if (curve.pieces.empty()) continue;
      curve.series = series_of[label];
      curve.slope = last_slope(curve, lines);
      lines.panels[p].curves.push_back(std::move(curve));
    }
  }
  return lines;
}

MatrixFigure read_matrix(const Json& figure, const Rows& rows) {
  MatrixFigure matrix;
  const Column value = rows.column(figure.at("value"));
  const std::vector<Column> down = rows.columns(figure.at("row"));
  const std::vector<Column> across = rows.columns(figure.at("column"));
  matrix.value_title = value.full_title();
  matrix.low_is_good = figure.value("low_is_good", true);
  for (const Column& column : down) matrix.row_titles.push_back(column.title);
  const std::vector<const Json*> kept = rows.filtered(figure);
  for (const Json* row : kept) place(matrix.columns, key_text(*row, across));
  std::set<std::pair<std::size_t, std::size_t>> filled;
  for (const Json* row : kept) {
    std::vector<std::string> keys;
    for (const Column& column : down) keys.push_back(key_text(*row, column));
    const std::size_t i = place(matrix.rows, keys);
    const std::size_t j = place(matrix.columns, key_text(*row, across));
    if (i == matrix.values.size()) matrix.values.emplace_back(matrix.columns.size());
    if (!filled.emplace(i, j).second)
      rows.fail("two rows for " + key_text(*row, down) + " and " + key_text(*row, across) +
                "; filter by one more column");
    matrix.values[i][j] = rows.number(*row, value);
  }
  return matrix;
}

std::string cell_text(const Json& cell, bool integers) {
  if (cell.is_null()) return kDash;
  if (cell.is_string()) return cell;
  if (!cell.is_number()) return cell.dump();
  const double value = cell.get<double>();
  return integers ? integer_text(value) : number_text(value, kTableDigits, true);
}

TableFigure read_table(const Json& figure, const Rows& rows) {
  TableFigure table;
  const std::vector<const Json*> kept = rows.filtered(figure);
  for (const Column& column : rows.columns(figure.at("columns"))) {
    const bool integers = std::all_of(kept.begin(), kept.end(), [&](const Json* row) {
      const Json& cell = (*row)[column.index];
      return !cell.is_number() ||
             (cell.get<double>() == std::round(cell.get<double>()) && is_short(cell.get<double>()));
    });
    TableFigure::Column& shown =
        table.columns.emplace_back(column.full_title(), column.kind != "text");
    for (const Json* row : kept) shown.cells.push_back(cell_text((*row)[column.index], integers));
  }
  return table;
}

/// Values beyond this part at either end do not widen the range of colours.
constexpr double kTail = 0.02;
constexpr int kPicturePixels = 640;

PictureFigure read_picture(const Json& figure, const std::vector<ViewItem>& surfaces) {
  PictureFigure picture;
  std::vector<double> all;
  const auto field_of = [](const ViewItem& item) -> const Field& {
    return std::get<SurfaceData>(item.data).fields.vertex.at(0);
  };
  for (const ViewItem& item : surfaces)
    for (const double value : field_of(item).values)
      if (std::isfinite(value)) all.push_back(value);
  std::sort(all.begin(), all.end());
  picture.scale.isolines = figure.value("isolines", 0);
  // Distances show all of their range, curvatures not their few extremes.
  const auto tail = static_cast<std::size_t>(
      picture.scale.isolines > 0 ? 0 : kTail * static_cast<double>(all.size()));
  if (!all.empty()) {
    picture.scale.low = all[tail];
    picture.scale.high = all[all.size() - 1 - tail];
  }
  for (const ViewItem& item : surfaces) {
    const Field& field = field_of(item);
    picture.value_title = field.name;
    std::replace(picture.value_title.begin(), picture.value_title.end(), '_', ' ');
    const Vector values = Eigen::Map<const Vector>(field.values.data(),
                                                   static_cast<Eigen::Index>(field.values.size()));
    picture.images.emplace_back(item.title, render(std::get<SurfaceData>(item.data).mesh, values,
                                                   picture.scale, kPicturePixels, kPicturePixels));
  }
  return picture;
}

Figure read_figure(const Json& figure, const Json& experiment,
                   const std::vector<ViewItem>& surfaces) {
  const std::string id = figure.at("id");
  const Rows rows(experiment, id);
  if (id.empty() || id.find('/') != std::string::npos) rows.fail("the id is no name of a file");
  const std::string kind = figure.at("kind");
  const std::string title = figure.at("title");
  if (kind == "lines") return {id, title, read_lines(figure, rows)};
  if (kind == "matrix") return {id, title, read_matrix(figure, rows)};
  if (kind == "table") return {id, title, read_table(figure, rows)};
  if (kind == "picture") return {id, title, read_picture(figure, surfaces)};
  rows.fail("the kind '" + kind + "' is none of lines, matrix, table, picture");
}

}  // namespace

std::optional<double> fitted_slope(const std::vector<CurvePoint>& points) {
  CurvePoint mean{0, 0};
  for (const CurvePoint& point : points) {
    mean.x += point.x / static_cast<double>(points.size());
    mean.y += point.y / static_cast<double>(points.size());
  }
  double xx = 0;
  double xy = 0;
  for (const CurvePoint& point : points) {
    xx += (point.x - mean.x) * (point.x - mean.x);
    xy += (point.x - mean.x) * (point.y - mean.y);
  }
  if (points.size() < 2 || !(xx > 0)) return {};
  return xy / xx;
}

std::vector<Figure> read_figures(const Json& experiment, const std::vector<ViewItem>& surfaces) {
  std::vector<Figure> figures;
  try {
    for (const Json& figure : experiment.at("figures"))
      if (!surfaces.empty() || figure.value("kind", "") != "picture")
        figures.push_back(read_figure(figure, experiment, surfaces));
  } catch (const Json::exception& error) {
    throw InvalidOption("figure " + std::to_string(figures.size() + 1) +
                        " of the experiment is not complete: " + error.what());
  }
  return figures;
}

}  // namespace carat::cli
