#pragma once
// Experiments that refine: families x levels x methods.

#include "cli/experiments/problems.h"

namespace carat::cli {

using Families = std::vector<const char*>;
using Methods = std::vector<Method> (*)(const std::string& family);

inline const ExperimentColumn kFamily{"family", "family of meshes", "", "text"};
inline const ExperimentColumn kLevel{"level", "level", "", "integer"};
inline const ExperimentColumn kOperator{"operator", "operator", "", "text"};
inline const ExperimentColumn kMass{"mass", "mass", "", "text"};
inline const ExperimentColumn kTheta{"theta", "theta", "", "number"};
inline const ExperimentColumn kTau{"tau", "tau", "", "number"};
inline const ExperimentColumn kVertices{"vertices", "vertices", "", "integer"};
inline const ExperimentColumn kMeanEdge{"mean_edge", "mean edge length", "", "number"};
inline const ExperimentColumn kMaxEdge{"max_edge", "longest edge", "", "number"};

inline std::vector<ExperimentColumn> columns_with(std::vector<ExperimentColumn> own) {
  std::vector<ExperimentColumn> columns{kFamily, kLevel,    kOperator, kMass,   kTheta,
                                        kTau,    kVertices, kMeanEdge, kMaxEdge};
  columns.insert(columns.end(), own.begin(), own.end());
  return columns;
}

/// The level that is nearest in size to those of the other families.
inline int mesh_level(const std::string& family, int level) {
  return family.find("voronoi") != std::string::npos ? level - 1 : level;
}

/// Families x levels x methods; `measure(mesh, discretization)` gives rows with columns of
/// its own.
template <class Mesh, class Measure>
std::vector<ExperimentCase> convergence_cases(const Families& families,
                                              const std::vector<int>& levels, Methods methods,
                                              DiscretizationParts parts, const Extent& extent,
                                              const Measure& measure) {
  const auto source = std::make_shared<MeshSource<Mesh>>();
  std::vector<ExperimentCase> cases;
  for (const char* const family : families)
    for (const int nominal : levels) {
      const FamilyOptions options{.level = mesh_level(family, nominal)};
      for (const Method& method : methods(family)) {
        Json parameters{{"family", family}, {"level", options.level}};
        parameters.update(parameters_of<Mesh>(method));
        cases.push_back(
            {parameters, [=, threads = extent.threads] {
               const Mesh& mesh = source->get(family, options);
               const Json sizes = sizes_of(mesh);
               std::vector<Json> rows =
                   measure(mesh, discretize(mesh, method.name, options_of(method, parts, threads)));
               for (Json& row : rows) row.update(sizes);
               return rows;
             }});
      }
    }
  return cases;
}

/// Sets the column `finest`: 1 at the finest level of a family, else 0.
void mark_finest(std::vector<Json>& rows);

}  // namespace carat::cli
