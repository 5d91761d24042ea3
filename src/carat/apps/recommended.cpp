#include "carat/apps/recommended.h"

#include <cstdio>

namespace carat {

std::string OperatorChoice::words() const {
  std::string text = name;
  if (mass != MassKind::Default) text += std::string(", mass ") + mass_kind_name(mass);
  if (theta) {
    char number[32];
    std::snprintf(number, sizeof number, "%g", *theta);
    text += std::string(", theta ") + number;
  }
  return text;
}

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
