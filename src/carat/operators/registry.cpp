#include "carat/operators/registry.h"

#include <algorithm>
#include <cmath>

#include "carat/base/error.h"
#include "carat/operators/common.h"

namespace carat {

#define CARAT_SURFACE_OPERATOR(name) extern const SurfaceOperator name##_surface_operator;
#define CARAT_VOLUME_OPERATOR(name) extern const VolumeOperator name##_volume_operator;
#include "carat/operators/operators.def"
#undef CARAT_SURFACE_OPERATOR
#undef CARAT_VOLUME_OPERATOR

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

std::string masses_in_words(const std::vector<MassKind>& masses) {
  std::string list;
  for (const MassKind kind : masses)
    list.append(list.empty() ? "" : ", ").append(mass_kind_name(kind));
  return list;
}

/// The options with the operator's own defaults in place of what was left open.
/// \throws InvalidOption  one that it has no use for, or a bad value
DiscretizationOptions settle_options(const std::string& name, const OperatorOptionSet& taken,
                                     const DiscretizationOptions& wanted) {
  DiscretizationOptions options = wanted;
  if (options.mass == MassKind::Default) options.mass = taken.masses.front();
  if (std::find(taken.masses.begin(), taken.masses.end(), options.mass) == taken.masses.end())
    throw InvalidOption("the operator " + name + " has no " + mass_kind_name(options.mass) +
                        " mass; it has: " + masses_in_words(taken.masses));
  if (!taken.virtual_vertex && !(options.virtual_vertex == VirtualVertexRule{}))
    throw InvalidOption("the operator " + name +
                        " has no virtual vertices; leave out where they lie, their weights and "
                        "whether they stay in the kernel");
  if (!taken.lambda && options.lambda)
    throw InvalidOption("the operator " + name + " has no stabilising term; leave out lambda");
  if (options.lambda && !(*options.lambda > 0 && std::isfinite(*options.lambda)))
    throw InvalidOption("lambda is " + number(*options.lambda) +
                        "; it must be a positive finite number");
  if (taken.lambda && !options.lambda) options.lambda = taken.lambda;
  const auto settle_fraction = [&](const char* what, const std::optional<double>& own,
                                   std::optional<double>& value, const std::string& no_use) {
    if (!own && value) throw InvalidOption("the operator " + name + no_use);
    if (value && !(*value >= 0 && *value <= 1))
      throw InvalidOption(std::string(what) + " is " + number(*value) +
                          "; it must be a number from 0 to 1");
    if (own && !value) value = own;
  };
  settle_fraction("theta", taken.theta, options.theta,
                  " has no stabilised diamonds; leave out theta");
  settle_fraction("tau", taken.tau, options.tau, " has no moment-exact mass; leave out tau");
  if (wanted.tau && options.mass != MassKind::MomentExact)
    throw InvalidOption(std::string("tau belongs to the moment-exact mass, not to the ") +
                        mass_kind_name(options.mass) + " one; leave it out");
  if (!taken.boundary_unknowns && options.boundary_unknowns)
    throw InvalidOption("the operator " + name +
                        " has no unknowns on boundary faces; leave out boundary_unknowns");
  if (taken.boundary_unknowns && !options.boundary_unknowns)
    options.boundary_unknowns = taken.boundary_unknowns;
  if (!taken.products && options.form == OperatorForm::Products)
    throw InvalidOption("the operator " + name +
                        " is given by matrices only; ask for OperatorForm::Matrices");
  if (!taken.own_interfaces && !options.own_interfaces.empty())
    throw InvalidOption("the operator " + name +
                        " has no samples at interfaces; leave out own_interfaces");
  if (!taken.tensor_coefficient && options.cell_coefficient.cols() == 6)
    throw InvalidOption("the operator " + name +
                        " takes scalars a cell as coefficient, not tensors");
  if (!taken.stiffness_alone && options.parts == DiscretizationParts::Stiffness)
    options.parts = DiscretizationParts::Matrices;
  return options;
}

template <class Entry, class Mesh>
Discretization both_phases(const Entry& entry, const Mesh& mesh,
                           const DiscretizationOptions& options) {
  const std::unique_ptr<Assembly> assembly = entry.prepare(mesh, options);
  assembly->reassemble(mesh.points());
  return assembly->release();
}

}  // namespace

const char* mass_kind_name(MassKind kind) {
  switch (kind) {
    case MassKind::Full:
      return "full";
    case MassKind::MomentExact:
      return "moment-exact";
    case MassKind::Lumped:
      return "lumped";
    case MassKind::Voronoi:
      return "voronoi";
    default:
      return "default";
  }
}

template <class Mesh>
std::unique_ptr<Assembly> OperatorEntry<Mesh>::prepare(const Mesh& mesh,
                                                       const DiscretizationOptions& wanted) const {
  DiscretizationOptions settled = settle(wanted);
  std::unique_ptr<Assembly> assembly = make(mesh, settled);
  assembly->set_options(std::move(settled));
  return assembly;
}

template <class Mesh>
DiscretizationOptions OperatorEntry<Mesh>::settle(const DiscretizationOptions& wanted) const {
  return settle_options(name, options, wanted);
}

template struct OperatorEntry<PolygonMesh>;
template struct OperatorEntry<PolyhedralMesh>;

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

namespace {

/// On triangles bunge is cotan, which is assembled in half the time.
bool equals_cotan(const PolygonMesh& mesh) { return mesh.n_corners() == 3 * mesh.n_faces(); }
bool equals_cotan(const PolyhedralMesh&) { return false; }

template <class Mesh>
SparseMatrix assemble_sparser(const Mesh& mesh, const DiscretizationOptions& options) {
  DiscretizationOptions own;
  own.eps_rel = options.eps_rel;
  own.coefficient = options.coefficient;
  own.cell_coefficient = options.cell_coefficient;
  own.threads = options.threads;
  own.parts = DiscretizationParts::Stiffness;
  if (equals_cotan(mesh)) return discretize(mesh, "cotan", own).stiffness;
  own.virtual_vertex = options.virtual_vertex;
  return discretize(mesh, "bunge", own).stiffness;
}

template <class Entry, class Mesh>
std::function<SparseMatrix()> sparser_of(const std::vector<const Entry*>& operators,
                                         const Mesh& mesh, const Discretization& discretization) {
  for (const Entry* const entry : operators)
    if (entry->name == discretization.name && !entry->claims.face_local &&
        discretization.extra.size() == 0)
      return [&mesh, options = discretization.options] { return assemble_sparser(mesh, options); };
  return nullptr;
}

}  // namespace

std::function<SparseMatrix()> sparser_stiffness(const PolygonMesh& mesh,
                                                const Discretization& discretization) {
  return sparser_of(surface_operators(), mesh, discretization);
}

std::function<SparseMatrix()> sparser_stiffness(const PolyhedralMesh& mesh,
                                                const Discretization& discretization) {
  return sparser_of(volume_operators(), mesh, discretization);
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
