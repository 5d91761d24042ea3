#pragma once
// Which operator each application takes where none is asked for.

#include <optional>

#include "carat/operators/registry.h"

namespace carat {

enum class Application { MeanCurvature, Geodesics, Poisson, Eigenmodes };

/// An operator, with the options that are not its own defaults.
struct OperatorChoice {
  const char* name;
  MassKind mass = MassKind::Default;
  std::optional<double> theta{};
};

/// The most accurate of the diamonds for an application and a kind of mesh: in no column of
/// docs/accuracy.md is its error above 1.05 of that of `diamond`.
OperatorChoice recommended_operator(Application application, const PolygonMesh& mesh);
OperatorChoice recommended_operator(Application application, const PolyhedralMesh& mesh);

}  // namespace carat
