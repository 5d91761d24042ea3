#pragma once
// What runs commands over several processes: the program carat-petsc has such an engine, carat does
// everything by itself and starts carat-petsc where an engine is asked for.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace carat::cli {

class Session;
struct EigenArguments;
struct GeodesicsArguments;
struct OperatorsArguments;
struct PoissonArguments;

/// Runs in every process of the job with the same arguments, each on its part of the mesh.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual void poisson(Session& session, const PoissonArguments& arguments) const = 0;
  virtual void geodesics(Session& session, const GeodesicsArguments& arguments) const = 0;
  virtual void eigen(Session& session, const EigenArguments& arguments) const = 0;
  virtual void operators(Session& session, const OperatorsArguments& arguments) const = 0;
};

/// Declares --engine.
void declare_engine_option(CLI::App& app);

/// Whether --engine petsc is among the arguments.
bool asks_for_petsc(const std::vector<std::string>& arguments);

/// Runs the program.
/// \param engine  null: where --engine asks for one, another program is started. Else exceptions of
///                its commands are the caller's, who knows which other processes they concern.
int run_program(std::vector<std::string> arguments, const Engine* engine);

}  // namespace carat::cli
