// Every stiffness with every mass.

#include <algorithm>
#include <cmath>
#include <map>

#include "carat/base/error.h"
#include "cli/experiments/series.h"

namespace carat::cli {
namespace {

struct NamedMass {
  std::string operator_name, mass;
  std::optional<double> tau;
  SparseMatrix matrix;
};

template <class Mesh>
const auto& operators() {
  if constexpr (std::is_same_v<Mesh, PolygonMesh>)
    return surface_operators();
  else
    return volume_operators();
}

/// Operators with values at the vertices that are defined on the family.
template <class Mesh>
std::vector<Method> stiffnesses(const std::string& family) {
  const bool simplices =
      family.find("-tets") != std::string::npos || family.find("-triangles") != std::string::npos;
  std::vector<Method> methods;
  for (const auto* entry : operators<Mesh>()) {
    if (!entry->claims.vertex_unknowns || (entry->claims.simplices_only && !simplices)) continue;
    if (std::string(entry->name) == "stabilized_diamond")
      for (const double theta : {0.75, 0.6, 0.5})
        methods.push_back({entry->name, MassKind::Full, theta});
    else
      methods.push_back({entry->name});
  }
  return methods;
}

/// Every mass of every operator; those of the stabilised diamond are the diamond's.
template <class Mesh>
std::vector<NamedMass> masses(const Mesh& mesh, const std::vector<Method>& methods, int threads) {
  std::vector<NamedMass> list;
  for (const Method& method : methods) {
    if (method.name == "stabilized_diamond") continue;
    const auto& entries = operators<Mesh>();
    const auto entry = std::find_if(entries.begin(), entries.end(), [&](const auto* candidate) {
      return candidate->name == method.name;
    });
    for (const MassKind mass : (*entry)->options.masses)
      for (const std::optional<double> tau :
           mass == MassKind::MomentExact ? std::vector<std::optional<double>>{0.0, 0.5, 0.75, 1.0}
                                         : std::vector<std::optional<double>>{std::nullopt})
        list.push_back({method.name, mass_kind_name(mass), tau,
                        discretize(mesh, method.name,
                                   options_of({method.name, mass, {}, tau},
                                              DiscretizationParts::Matrices, threads))
                            .mass});
  }
  return list;
}

/// With a blank between those that are not empty.
std::string words(const std::vector<std::string>& list) {
  std::string sentence;
  for (const std::string& word : list) {
    if (!sentence.empty() && !word.empty()) sentence += ' ';
    sentence += word;
  }
  return sentence;
}

/// name of a problem -> errors, one a mass; null where a mass has no inverse.
std::map<std::string, std::vector<Json>> errors_of(const PolygonMesh& mesh,
                                                   const std::string& family,
                                                   const Discretization& d,
                                                   const std::vector<NamedMass>& masses) {
  std::vector<const SparseMatrix*> matrices;
  for (const NamedMass& mass : masses) matrices.push_back(&mass.matrix);
  const auto to_json = [](const std::vector<double>& values) {
    return std::vector<Json>(values.begin(), values.end());
  };
  if (family.rfind("plane-", 0) == 0)
    return {{"franke", to_json(dirichlet_errors(mesh, d.stiffness, matrices, kFranke))},
            {"waves", to_json(dirichlet_errors(mesh, d.stiffness, matrices, kWaves))}};
  const Vector third = values_at(mesh, third_harmonic), fourth = values_at(mesh, fourth_harmonic);
  std::vector<Json> applied, curvature;
  for (const NamedMass& mass : masses) {
    applied.push_back(applied_error(d.stiffness, mass.matrix, third, 12));
    Discretization with_mass;
    with_mass.stiffness = d.stiffness;
    with_mass.mass = mass.matrix;
    curvature.push_back(sphere_curvature_error(mesh, std::move(with_mass)));
  }
  return {{"third harmonic", to_json(sphere_poisson_errors(d.stiffness, matrices, third, 12))},
          {"fourth harmonic", to_json(sphere_poisson_errors(d.stiffness, matrices, fourth, 20))},
          {"applied harmonic", applied},
          {"curvature", curvature}};
}

std::map<std::string, std::vector<Json>> errors_of(const PolyhedralMesh& mesh, const std::string&,
                                                   const Discretization& d,
                                                   const std::vector<NamedMass>& masses) {
  std::vector<const SparseMatrix*> matrices;
  for (const NamedMass& mass : masses) matrices.push_back(&mass.matrix);
  std::map<std::string, std::vector<Json>> errors;
  for (const auto& [name, function] :
       {std::pair{"franke", kFranke3d}, std::pair{"waves", kWaves3d}}) {
    const std::vector<double> values = dirichlet_errors(mesh, d.stiffness, matrices, function);
    errors[name].assign(values.begin(), values.end());
  }
  return errors;
}

template <class Mesh>
std::vector<Json> measure(const Mesh& mesh, const std::string& family, int threads) {
  const std::vector<Method> methods = stiffnesses<Mesh>(family);
  const std::vector<NamedMass> all_masses = masses(mesh, methods, threads);
  std::vector<Json> rows;
  for (const Method& method : methods) {
    const Discretization d =
        discretize(mesh, method.name, options_of(method, DiscretizationParts::Matrices, threads));
    std::map<std::string, std::vector<Json>> errors;
    try {
      errors = errors_of(mesh, family, d, all_masses);
    } catch (const SolverFailure&) {
      continue;  // indefinite stiffness: dual_tet far from Delaunay
    }
    for (const auto& [problem, values] : errors)
      for (std::size_t k = 0; k < values.size(); ++k) {
        Json row = sizes_of(mesh);
        row["problem"] = problem;
        row["operator"] = method.name;
        row["theta"] = method.theta ? Json(*method.theta) : Json(nullptr);
        row["mass"] = words({all_masses[k].operator_name, all_masses[k].mass});
        row["tau"] = all_masses[k].tau ? Json(*all_masses[k].tau) : Json(nullptr);
        row["method"] = words({method.name, method.theta ? text(*method.theta) : ""});
        row["with"] = words({row["mass"], all_masses[k].tau ? text(*all_masses[k].tau) : ""});
        row["error"] = values[k];
        rows.push_back(row);
      }
  }
  return rows;
}

template <class Mesh, class Families>
void add_cases(const Families& families, const char* domain, const std::vector<int>& levels,
               const Extent& extent, std::vector<ExperimentCase>& cases) {
  const auto source = std::make_shared<MeshSource<Mesh>>();
  for (const auto& entry : families) {
    const std::string family = entry.name;
    if (family.rfind(domain, 0) != 0) continue;
    for (const auto& [variant, shape] : {std::pair{"regular", FamilyOptions{}},
                                         std::pair{"jittered", FamilyOptions{.jitter = 0.2}},
                                         std::pair{"anisotropic", FamilyOptions{.anisotropy = 4}}})
      for (const int level : levels) {
        FamilyOptions options = shape;
        options.level = mesh_level(family, level);
        cases.push_back({{{"family", family}, {"variant", variant}, {"level", options.level}},
                         [=, threads = extent.threads] {
                           return measure(source->get(family, options), family, threads);
                         }});
      }
  }
}

/// Error over the least error of the published operators with their own masses.
void compare(std::vector<Json>& rows) {
  const auto key = [](const Json& row) {
    return row["problem"].get<std::string>() + row["family"].get<std::string>() +
           row["variant"].get<std::string>() + std::to_string(row["level"].get<int>());
  };
  std::map<std::string, double> best;
  for (const Json& row : rows) {
    const std::string name = row["operator"], mass = row["mass"];
    if (name == "diamond" || name == "stabilized_diamond" || mass.rfind(name + ' ', 0) != 0 ||
        !row["error"].is_number())
      continue;
    const auto [found, is_new] = best.emplace(key(row), row["error"].get<double>());
    if (!is_new) found->second = std::min(found->second, row["error"].get<double>());
  }
  for (Json& row : rows) {
    const auto found = best.find(key(row));
    row["ratio"] = found != best.end() && row["error"].is_number()
                       ? Json(row["error"].get<double>() / found->second)
                       : Json(nullptr);
  }
}

}  // namespace

extern const Experiment columns_experiment = {
    "columns",
    "Every stiffness with every mass",
    nullptr,
    "Errors of Poisson's equation (Franke's function, waves, harmonics), of the applied harmonic "
    "and of the curvature on regular, jittered (0.2) and anisotropic (4) meshes, over the least "
    "error of the published operators with their own masses: bunge, cotan, alexa_wardetzky, "
    "de_goes, vem, primal_tet, dual_tet. Below 1: better than all of them.",
    {kFamily,
     {"variant", "meshes", "", "text"},
     kLevel,
     {"problem", "problem", "", "text"},
     kOperator,
     kTheta,
     kMass,
     kTau,
     {"method", "stiffness", "", "text"},
     {"with", "mass", "", "text"},
     kVertices,
     kMeanEdge,
     kMaxEdge,
     {"error", "error", "", "number"},
     {"ratio", "error over the best published", "", "number"},
     {"finest", "finest level of the family", "", "integer"}},
    [] {
      Json figures = Json::array();
      for (const char* const mass :
           {"diamond full", "diamond moment-exact", "diamond lumped", "bunge lumped"}) {
        std::string id = std::string("columns-") + mass;
        std::replace(id.begin(), id.end(), ' ', '-');
        Json figure{{"id", id},
                    {"title", std::string("All stiffnesses with the mass ") + mass},
                    {"caption", "Error over the least error of the published operators."},
                    {"kind", "matrix"},
                    {"row", {"problem", "family", "variant"}},
                    {"column", {"method"}},
                    {"value", "ratio"},
                    {"filter", {{"mass", mass}, {"finest", 1}}},
                    {"low_is_good", true}};
        if (std::string(mass) == "diamond moment-exact") figure["filter"]["tau"] = 0.75;
        figures.push_back(figure);
      }
      return figures;
    },
    [](const Extent& extent) {
      std::vector<ExperimentCase> cases;
      const std::vector<int> surface = extent.levels_from(extent.quick ? 2 : 3, 2, 1);
      add_cases<PolygonMesh>(mesh_families(), "plane-", surface, extent, cases);
      add_cases<PolygonMesh>(mesh_families(), "sphere-", surface, extent, cases);
      add_cases<PolyhedralMesh>(volume_families(), "cube-", extent.levels_from(1, 2, 1), extent,
                                cases);
      return cases;
    },
    [](std::vector<Json>& rows) {
      mark_finest(rows);
      compare(rows);
    }};

}  // namespace carat::cli
