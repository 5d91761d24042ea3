#include "cli/experiments/experiment.h"

namespace carat::cli {

std::vector<int> Extent::levels_from(int first, int n_full, int n_quick) const {
  std::vector<int> list(static_cast<std::size_t>(levels.value_or(quick ? n_quick : n_full)));
  for (std::size_t k = 0; k < list.size(); ++k) list[k] = first + static_cast<int>(k);
  return list;
}

const std::vector<const Experiment*>& experiments() {
  static const std::vector<const Experiment*> list = {
#define CARAT_EXPERIMENT(name) &name##_experiment,
#include "cli/experiments/experiments.def"
#undef CARAT_EXPERIMENT
  };
  return list;
}

Json line_figure(const char* id, const char* title, const char* caption, const char* panel,
                 std::vector<const char*> series, const char* x, const char* y) {
  return {{"id", id},
          {"title", title},
          {"caption", caption},
          {"kind", "lines"},
          {"panel", panel},
          {"series", series},
          {"x", x},
          {"y", y},
          {"x_scale", "log"},
          {"y_scale", "log"},
          {"slopes", true},
          {"filter", nullptr},
          {"references", {{{"label", "second order"}, {"slope", 2}}}}};
}

}  // namespace carat::cli
