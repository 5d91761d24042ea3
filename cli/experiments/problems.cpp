#include <algorithm>
#include <cmath>
#include <map>

#include "carat/apps/mean_curvature.h"
#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/mesh/statistics.h"
#include "carat/report/franke.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/semidefinite_solver.h"
#include "cli/experiments/series.h"

namespace carat::cli {
namespace {

const PolygonMesh& edges_of(const PolygonMesh& mesh) { return mesh; }
const PolygonMesh& edges_of(const PolyhedralMesh& mesh) { return mesh.face_mesh(); }

const OperatorOptionSet& option_set(const PolygonMesh*, const std::string& name) {
  return surface_operator(name).options;
}
const OperatorOptionSet& option_set(const PolyhedralMesh*, const std::string& name) {
  return volume_operator(name).options;
}

PolygonMesh generate(const PolygonMesh*, const std::string& family, const FamilyOptions& options) {
  return generate_mesh(family, options);
}
PolyhedralMesh generate(const PolyhedralMesh*, const std::string& family,
                        const FamilyOptions& options) {
  return generate_volume(family, options);
}

double waves(const Vec3& x) { return std::sin(7 * x.x() + 1) * std::cos(4 * x.y()); }
double waves_laplacian(const Vec3& x) { return -65 * waves(x); }
double waves_3d(const Vec3& x) {
  return std::sin(5 * x.x() + 1) * std::cos(4 * x.y()) * std::sin(3 * x.z() + 0.5);
}
double waves_3d_laplacian(const Vec3& x) { return -50 * waves_3d(x); }

}  // namespace

const TestFunction kFranke{measures::franke, measures::franke_laplacian};
const TestFunction kFranke3d{measures::franke_3d, measures::franke_3d_laplacian};
const TestFunction kWaves{waves, waves_laplacian};
const TestFunction kWaves3d{waves_3d, waves_3d_laplacian};

double third_harmonic(const Vec3& x) {
  return x.y() * (4 * x.z() * x.z() - x.x() * x.x() - x.y() * x.y());
}
double fourth_harmonic(const Vec3& x) {
  return x.x() * x.z() * (7 * x.z() * x.z() - 3 * x.squaredNorm());
}

std::vector<Method> compared_methods(const std::string& family) {
  const bool volume = family.rfind("cube-", 0) == 0 || family.rfind("ball-", 0) == 0;
  std::vector<Method> methods{{"diamond"}, {"stabilized_diamond"}};
  const auto add_all = [&](const auto& operators) {
    for (const auto* entry : operators) {
      const std::string name = entry->name;
      const bool simplices = family.find(volume ? "-tets" : "-triangles") != std::string::npos;
      if (name == "diamond" || name == "stabilized_diamond" ||
          (entry->claims.simplices_only && !simplices))
        continue;
      methods.push_back({name});
      // Published with the lumped mass, measured with both.
      if (volume && name == "bunge") methods.push_back({name, MassKind::Full});
    }
  };
  if (volume)
    add_all(volume_operators());
  else
    add_all(surface_operators());
  return methods;
}

DiscretizationOptions options_of(const Method& method, DiscretizationParts parts, int threads) {
  DiscretizationOptions options;
  options.mass = method.mass;
  options.theta = method.theta;
  options.tau = method.tau;
  options.parts = parts;
  options.threads = threads;
  return options;
}

template <class Mesh>
Json parameters_of(const Method& method) {
  const OperatorOptionSet& taken = option_set(static_cast<const Mesh*>(nullptr), method.name);
  const MassKind mass = method.mass == MassKind::Default ? taken.masses.front() : method.mass;
  const auto fraction = [](const std::optional<double>& value, const std::optional<double>& own) {
    return value ? Json(*value) : own ? Json(*own) : Json(nullptr);
  };
  return {{"operator", method.name},
          {"mass", mass_kind_name(mass)},
          {"theta", fraction(method.theta, taken.theta)},
          {"tau", mass == MassKind::MomentExact ? fraction(method.tau, taken.tau) : Json(nullptr)}};
}

template <class Mesh>
const Mesh& MeshSource<Mesh>::get(const std::string& family, const FamilyOptions& options) {
  const std::string key = family + ' ' + std::to_string(options.level) + ' ' +
                          std::to_string(options.jitter) + ' ' + std::to_string(options.anisotropy);
  if (key != key_) {
    mesh_ = generate(static_cast<const Mesh*>(nullptr), family, options);
    key_ = key;
  }
  return mesh_;
}

template <class Mesh>
Json sizes_of(const Mesh& mesh) {
  const MeshStatistics statistics = mesh_statistics(edges_of(mesh));
  return {{"vertices", mesh.n_vertices()},
          {"mean_edge", statistics.edge_length.mean},
          {"max_edge", statistics.edge_length.max}};
}

template <class Mesh>
Vector values_at(const Mesh& mesh, double (*function)(const Vec3&)) {
  Vector values(mesh.n_vertices());
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    values[v] = function(Vec3(mesh.points().row(v).transpose()));
  return values;
}

double root_mean_square(const Vector& errors) {
  return errors.norm() / std::sqrt(static_cast<double>(errors.size()));
}

template <class Mesh>
std::vector<double> dirichlet_errors(const Mesh& mesh, const SparseMatrix& stiffness,
                                     const std::vector<const SparseMatrix*>& masses,
                                     const TestFunction& function) {
  const std::vector<bool> fixed = boundary_vertices(mesh);
  const Vector exact = values_at(mesh, function.value);
  const Vector source = -values_at(mesh, function.laplacian);
  Vector boundary = exact;
  double n_free = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (!fixed[static_cast<std::size_t>(v)]) {
      boundary[v] = 0;
      ++n_free;
    }
  const Vector from_boundary = stiffness * boundary;
  Matrix loads(mesh.n_vertices(), static_cast<Eigen::Index>(masses.size()));
  for (std::size_t k = 0; k < masses.size(); ++k)
    loads.col(static_cast<Eigen::Index>(k)) = *masses[k] * source - from_boundary;
  // Fixed rows of the solution are zero.
  const Matrix solutions = Cholesky(stiffness, fixed).solve(loads);
  std::vector<double> errors;
  for (Eigen::Index k = 0; k < solutions.cols(); ++k)
    errors.push_back((solutions.col(k) + boundary - exact).norm() / std::sqrt(n_free));
  return errors;
}

double dirichlet_error(const PolyhedralMesh& mesh, const Discretization& discretization,
                       const TestFunction& function) {
  const Index n = mesh.n_vertices();
  Vector exact(discretization.n_unknowns()), source(discretization.n_unknowns());
  exact.head(n) = values_at(mesh, function.value);
  source.head(n) = -values_at(mesh, function.laplacian);
  for (Index k = 0; k < discretization.extra.size(); ++k) {
    const Vec3 x = discretization.extra.positions.row(k).transpose();
    exact[n + k] = function.value(x);
    source[n + k] = -function.laplacian(x);
  }
  const std::vector<bool> boundary = boundary_vertices(mesh);
  BoundaryConditions conditions;
  for (Index v = 0; v < n; ++v)
    if (boundary[static_cast<std::size_t>(v)]) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(exact[v]);
    }
  const Vector values = Poisson(mesh, discretization, conditions).solve(source).values;
  double sum = 0, n_free = 0;
  for (Index v = 0; v < n; ++v) {
    if (boundary[static_cast<std::size_t>(v)]) continue;
    sum += (values[v] - exact[v]) * (values[v] - exact[v]);
    ++n_free;
  }
  return std::sqrt(sum / n_free);
}

std::vector<double> sphere_poisson_errors(const SparseMatrix& stiffness,
                                          const std::vector<const SparseMatrix*>& masses,
                                          const Vector& eigenfunction, double eigenvalue) {
  const SemidefiniteSolver solver(stiffness);
  std::vector<double> errors;
  for (const SparseMatrix* mass : masses) {
    Vector error = solver.solve(Vector(*mass * eigenfunction)) - eigenfunction / eigenvalue;
    error.array() -= error.mean();
    errors.push_back(root_mean_square(error));
  }
  return errors;
}

Json applied_error(const SparseMatrix& stiffness, const SparseMatrix& mass,
                   const Vector& eigenfunction, double eigenvalue) {
  try {
    const Vector applied = Cholesky(mass).solve(Vector(stiffness * eigenfunction));
    return root_mean_square(applied - eigenvalue * eigenfunction);
  } catch (const SolverFailure&) {
    return nullptr;
  }
}

Json sphere_curvature_error(const PolygonMesh& mesh, Discretization discretization) {
  try {
    const Vector curvature = mean_curvature(mesh, discretization, true).values;
    return root_mean_square(curvature - Vector::Ones(curvature.size()));
  } catch (const SolverFailure&) {
    return nullptr;
  }
}

void mark_finest(std::vector<Json>& rows) {
  std::map<std::string, int> finest;
  for (const Json& row : rows) {
    int& level = finest[row["family"]];
    level = std::max(level, row["level"].get<int>());
  }
  for (Json& row : rows) row["finest"] = row["level"] == finest[row["family"]] ? 1 : 0;
}

template Json parameters_of<PolygonMesh>(const Method&);
template Json parameters_of<PolyhedralMesh>(const Method&);
template class MeshSource<PolygonMesh>;
template class MeshSource<PolyhedralMesh>;
template Json sizes_of(const PolygonMesh&);
template Json sizes_of(const PolyhedralMesh&);
template Vector values_at(const PolygonMesh&, double (*)(const Vec3&));
template Vector values_at(const PolyhedralMesh&, double (*)(const Vec3&));
template std::vector<double> dirichlet_errors(const PolygonMesh&, const SparseMatrix&,
                                              const std::vector<const SparseMatrix*>&,
                                              const TestFunction&);
template std::vector<double> dirichlet_errors(const PolyhedralMesh&, const SparseMatrix&,
                                              const std::vector<const SparseMatrix*>&,
                                              const TestFunction&);

}  // namespace carat::cli
