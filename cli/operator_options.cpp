#include "cli/operator_options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

namespace carat::cli {
namespace {

template <class Value, std::size_t N>
using Names = std::array<std::pair<const char*, Value>, N>;

constexpr Names<VirtualPoint, 3> kVirtualPoints{{{"area", VirtualPoint::AreaMinimizer},
                                                 {"centroid", VirtualPoint::Centroid},
                                                 {"trace", VirtualPoint::TraceMinimizer}}};
constexpr Names<AffineWeights, 2> kWeights{
    {{"in-plane", AffineWeights::InPlane}, {"minimum-norm", AffineWeights::MinimumNorm}}};

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
  result.lumped_mass = options.lumped;
  result.degenerate = options.strict ? DegeneratePolicy::Strict : DegeneratePolicy::Report;
  return result;
}

}  // namespace

void declare_operator_options(CLI::App& app, OperatorOptions& options) {
  std::vector<std::string> operators;
  for (const SurfaceOperator* entry : surface_operators()) operators.emplace_back(entry->name);
  options.name = operators.front();
  app.add_option("--operator", options.name, "The discrete operator; see carat list operators")
      ->check(CLI::IsMember(operators))
      ->capture_default_str()
      ->group("Operator");
  app.add_option("--virtual-point", options.virtual_point,
                 "Where a face's virtual vertex lies: least squared area of\n"
                 "the virtual triangles, mean of the vertices, or least\n"
                 "trace of the stiffness")
      ->check(CLI::IsMember(names(kVirtualPoints)))
      ->capture_default_str()
      ->group("Operator");
  app.add_option("--weights", options.weights,
                 "Which affine weights give that point on faces that are\n"
                 "not planar")
      ->check(CLI::IsMember(names(kWeights)))
      ->capture_default_str()
      ->group("Operator");
  app.add_flag("--lumped", options.lumped, "Row sums instead of the full mass matrix")
      ->group("Operator");
  app.add_flag("--strict", options.strict,
               "Fail on degenerate elements instead of leaving them out")
      ->group("Operator");
  app.add_flag("--keep-flipped", options.keep_flipped,
               "For studies: leave virtual vertices where they flip a triangle")
      ->group("Operator");
}

Discretization discretize(Session& session, const PolygonMesh& mesh, const OperatorOptions& options,
                          DiscretizationParts parts,
                          const std::function<double(const Vec3&)>& coefficient) {
  DiscretizationOptions library_options = to_library(options);
  library_options.parts = parts;
  library_options.coefficient = coefficient;
  library_options.threads = session.threads();
  const std::unique_ptr<Assembly> assembly = session.phase(
      "symbolic", [&] { return surface_operator(options.name).prepare(mesh, library_options); });
  session.phase("numeric", [&] { assembly->update(mesh.points()); });
  Discretization discretization = assembly->release();

  session.report()["options"] = to_json(options);
  Json& nnz = session.report()["nnz"];
  nnz["stiffness"] = discretization.stiffness.nonZeros();
  nnz["mass"] = discretization.mass.nonZeros();
  if (discretization.gradient_dimension > 0)
    for (const char* const name : {"gradient", "divergence"})
      nnz[name] = discretization.gradient.nonZeros();
  session.report()["sizes"]["samples"] = discretization.n_samples();
  session.report()["sizes"]["gradient_dimension"] = discretization.gradient_dimension;
  session.say("operator " + discretization.name + ": " + count(discretization.n_vertices(), "row") +
              ", " + std::to_string(discretization.stiffness.nonZeros()) + " stiffness entries");
  session.add_diagnostics(discretization.diagnostics);
  return discretization;
}

Json to_json(const OperatorOptions& options) {
  return {{"operator", options.name},   {"virtual_point", options.virtual_point},
          {"weights", options.weights}, {"lumped", options.lumped},
          {"strict", options.strict},   {"keep_flipped", options.keep_flipped}};
}

}  // namespace carat::cli
