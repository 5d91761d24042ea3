#pragma once
// The engine over all processes of an MPI job.

#include "cli/engine.h"

namespace carat::cli {

/// In the first process: hands every process its part of the mesh, which all solve together.
class PartEngine final : public Engine {
 public:
  explicit PartEngine(int n_processes) : n_processes_(n_processes) {}
  /// Sends the others home.
  ~PartEngine() override;

  PoissonSolution poisson(const EngineProblem& problem, const BoundaryConditions& conditions,
                          const Vector& f) override;
  GeodesicDistance geodesics(const EngineProblem& problem, double t_coef,
                             const std::vector<GeodesicSource>& sources,
                             double& time_step) override;
  EigenPairs eigenmodes(const EngineProblem& problem, Index count,
                        const std::vector<Index>& fixed) override;
  int n_processes() const override { return n_processes_; }

 private:
  int n_processes_;
};

/// In the others: works on what the first process hands out, until it sends them home.
void work_on_parts();

}  // namespace carat::cli
