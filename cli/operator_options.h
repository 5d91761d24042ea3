#pragma once
// What the commands that build operators share.

#include <functional>
#include <optional>
#include <string>

#include "carat/apps/poisson.h"
#include "carat/apps/recommended.h"
#include "carat/operators/registry.h"
#include "cli/engine.h"
#include "cli/session.h"

namespace CLI {
class App;
}

namespace carat::cli {

struct OperatorOptions {
  std::optional<Application> application;  ///< empty: the matrices themselves
  std::string name;                        ///< empty: the application's
  std::string virtual_point;               ///< empty, like all below: the library's default
  std::string weights;
  std::string mass;
  std::optional<double> lambda, theta, tau;
  std::string boundary_unknowns;
  bool strict = false;
  bool keep_flipped = false;
};

/// Declares --operator and its relatives.
void declare_operator_options(CLI::App& app, OperatorOptions& options,
                              std::optional<Application> application);

/// K in div(K grad u); empty for 1.
struct Coefficient {
  std::function<double(const Vec3&)> function{};
  Matrix of_cells{};
};

/// Runs both phases and reports sizes, entries and diagnostics.
/// \param poisson  if given: the operators in the form in which this solver takes them
/// \throws InvalidOption      the operator is not one of this kind of mesh
/// \throws DegenerateElement  under --strict
Discretization discretize(Session& session, const PolygonMesh& mesh, const OperatorOptions& options,
                          DiscretizationParts parts, const Coefficient& coefficient = {},
                          const SolverOptions* poisson = nullptr);
Discretization discretize(Session& session, const PolyhedralMesh& mesh,
                          const OperatorOptions& options, DiscretizationParts parts,
                          const Coefficient& coefficient = {},
                          const SolverOptions* poisson = nullptr);

/// The operator and its options as the library takes them, which are reported.
struct ChosenOperator {
  std::string name;
  DiscretizationOptions options;
};
ChosenOperator choose_operator(Session& session, const PolygonMesh& mesh,
                               const OperatorOptions& options);
ChosenOperator choose_operator(Session& session, const PolyhedralMesh& mesh,
                               const OperatorOptions& options);

}  // namespace carat::cli
