#include "carat/operators/common.h"

#include <cmath>
#include <cstdio>

#include "carat/base/error.h"

namespace carat {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

double coefficient_at(const DiscretizationOptions& options, const Vec3& centroid) {
  const double k = options.coefficient(centroid);
  if (!(std::isfinite(k) && k > 0))
    throw InvalidOption("the coefficient is " + number(k) + " at (" + number(centroid.x()) + ", " +
                        number(centroid.y()) + ", " + number(centroid.z()) +
                        "); it must be a positive finite number everywhere on the mesh");
  return k;
}

void report_degenerate(std::vector<Index> samples, const DiscretizationOptions& options,
                       const std::string& kind, const std::function<std::string(Index)>& describe,
                       Diagnostics& diagnostics) {
  if (options.degenerate == DegeneratePolicy::Strict && !samples.empty()) {
    const std::string message =
        kind + " " + std::to_string(samples[0]) + " (" + describe(samples[0]) +
        ") is degenerate: its measure is below " + number(options.eps_rel) +
        " of its squared diameter, as for " + std::to_string(samples.size() - 1) +
        " more; repair the mesh, or use DegeneratePolicy::Report to leave them out";
    throw DegenerateElement(message, std::move(samples));
  }
  diagnostics.add("excluded_samples",
                  kind + "s whose measure vanishes relative to their size; they contribute nothing",
                  std::move(samples));
}

void report_unreferenced(const PolygonMesh& mesh, Diagnostics& diagnostics) {
  std::vector<Index> unreferenced;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_corners().size(v) == 0) unreferenced.push_back(v);
  diagnostics.add("unreferenced_vertices",
                  "vertices without a face: empty rows, excluded from every solve",
                  std::move(unreferenced));
}

}  // namespace carat
