#include "carat/operators/registry.h"

#include "carat/base/error.h"

namespace carat {
namespace {

template <class Entry>
const Entry& find_operator(const std::vector<const Entry*>& operators, const std::string& name,
                           const char* kind) {
  std::string known;
  for (const Entry* entry : operators) {
    if (name == entry->name) return *entry;
    known += (known.empty() ? "" : ", ") + std::string(entry->name);
  }
  throw InvalidOption("operator '" + name + "' is not known on " + kind + "; known are: " + known);
}

template <class Entry, class Mesh>
Discretization both_phases(const Entry& entry, const Mesh& mesh,
                           const DiscretizationOptions& options) {
  const std::unique_ptr<Assembly> assembly = entry.prepare(mesh, options);
  assembly->update(mesh.points());
  return assembly->release();
}

}  // namespace

const std::vector<const SurfaceOperator*>& surface_operators() {
  static const std::vector<const SurfaceOperator*> operators = {
#define CARAT_SURFACE_OPERATOR(name) &name##_surface_operator,
#define CARAT_VOLUME_OPERATOR(name)
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR
#undef CARAT_VOLUME_OPERATOR
  };
  return operators;
}

const std::vector<const VolumeOperator*>& volume_operators() {
  static const std::vector<const VolumeOperator*> operators = {
#define CARAT_SURFACE_OPERATOR(name)
#define CARAT_VOLUME_OPERATOR(name) &name##_volume_operator,
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR
#undef CARAT_VOLUME_OPERATOR
  };
  return operators;
}

const SurfaceOperator& surface_operator(const std::string& name) {
  return find_operator(surface_operators(), name, "surfaces");
}

const VolumeOperator& volume_operator(const std::string& name) {
  return find_operator(volume_operators(), name, "volumes");
}

Discretization discretize(const PolygonMesh& mesh, const std::string& operator_name,
                          const DiscretizationOptions& options) {
  return both_phases(surface_operator(operator_name), mesh, options);
}

Discretization discretize(const PolyhedralMesh& mesh, const std::string& operator_name,
                          const DiscretizationOptions& options) {
  return both_phases(volume_operator(operator_name), mesh, options);
}

}  // namespace carat
