#pragma once
// The engine over all processes of an MPI job.

#include "cli/engine.h"

namespace carat::cli {

/// One command a source file of this folder. All methods are collective; what they throw is Shared,
/// unless one process alone can know it.
class PartEngine final : public Engine {
 public:
  void poisson(Session& session, const PoissonArguments& arguments) const override;
  void geodesics(Session& session, const GeodesicsArguments& arguments) const override;
  void eigen(Session& session, const EigenArguments& arguments) const override;
  void operators(Session& session, const OperatorsArguments& arguments) const override;
};

}  // namespace carat::cli
