#include <gtest/gtest.h>

#include "carat/base/error.h"
#include "cli/figure_data.h"
#include "cli/figure_numbers.h"
#include "sample_experiment.h"

namespace carat::cli {
namespace {

Figure read_one(Json experiment, const Json& figure) {
  experiment["figures"] = Json::array({figure});
  return read_figures(experiment).at(0);
}

LinesFigure read_lines(const Json& experiment, const Json& figure) {
  return std::get<LinesFigure>(read_one(experiment, figure).content);
}

std::string refusal(const Json& experiment, const Json& figure) {
  try {
    read_one(experiment, figure);
  } catch (const InvalidOption& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FigureData, has_a_panel_a_family_and_a_curve_a_series) {
  const LinesFigure lines = read_lines(sample_experiment(3, 4, 5), lines_figure());
  ASSERT_EQ(lines.panels.size(), 3U);
  EXPECT_EQ(lines.panels[1].title, "plane-hexagons");
  ASSERT_EQ(lines.series.size(), 4U);
  EXPECT_EQ(lines.series[0].label, "diamond, lumped");
  EXPECT_EQ(lines.series[1].label, "cotan");
  EXPECT_EQ(lines.x.title, "mean edge length (m)");
  EXPECT_EQ(lines.y.title, "root mean square error");
  for (const Panel& panel : lines.panels) {
    ASSERT_EQ(panel.curves.size(), 4U);
    ASSERT_EQ(panel.curves[0].pieces.size(), 1U);
    EXPECT_EQ(panel.curves[0].pieces[0].size(), 5U);
  }
  EXPECT_EQ(lines.references.size(), 2U);
}

TEST(FigureData, has_one_panel_without_a_column_for_it) {
  Json figure = lines_figure();
  figure["panel"] = nullptr;
  figure["filter"] = {{"family", "plane-quads"}};
  const LinesFigure lines = read_lines(sample_experiment(3, 4, 5), figure);
  ASSERT_EQ(lines.panels.size(), 1U);
  EXPECT_EQ(lines.panels[0].title, "");
  EXPECT_EQ(lines.panels[0].curves.size(), 4U);
}

TEST(FigureData, breaks_a_curve_where_there_is_no_value) {
  const LinesFigure lines = read_lines(sample_experiment(4, 5, 4), lines_figure());
  const Curve& broken = lines.panels[0].curves[2];
  ASSERT_EQ(broken.pieces.size(), 2U);
  EXPECT_EQ(broken.pieces[0].size(), 1U);
  EXPECT_EQ(broken.pieces[1].size(), 2U);
  EXPECT_EQ(lines.panels[0].curves.size(), 5U);
  EXPECT_EQ(lines.panels[3].curves.size(), 4U);
}

TEST(FigureData, skips_what_a_logarithmic_axis_cannot_show) {
  Json experiment = sample_experiment(1, 1, 4);
  experiment["rows"][1][6] = 0.0;
  experiment["rows"][3][6] = -1.0;
  Json figure = lines_figure();
  EXPECT_EQ(read_lines(experiment, figure).panels[0].curves[0].pieces.size(), 2U);
  figure["y_scale"] = "linear";
  const LinesFigure linear = read_lines(experiment, figure);
  ASSERT_EQ(linear.panels[0].curves[0].pieces.size(), 1U);
  EXPECT_EQ(linear.panels[0].curves[0].pieces[0].size(), 4U);
}

TEST(FigureData, fits_the_slope_to_the_last_three_points) {
  Json experiment = sample_experiment(1, 1, 6);
  for (Json& row : experiment["rows"]) {
    const double h = row[5];
    row[6] = h * h;
  }
  // Not among the last three.
  experiment["rows"][0][6] = 7.0;
  const LinesFigure lines = read_lines(experiment, lines_figure());
  // Rounding of logarithms.
  EXPECT_NEAR(lines.panels[0].curves[0].slope.value(), 2, 1e-13);
  EXPECT_FALSE(read_lines(sample_experiment(1, 1, 1), lines_figure()).panels[0].curves[0].slope);
}

TEST(FigureData, keeps_the_style_of_a_series_in_all_figures) {
  Json figure = lines_figure();
  figure["filter"] = {{"operator", "bunge"}};
  const LinesFigure lines = read_lines(sample_experiment(2, 4, 3), figure);
  ASSERT_EQ(lines.series.size(), 1U);
  EXPECT_EQ(lines.series[0].style, 2);
}

TEST(FigureData, names_series_of_numbers_by_their_column) {
  Json figure = lines_figure();
  figure["series"] = {"operator", "level"};
  EXPECT_EQ(read_lines(sample_experiment(1, 1, 2), figure).series[1].label, "diamond, level 1");
}

TEST(FigureData, names_a_column_that_does_not_exist) {
  const Json experiment = sample_experiment(2, 2, 2);
  for (const char* const key : {"x", "y", "panel"}) {
    Json figure = lines_figure();
    figure[key] = "colour";
    EXPECT_NE(refusal(experiment, figure).find("figure 'errors': there is no column 'colour'"),
              std::string::npos);
  }
  Json figure = lines_figure();
  figure["filter"] = {{"shade", 1}};
  EXPECT_NE(refusal(experiment, figure).find("'shade'"), std::string::npos);
  figure = matrix_figure();
  figure["row"] = {"family", "hue"};
  EXPECT_NE(refusal(experiment, figure).find("'hue'"), std::string::npos);
  figure = table_figure();
  figure["columns"] = {"tint"};
  EXPECT_NE(refusal(experiment, figure).find("'tint'"), std::string::npos);
}

TEST(FigureData, refuses_what_it_cannot_show) {
  const Json experiment = sample_experiment(2, 2, 2);
  Json figure = lines_figure();
  figure["y"] = "operator";
  EXPECT_NE(refusal(experiment, figure).find("no number"), std::string::npos);
  figure = lines_figure();
  figure["x_scale"] = "square";
  EXPECT_NE(refusal(experiment, figure).find("'square'"), std::string::npos);
  figure = lines_figure();
  figure["kind"] = "pie";
  EXPECT_NE(refusal(experiment, figure).find("'pie'"), std::string::npos);
  figure = lines_figure();
  figure["id"] = "../errors";
  EXPECT_NE(refusal(experiment, figure).find("name of a file"), std::string::npos);
  figure = lines_figure();
  figure.erase("series");
  EXPECT_NE(refusal(experiment, figure).find("series"), std::string::npos);
  figure = matrix_figure();
  figure["filter"] = nullptr;
  EXPECT_NE(refusal(experiment, figure).find("two rows for franke, plane-quads"),
            std::string::npos);
  Json ragged = experiment;
  ragged["rows"][0].push_back(1);
  EXPECT_NE(refusal(ragged, lines_figure()).find("9 cells for 8 columns"), std::string::npos);
}

TEST(FigureData, puts_ratios_by_row_and_column) {
  const Figure figure = read_one(sample_experiment(4, 5, 2), matrix_figure());
  const auto& matrix = std::get<MatrixFigure>(figure.content);
  ASSERT_EQ(matrix.rows.size(), 4U);
  ASSERT_EQ(matrix.columns.size(), 5U);
  EXPECT_EQ(matrix.rows[2], (std::vector<std::string>{"sine", "plane-voronoi"}));
  EXPECT_EQ(matrix.columns[1], "cotan");
  EXPECT_DOUBLE_EQ(matrix.values[2][1].value(), 0.9);
  EXPECT_FALSE(matrix.values[3][4]);
}

TEST(FigureData, typesets_the_cells_of_a_table) {
  const Figure figure = read_one(sample_experiment(4, 5, 2), table_figure());
  const auto& table = std::get<TableFigure>(figure.content);
  ASSERT_EQ(table.columns.size(), 6U);
  EXPECT_EQ(table.columns[3].title, "mean edge length (m)");
  EXPECT_FALSE(table.columns[0].number);
  EXPECT_TRUE(table.columns[4].number);
  ASSERT_EQ(table.columns[2].cells.size(), 40U);
  EXPECT_EQ(table.columns[2].cells[1], "1");
  EXPECT_EQ(table.columns[3].cells[0], "0.2000");
  EXPECT_EQ(table.columns[4].cells[39], "\u2013");
}

TEST(FigureNumbers, are_short_and_keep_their_digits) {
  EXPECT_EQ(number_text(0.05, 3), "0.05");
  EXPECT_EQ(number_text(0.05, 3, true), "0.0500");
  EXPECT_EQ(number_text(-1234.5678, 4), "\u22121235");
  EXPECT_EQ(number_text(1.5e-7, 4), "1.5\u00d710^{\u22127}");
  EXPECT_EQ(number_text(1e12, 4), "10^{12}");
  EXPECT_EQ(number_text(0, 4), "0");
  EXPECT_EQ(fixed_text(-0.001, 2), "0.00");
  EXPECT_EQ(fixed_text(-1.5, 1), "\u22121.5");
  EXPECT_EQ(integer_text(1234), "1234");
  EXPECT_EQ(integer_text(-1234567), "\u22121\u2009234\u2009567");
  EXPECT_EQ(ratio_text(0.987), "0.99");
  EXPECT_EQ(ratio_text(12.34), "12.3");
  EXPECT_EQ(ratio_text(123.4), "123");
  EXPECT_EQ(ratio_text(0.0012), "0.001");
  EXPECT_EQ(ratio_text(0.00012), "10^{\u22124}");
}

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> texts;
  for (const Tick& tick : axis.ticks) texts.push_back(tick.label);
  return texts;
}

TEST(FigureAxis, labels_linear_axes_by_round_numbers) {
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels(make_axis(Scale::Linear, {-0.1, 1.1}, 0.2, false)),
            (Labels{"0.0", "0.5", "1.0"}));
  EXPECT_EQ(labels(make_axis(Scale::Linear, {0, 2}, 0.1, true)), (Labels{"0", "1", "2"}));
  EXPECT_EQ(labels(make_axis(Scale::Linear, {0, 2e6}, 0.4, false)),
            (Labels{"0", "10^{6}", "2\u00d710^{6}"}));
}

TEST(FigureAxis, labels_logarithmic_axes_by_their_length) {
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels(make_axis(Scale::Log, {-6.2, -2.9}, 0.1, false)),
            (Labels{"10^{\u22126}", "10^{\u22125}", "10^{\u22124}", "10^{\u22123}"}));
  EXPECT_EQ(labels(make_axis(Scale::Log, {-12.5, 0.5}, 0.2, false)),
            (Labels{"10^{\u221212}", "10^{\u22129}", "10^{\u22126}", "10^{\u22123}", "1"}));
  EXPECT_EQ(labels(make_axis(Scale::Log, {-1.8, -0.6}, 0.1, false)),
            (Labels{"0.02", "0.05", "0.1", "0.2"}));
  EXPECT_EQ(labels(make_axis(Scale::Log, {-1.8, -0.2}, 0.25, false)),
            (Labels{"0.03", "0.1", "0.3"}));
  EXPECT_EQ(labels(make_axis(Scale::Log, {0.32, 0.62}, 0.1, false)), (Labels{"3", "4"}));
  EXPECT_EQ(labels(make_axis(Scale::Log, {0.32, 0.39}, 0.3, false)), (Labels{"2.2", "2.4"}));
}

}  // namespace
}  // namespace carat::cli
