#include "cli/operator_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "carat/base/error.h"
#include "cli/mesh_kinds.h"

namespace carat::cli {
namespace {

template <class Value, std::size_t N>
using Names = std::array<std::pair<const char*, Value>, N>;

constexpr Names<VirtualPoint, 3> kVirtualPoints{{{"area", VirtualPoint::AreaMinimizer},
                                                 {"centroid", VirtualPoint::Centroid},
                                                 {"trace", VirtualPoint::TraceMinimizer}}};
constexpr Names<AffineWeights, 2> kWeights{
    {{"in-plane", AffineWeights::InPlane}, {"minimum-norm", AffineWeights::MinimumNorm}}};
constexpr Names<MassKind, 5> kMasses{{{"default", MassKind::Default},
                                      {"full", MassKind::Full},
                                      {"moment-exact", MassKind::MomentExact},
                                      {"lumped", MassKind::Lumped},
                                      {"voronoi", MassKind::Voronoi}}};
constexpr Names<bool, 2> kBoundaryUnknowns{{{"keep", true}, {"eliminate", false}}};

template <class Value, std::size_t N>
std::vector<std::string> names(const Names<Value, N>& table) {
  std::vector<std::string> list;
  for (const auto& [name, value] : table) list.emplace_back(name);
  return list;
}

template <class Value, std::size_t N>
Value value_of(const Names<Value, N>& table, const std::string& wanted) {
  Value found = table[0].second;
  for (const auto& [name, value] : table)
    if (wanted == name) found = value;
  return found;
}

DiscretizationOptions to_library(const OperatorOptions& options) {
  DiscretizationOptions result;
  result.virtual_vertex.point = value_of(kVirtualPoints, options.virtual_point);
  result.virtual_vertex.weights = value_of(kWeights, options.weights);
  result.virtual_vertex.keep_in_kernel = !options.keep_flipped;
  result.mass = value_of(kMasses, options.mass);
  result.lambda = options.lambda;
  result.theta = options.theta;
  result.tau = options.tau;
  if (!options.boundary_unknowns.empty())
    result.boundary_unknowns = value_of(kBoundaryUnknowns, options.boundary_unknowns);
  result.degenerate = options.strict ? DegeneratePolicy::Strict : DegeneratePolicy::Report;
  return result;
}

template <class Value, std::size_t N>
const char* name_of(const Names<Value, N>& table, Value wanted) {
  for (const auto& [name, value] : table)
    if (value == wanted) return name;
  return "";
}

/// What the operator was made with; options that it has no use for are left out.
Json to_json(const char* name, const OperatorOptionSet& taken,
             const DiscretizationOptions& options) {
  Json json = {{"operator", name},
               {"mass", mass_kind_name(options.mass)},
               {"strict", options.degenerate == DegeneratePolicy::Strict}};
  if (taken.virtual_vertex) {
    json["virtual_point"] = name_of(kVirtualPoints, options.virtual_vertex.point);
    json["weights"] = name_of(kWeights, options.virtual_vertex.weights);
    json["keep_flipped"] = !options.virtual_vertex.keep_in_kernel;
  }
  if (options.lambda) json["lambda"] = *options.lambda;
  if (options.theta) json["theta"] = *options.theta;
  if (options.tau && options.mass == MassKind::MomentExact) json["tau"] = *options.tau;
  if (options.boundary_unknowns)
    json["boundary_unknowns"] = name_of(kBoundaryUnknowns, *options.boundary_unknowns);
  return json;
}

template <class Entry>
std::vector<std::string> names(const std::vector<const Entry*>& operators) {
  std::vector<std::string> list;
  for (const Entry* entry : operators) list.emplace_back(entry->name);
  return list;
}

std::string join(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

/// The same in lines that fit into a help text.
std::string join_in_lines(const std::vector<std::string>& words) {
  constexpr std::size_t kWidth = 56;
  std::string list;
  std::size_t line_start = 0;
  for (const std::string& word : words) {
    if (!list.empty()) list += ',';
    if (list.size() + word.size() - line_start > kWidth) {
      list += '\n';
      line_start = list.size();
    } else if (!list.empty()) {
      list += ' ';
    }
    list += word;
  }
  return list;
}

/// What is taken where no operator is named.
template <class Mesh>
OperatorChoice default_choice(const Mesh& mesh, const std::optional<Application>& application) {
  if (application) return recommended_operator(*application, mesh);
  return {operators_of(mesh).front()->name};
}

/// "stabilized_diamond, mass moment-exact".
std::string in_words(const OperatorChoice& choice) {
  std::string words = choice.name;
  if (choice.mass != MassKind::Default)
    words += std::string(", mass ") + mass_kind_name(choice.mass);
  if (choice.theta) words += ", theta " + text(*choice.theta);
  return words;
}

/// The operator of that name on meshes of this kind.
template <class Mesh>
const OperatorEntry<Mesh>& operator_named(const Mesh& mesh, const std::string& name) {
  const auto& operators = operators_of(mesh);
  for (const OperatorEntry<Mesh>* entry : operators)
    if (name == entry->name) return *entry;
  throw InvalidOption("--operator " + name + ": there is none of this name for " +
                      words(mesh).plural + "; choose one of " + join(names(operators)));
}

/// The library cannot tell a default that was asked for from one that was not.
void refuse_unused(const std::string& name, const OperatorOptionSet& taken,
                   const OperatorOptions& options) {
  const auto refuse = [&](const char* option) {
    throw InvalidOption(std::string(option) + ": the operator " + name +
                        " has no virtual vertices; leave it out");
  };
  if (taken.virtual_vertex) return;
  if (!options.virtual_point.empty()) refuse("--virtual-point");
  if (!options.weights.empty()) refuse("--weights");
  if (options.keep_flipped) refuse("--keep-flipped");
}

/// The library's message, with the option of the program as the remedy.
DegenerateElement as_option(const DegenerateElement& error) {
  std::string message = error.what();
  const std::string remedy = "use DegeneratePolicy::Report to leave them out";
  if (const std::size_t at = message.find(remedy); at != message.npos)
    message.replace(at, remedy.size(), "leave out --strict");
  return DegenerateElement(message, error.elements());
}

template <class Mesh>
struct LibraryOperator {
  const OperatorEntry<Mesh>& entry;
  DiscretizationOptions options;
};

/// The operator and its options as the library takes them.
template <class Mesh>
LibraryOperator<Mesh> library_operator(const Mesh& mesh, const OperatorOptions& options) {
  const OperatorChoice choice = default_choice(mesh, options.application);
  const OperatorEntry<Mesh>& entry =
      operator_named(mesh, options.name.empty() ? choice.name : options.name);
  refuse_unused(entry.name, entry.options, options);
  DiscretizationOptions library_options = to_library(options);
  if (options.name.empty()) {
    if (options.mass.empty()) library_options.mass = choice.mass;
    if (!options.theta) library_options.theta = choice.theta;
  }
  return {entry, std::move(library_options)};
}

template <class Mesh>
ChosenOperator report_choice(Session& session, const Mesh& mesh, const OperatorOptions& options) {
  LibraryOperator<Mesh> chosen = library_operator(mesh, options);
  session.report()["options"] =
      to_json(chosen.entry.name, chosen.entry.options, chosen.entry.settle(chosen.options));
  return {chosen.entry.name, std::move(chosen.options)};
}

template <class Mesh>
Discretization discretize_mesh(Session& session, const Mesh& mesh, const OperatorOptions& options,
                               DiscretizationParts parts, const Coefficient& coefficient,
                               const SolverOptions* poisson) {
  const auto& [entry, chosen] = library_operator(mesh, options);
  DiscretizationOptions library_options = chosen;
  library_options.parts = parts;
  if (poisson) library_options.form = poisson_form(mesh, entry.name, *poisson);
  library_options.coefficient = coefficient.function;
  library_options.cell_coefficient = coefficient.of_cells;
  library_options.threads = session.threads();
  const std::unique_ptr<Assembly> assembly =
      session.phase("symbolic", [&] { return entry.prepare(mesh, library_options); });
  try {
    session.phase("numeric", [&] { assembly->reassemble(mesh.points()); });
  } catch (const DegenerateElement& error) {
    throw as_option(error);
  }
  Discretization discretization = assembly->release();
  session.moved("symbolic", symbolic_bytes(mesh, discretization));
  session.moved("numeric", assembly_bytes(mesh, discretization));

  session.report()["options"] = to_json(entry.name, entry.options, entry.settle(library_options));
  Json& nnz = session.report()["nnz"];
  const bool assembled = !discretization.stiffness_product;
  nnz["stiffness"] = assembled ? Json(discretization.stiffness.nonZeros()) : Json();
  nnz["mass"] = assembled ? Json(discretization.mass.nonZeros()) : Json();
  if (discretization.extra.size() > 0)
    session.report()["sizes"]["unknowns"] = discretization.n_unknowns();
  if (discretization.gradient_dimension > 0)
    for (const char* const name : {"gradient", "divergence"})
      nnz[name] = discretization.gradient.nonZeros();
  session.report()["sizes"]["samples"] = discretization.n_samples();
  session.report()["sizes"]["gradient_dimension"] = discretization.gradient_dimension;
  session.say(
      "operator " + discretization.name + ": " + count(discretization.n_unknowns(), "row") +
      (assembled
           ? ", " + std::to_string(discretization.stiffness.nonZeros()) + " stiffness entries"
           : ", no matrix: products with " +
                 std::to_string(discretization.stiffness_product->bytes() / 1000000) + " MB"));
  session.add_diagnostics(discretization.diagnostics);
  return discretization;
}

}  // namespace

void declare_operator_options(CLI::App& app, OperatorOptions& options,
                              std::optional<Application> application) {
  options.application = application;
  const bool surfaces_only = application == Application::MeanCurvature;
  std::vector<std::string> choices = names(surface_operators());
  std::string description = "The discrete operator; see carat list operators.\nDefault: " +
                            in_words(default_choice(PolygonMesh(), application));
  if (!surfaces_only)
    description += ",\nin volumes " + in_words(default_choice(PolyhedralMesh(), application));
  description += ".\nSurfaces:\n" + join_in_lines(choices);
  if (!surfaces_only) {
    const std::vector<std::string> of_volumes = names(volume_operators());
    description += ";\nvolumes:\n" + join_in_lines(of_volumes);
    for (const std::string& name : of_volumes)
      if (std::find(choices.begin(), choices.end(), name) == choices.end()) choices.push_back(name);
  }
  app.add_option("--operator", options.name, description)
      ->check(CLI::IsMember(choices))
      ->option_text("NAME")
      ->group("Operator");
  app.add_option("--virtual-point", options.virtual_point,
                 "Where a face's virtual vertex lies: least squared area of\n"
                 "the virtual triangles, mean of the vertices, or least\n"
                 "trace of the stiffness. Of cells: least squared volume,\n"
                 "or the mean")
      ->check(CLI::IsMember(names(kVirtualPoints)))
      ->default_str("area")
      ->group("Operator");
  app.add_option("--weights", options.weights,
                 "Which affine weights give that point on faces that are\n"
                 "not planar")
      ->check(CLI::IsMember(names(kWeights)))
      ->default_str("in-plane")
      ->group("Operator");
  app.add_option("--mass", options.mass,
                 "The mass matrix: full, lumped (row sums), for diamonds\n"
                 "moment-exact, for cotan voronoi; the default is the\n"
                 "operator's own")
      ->check(CLI::IsMember(names(kMasses)))
      ->default_str("default")
      ->group("Operator");
  app.add_flag_callback(
         "--lumped", [&options] { options.mass = "lumped"; }, "--mass lumped")
      ->excludes("--mass")
      ->group("Operator");
  app.add_option("--lambda", options.lambda,
                 "Weight of the stabilising term of the operators that have\n"
                 "one; the default is the operator's own")
      ->check(CLI::PositiveNumber)
      ->group("Operator");
  app.add_option("--theta", options.theta,
                 "Stabilised diamonds: share of the diamond's stiffness,\n"
                 "the rest is bunge's; the default is the operator's own")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Operator");
  app.add_option("--tau", options.tau,
                 "Moment-exact mass: 0 splits a diamond at its base, 1 about\n"
                 "its axis; the default is the operator's own")
      ->check(CLI::Range(0.0, 1.0))
      ->group("Operator");
  if (!surfaces_only)
    app.add_option("--boundary-unknowns", options.boundary_unknowns,
                   "Operators with unknowns at faces: keep those of boundary\n"
                   "faces and edges, or eliminate them as means of their vertices")
        ->check(CLI::IsMember(names(kBoundaryUnknowns)))
        ->group("Operator");
  app.add_flag("--strict", options.strict,
               "Fail on degenerate elements instead of leaving them out")
      ->group("Operator");
  app.add_flag("--keep-flipped", options.keep_flipped,
               "For studies: leave virtual vertices where they flip a triangle")
      ->group("Operator");
}

Discretization discretize(Session& session, const PolygonMesh& mesh, const OperatorOptions& options,
                          DiscretizationParts parts, const Coefficient& coefficient,
                          const SolverOptions* poisson) {
  return discretize_mesh(session, mesh, options, parts, coefficient, poisson);
}

Discretization discretize(Session& session, const PolyhedralMesh& mesh,
                          const OperatorOptions& options, DiscretizationParts parts,
                          const Coefficient& coefficient, const SolverOptions* poisson) {
  return discretize_mesh(session, mesh, options, parts, coefficient, poisson);
}

ChosenOperator choose_operator(Session& session, const PolygonMesh& mesh,
                               const OperatorOptions& options) {
  return report_choice(session, mesh, options);
}

ChosenOperator choose_operator(Session& session, const PolyhedralMesh& mesh,
                               const OperatorOptions& options) {
  return report_choice(session, mesh, options);
}

}  // namespace carat::cli
