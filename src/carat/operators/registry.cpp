#include "carat/operators/registry.h"

#include "carat/base/error.h"

namespace carat {

const std::vector<const SurfaceOperator*>& surface_operators() {
  static const std::vector<const SurfaceOperator*> operators = {
#define CARAT_SURFACE_OPERATOR(name) &name##_surface_operator,
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR
  };
  return operators;
}

const SurfaceOperator& surface_operator(const std::string& name) {
  std::string known;
  for (const SurfaceOperator* entry : surface_operators()) {
    if (name == entry->name) return *entry;
    known += (known.empty() ? "" : ", ") + std::string(entry->name);
  }
  throw InvalidOption("operator '" + name + "' is not known; known are: " + known);
}

Discretization discretize(const PolygonMesh& mesh, const std::string& operator_name,
                          const DiscretizationOptions& options) {
  const std::unique_ptr<Assembly> assembly = surface_operator(operator_name).prepare(mesh, options);
  assembly->update(mesh.points());
  return assembly->release();
}

}  // namespace carat
