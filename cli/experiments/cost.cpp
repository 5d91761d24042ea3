// What the matrices of every operator cost: Tables 1 and 2.

#include <algorithm>
#include <chrono>

#include "carat/mesh/statistics.h"
#include "carat/solve/cholesky.h"
#include "cli/experiments/series.h"

namespace carat::cli {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Entries above rounding: couplings that cancel on symmetric meshes are stored all the same.
std::int64_t entries_not_0(const SparseMatrix& matrix) {
  double largest = 0;
  for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
    largest = std::max(largest, std::abs(matrix.valuePtr()[k]));
  std::int64_t count = 0;
  for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
    if (std::abs(matrix.valuePtr()[k]) > 1e-12 * largest) ++count;
  return count;
}

template <class Mesh, class Prepare>
std::vector<Json> measure(const Mesh& mesh, const Prepare& prepare) {
  std::unique_ptr<Assembly> assembly;
  Json row = sizes_of(mesh);
  row["symbolic"] = seconds_of([&] { assembly = prepare(mesh); });
  row["numeric"] = seconds_of([&] { assembly->reassemble(mesh.points()); });
  const Discretization d = assembly->release();
  std::vector<bool> fixed = boundary_vertices(mesh);
  fixed.resize(static_cast<std::size_t>(d.n_unknowns()), false);
  for (Index k = 0; k < d.extra.size(); ++k)
    if (d.extra.boundary_vertices.size(k) > 0)
      fixed[static_cast<std::size_t>(mesh.n_vertices() + k)] = true;
  if (std::find(fixed.begin(), fixed.end(), true) == fixed.end()) fixed[0] = true;
  const Cholesky solver(d.stiffness, fixed);
  const Vector load = d.lumped_mass();
  row["back_substitution"] = seconds_of([&] { solver.solve(load); });
  row["unknowns"] = d.n_unknowns();
  row["nnz"] = d.stiffness.nonZeros();
  row["nnz_not_0"] = entries_not_0(d.stiffness);
  row["solver"] = solver.info().method + ", " + solver.info().ordering;
  row["factor_nnz"] = solver.info().nonzeros;
  row["factorisation"] = solver.info().analyse_seconds + solver.info().factor_seconds;
  return {row};
}

const std::vector<ExperimentColumn> kCosts{
    {"unknowns", "unknowns", "", "integer"},
    {"nnz", "entries", "", "integer"},
    {"nnz_not_0", "entries that do not cancel", "", "integer"},
    {"symbolic", "symbolic phase", "s", "number"},
    {"numeric", "numeric phase", "s", "number"},
    {"solver", "solver", "", "text"},
    {"factor_nnz", "entries of the factor", "", "integer"},
    {"factorisation", "factorisation", "s", "number"},
    {"back_substitution", "back-substitution", "s", "number"}};

Json table(const char* id, const char* title) {
  return Json::array({{{"id", id},
                       {"title", title},
                       {"caption",
                        "One thread. Entries: those stored, and those above 1e-12 of the largest. "
                        "The factorisation includes its symbolic analysis."},
                       {"kind", "table"},
                       {"columns",
                        {"family", "vertices", "operator", "unknowns", "nnz", "nnz_not_0",
                         "factorisation", "back_substitution"}},
                       {"filter", nullptr}}});
}

template <class Mesh>
std::vector<ExperimentCase> cases_of(const std::vector<std::pair<const char*, int>>& meshes) {
  std::vector<ExperimentCase> cases;
  const auto source = std::make_shared<MeshSource<Mesh>>();
  for (const auto& [name, level] : meshes) {
    const std::string family = name;
    const FamilyOptions options{.level = level};
    std::vector<Method> methods = compared_methods(family);
    std::erase_if(methods, [](const Method& m) { return m.mass != MassKind::Default; });
    for (const Method& method : methods) {
      Json parameters{{"family", family}, {"level", level}};
      parameters.update(parameters_of<Mesh>(method));
      cases.push_back({parameters, [=] {
                         return measure(source->get(family, options), [&](const Mesh& mesh) {
                           const DiscretizationOptions wanted =
                               options_of(method, DiscretizationParts::Matrices, 1);
                           if constexpr (std::is_same_v<Mesh, PolygonMesh>)
                             return surface_operator(method.name).prepare(mesh, wanted);
                           else
                             return volume_operator(method.name).prepare(mesh, wanted);
                         });
                       }});
    }
  }
  return cases;
}

}  // namespace

extern const Experiment cost_surface_experiment = {
    "cost-surface",
    "What the operators cost on surfaces",
    "Table 1",
    "Entries of the stiffness and seconds of a Cholesky factorisation and of a back-substitution, "
    "supernodal CHOLMOD, on one thread.",
    columns_with(kCosts),
    [] { return table("cost-surface", "Cost on surfaces"); },
    [](const Extent& extent) {
      const int level = extent.quick ? 4 : 6;
      return cases_of<PolygonMesh>({{"plane-triangles", level},
                                    {"plane-quads", level},
                                    {"sphere-hexagons", level - 1},
                                    {"plane-concave", level}});
    },
    nullptr};

extern const Experiment cost_volume_experiment = {
    "cost-volume",
    "What the operators cost in volumes",
    "Table 2",
    "Entries of the stiffness and seconds of a Cholesky factorisation and of a back-substitution, "
    "supernodal CHOLMOD, on one thread.",
    columns_with(kCosts),
    [] { return table("cost-volume", "Cost in volumes"); },
    [](const Extent& extent) {
      const int level = extent.quick ? 2 : 3;
      return cases_of<PolyhedralMesh>({{"cube-hexahedra", level},
                                       {"cube-pyramids", level},
                                       {"cube-truncated", level},
                                       {"cube-tets", level},
                                       {"cube-voronoi", level - 1}});
    },
    nullptr};

}  // namespace carat::cli
