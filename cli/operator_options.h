#pragma once
// What the commands that build operators share.

#include <string>

#include "carat/operators/registry.h"
#include "cli/session.h"

namespace CLI {
class App;
}

namespace carat::cli {

struct OperatorOptions {
  std::string name;
  std::string virtual_point = "area";
  std::string weights = "in-plane";
  bool lumped = false;
  bool strict = false;
  bool keep_flipped = false;
};

/// Declares --operator and its relatives.
void declare_operator_options(CLI::App& app, OperatorOptions& options);

/// Runs both phases and reports sizes, entries and diagnostics.
/// \param coefficient  K, or empty for 1
Discretization discretize(Session& session, const PolygonMesh& mesh, const OperatorOptions& options,
                          DiscretizationParts parts,
                          const std::function<double(const Vec3&)>& coefficient = {});

/// The options as an object for JSON.
Json to_json(const OperatorOptions& options);

}  // namespace carat::cli
