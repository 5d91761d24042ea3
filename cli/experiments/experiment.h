#pragma once
// What `carat reproduce` measures: experiments made of cases, each cached by its parameters.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "carat/report/html_view.h"
#include "cli/session.h"

namespace carat::cli {

/// How far an experiment goes.
struct Extent {
  std::optional<int> levels;  ///< number of refinement levels; default: the experiment's own
  bool quick = false;         ///< coarse meshes: everything in two minutes
  int threads = 0;
  std::string model;  ///< file of the surface of the experiments with pictures

  /// Levels to measure: `first`, and as many as are asked for.
  std::vector<int> levels_from(int first, int n_full, int n_quick) const;
};

/// One measurement. Its parameters name it and are columns of all its rows; parameters and rows
/// are flat objects of numbers, strings and nulls.
struct ExperimentCase {
  Json parameters;
  std::function<std::vector<Json>()> measure;
};

struct ExperimentColumn {
  const char* name;
  const char* title;
  const char* unit;
  const char* kind;  ///< "number", "integer", "text"
};

struct Experiment {
  const char* name;
  const char* title;
  const char* paper;  ///< "Figure 8" of Bunge, Botsch, Alexa 2021; null if it is not there
  const char* text;   ///< what is computed
  std::vector<ExperimentColumn> columns;
  Json (*figures)();
  std::vector<ExperimentCase> (*plan)(const Extent& extent);
  /// Columns that compare rows with each other; may be null.
  void (*finish)(std::vector<Json>& rows);
  /// What the figures of kind "picture" show: surfaces with one field each; may be null.
  std::vector<ViewItem> (*pictures)(const Extent& extent) = nullptr;
};

#define CARAT_EXPERIMENT(name) extern const Experiment name##_experiment;
#include "cli/experiments/experiments.def"
#undef CARAT_EXPERIMENT

/// In the order of experiments.def.
const std::vector<const Experiment*>& experiments();

/// Curves of `y` over `x`, one panel a value of `panel`.
Json line_figure(const char* id, const char* title, const char* caption, const char* panel,
                 std::vector<const char*> series, const char* x, const char* y);

}  // namespace carat::cli
