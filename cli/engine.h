#pragma once
// What solves a command's problem over several processes: the program carat-petsc has such an
// engine, carat solves by itself and starts carat-petsc where it is asked for.

#include <string>
#include <variant>
#include <vector>

#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/poisson.h"

namespace CLI {
class App;
}

namespace carat::cli {

/// The operator on a mesh. K is given as the text of an expression, which other processes can read.
struct EngineProblem {
  std::variant<const PolygonMesh*, const PolyhedralMesh*> mesh;
  std::string operator_name;
  DiscretizationOptions options;
  std::string coefficient;
};

/// Data and solutions are those of the whole mesh.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual PoissonSolution poisson(const EngineProblem& problem,
                                  const BoundaryConditions& conditions, const Vector& f) = 0;
  virtual GeodesicDistance geodesics(const EngineProblem& problem, double t_coef,
                                     const std::vector<GeodesicSource>& sources,
                                     double& time_step) = 0;
  virtual EigenPairs eigenmodes(const EngineProblem& problem, Index count,
                                const std::vector<Index>& fixed) = 0;
  virtual int n_processes() const = 0;
};

/// Declares --engine.
void declare_engine_option(CLI::App& app);

/// Runs the program. \param engine  null: where --engine asks for one, another program is started
int run_program(std::vector<std::string> arguments, Engine* engine);

}  // namespace carat::cli
