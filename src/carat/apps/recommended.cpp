#include "carat/apps/recommended.h"

namespace carat {

OperatorChoice recommended_operator(Application application, const PolygonMesh&) {
  switch (application) {
    case Application::MeanCurvature:
      return {"diamond", MassKind::Lumped};
    case Application::Geodesics:
      return {"stabilized_diamond", MassKind::Default, 0.8};
    case Application::Eigenmodes:
      return {"stabilized_diamond", MassKind::MomentExact};
    case Application::Poisson:
      break;
  }
  return {"stabilized_diamond"};
}

OperatorChoice recommended_operator(Application application, const PolyhedralMesh&) {
  return {application == Application::Eigenmodes ? "stabilized_diamond" : "diamond"};
}

}  // namespace carat
