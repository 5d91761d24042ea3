#pragma once
// A made-up experiment: errors of operators on families of meshes, with gaps.

#include <cmath>
#include <string>

#include "cli/session.h"

namespace carat::cli {

inline Json sample_columns() {
  const auto column = [](const char* name, const char* title, const char* unit, const char* kind) {
    return Json{{"name", name}, {"title", title}, {"unit", unit}, {"kind", kind}};
  };
  return Json::array({column("problem", "problem", "", "text"),
                      column("family", "family", "", "text"),
                      column("operator", "operator", "", "text"),
                      column("mass", "mass", "", "text"), column("level", "level", "", "integer"),
                      column("mean_edge", "mean edge length", "m", "number"),
                      column("rmse", "root mean square error", "", "number"),
                      column("ratio", "error relative to the diamond", "", "number")});
}

/// Errors fall with orders between 1 and 2; the third operator fails at one level, and the last one
/// altogether on one family.
inline Json sample_experiment(int n_families, int n_operators, int n_levels) {
  const char* const operators[] = {"diamond", "cotan", "bunge", "alexa-wardetzky",
                                   "virtual-element"};
  const char* const families[] = {"plane-quads", "plane-hexagons", "plane-voronoi",
                                  "plane-concave"};
  Json rows = Json::array();
  for (int family = 0; family < n_families; ++family)
    for (int op = 0; op < n_operators; ++op)
      for (int level = 0; level < n_levels; ++level) {
        const double h = 0.2 * std::pow(0.5, level) * (1 + 0.05 * family);
        const double order = 2 - 0.2 * op * (family % 2);
        const double error = (0.3 + 0.4 * op) * (1 + 0.3 * family) * std::pow(h, order);
        const bool fails = (op == 2 && level == 1) || (op == 4 && family == 3);
        rows.push_back(Json::array({family < 2 ? "franke" : "sine", families[family % 4],
                                    operators[op % 5], op == 1 ? Json(nullptr) : Json("lumped"),
                                    level, h, fails ? Json(nullptr) : Json(error),
                                    fails ? Json(nullptr) : Json(0.5 + 0.4 * op)}));
      }
  return {{"name", "sample"},
          {"title", "Sample"},
          {"columns", sample_columns()},
          {"rows", rows},
          {"figures", Json::array()}};
}

inline Json lines_figure() {
  return {{"id", "errors"},
          {"title", "Errors of Poisson\u2019s equation with Franke\u2019s function on the plane"},
          {"caption", "Made up."},
          {"kind", "lines"},
          {"panel", "family"},
          {"series", {"operator", "mass"}},
          {"x", "mean_edge"},
          {"y", "rmse"},
          {"x_scale", "log"},
          {"y_scale", "log"},
          {"slopes", true},
          {"filter", nullptr},
          {"references", Json::array({{{"label", "order 1"}, {"slope", 1}},
                                      {{"label", "order 2"}, {"slope", 2}}})}};
}

inline Json matrix_figure() {
  return {{"id", "ratios"},
          {"title", "Errors relative to the diamond Laplacian"},
          {"caption", "Made up."},
          {"kind", "matrix"},
          {"row", {"problem", "family"}},
          {"column", {"operator", "mass"}},
          {"value", "ratio"},
          {"filter", {{"level", 0}}},
          {"low_is_good", true}};
}

inline Json table_figure() {
  return {{"id", "numbers"},
          {"title", "Errors on the finest meshes"},
          {"caption", "Made up."},
          {"kind", "table"},
          {"columns", {"family", "operator", "level", "mean_edge", "rmse", "ratio"}},
          {"filter", nullptr}};
}

}  // namespace carat::cli
