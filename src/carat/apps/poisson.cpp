#include "carat/apps/poisson.h"

#include <algorithm>
#include <cmath>

#include "carat/base/error.h"

namespace carat {
namespace {

// A right-hand side that misses balance by more than this is a mistake, not discretisation error.
constexpr double kImbalanceLimit = 0.1;

void check_sizes(std::size_t a, std::size_t b, const char* what) {
  if (a != b)
    throw InvalidOption(std::string(what) + ": lists of " + std::to_string(a) + " and " +
                        std::to_string(b) + " entries; they must be equally long");
}

void check_finite(double value, const char* what, Index element) {
  if (!std::isfinite(value))
    throw InvalidOption(std::string(what) + " at " + std::to_string(element) + " is " +
                            std::to_string(value) + "; it must be a finite number",
                        {element});
}

/// Half the length of a boundary edge: its share of each end in the linear trace.
double half_length(const PolygonMesh& mesh, Index edge, const char* what) {
  const EdgeTopology& edges = mesh.edges();
  if (edge < 0 || edge >= edges.size())
    throw InvalidOption(std::string(what) + ": edge " + std::to_string(edge) +
                            " does not exist; the mesh has edges 0 to " +
                            std::to_string(edges.size() - 1),
                        {edge});
  if (edges.corners.size(edge) != 1)
    throw InvalidOption(std::string(what) + ": edge " + std::to_string(edge) + " has " +
                            std::to_string(edges.corners.size(edge)) +
                            " faces and is not on the boundary",
                        {edge});
  const auto [v1, v2] = edges.vertices[edge];
  return (mesh.point(v2) - mesh.point(v1)).norm() / 2;
}

}  // namespace

Poisson::Poisson(const PolygonMesh& mesh, const Discretization& discretization,
                 const BoundaryConditions& conditions)
    : system_(discretization.stiffness), mass_(discretization.mass) {
  const Index n = mesh.n_vertices();
  if (system_.rows() != n)
    throw InvalidOption("the discretization has " + std::to_string(system_.rows()) +
                        " vertices, the mesh " + std::to_string(n));
  check_sizes(conditions.dirichlet_vertices.size(), conditions.dirichlet_values.size(),
              "Dirichlet data");
  check_sizes(conditions.neumann_edges.size(), conditions.neumann_flux.size(), "Neumann data");
  check_sizes(conditions.robin_edges.size(), conditions.robin_alpha.size(), "Robin data");
  check_sizes(conditions.robin_edges.size(), conditions.robin_g.size(), "Robin data");

  component_ = matrix_components(system_);
  const Index n_components =
      component_.empty() ? 0 : *std::max_element(component_.begin(), component_.end()) + 1;
  floating_.assign(static_cast<std::size_t>(n_components), true);

  boundary_load_ = Vector::Zero(n);
  for (std::size_t k = 0; k < conditions.neumann_edges.size(); ++k) {
    const Index edge = conditions.neumann_edges[k];
    check_finite(conditions.neumann_flux[k], "Neumann flux", edge);
    const double weight = half_length(mesh, edge, "Neumann data") * conditions.neumann_flux[k];
    for (const Index v : mesh.edges().vertices[edge]) boundary_load_[v] += weight;
  }
  for (std::size_t k = 0; k < conditions.robin_edges.size(); ++k) {
    const Index edge = conditions.robin_edges[k];
    const double alpha = conditions.robin_alpha[k];
    check_finite(alpha, "Robin alpha", edge);
    check_finite(conditions.robin_g[k], "Robin g", edge);
    if (alpha < 0)
      throw InvalidOption("Robin alpha at edge " + std::to_string(edge) + " is " +
                              std::to_string(alpha) + "; it must not be negative",
                          {edge});
    const double half = half_length(mesh, edge, "Robin data");
    for (const Index v : mesh.edges().vertices[edge]) {
      system_.coeffRef(v, v) += alpha * half;
      boundary_load_[v] += half * conditions.robin_g[k];
      if (alpha > 0 && component_[v] >= 0) floating_[component_[v]] = false;
    }
  }

  fixed_.assign(static_cast<std::size_t>(n), false);
  fixed_values_ = Vector::Zero(n);
  for (Index v = 0; v < n; ++v) fixed_[v] = component_[v] < 0;
  std::vector<bool> given(static_cast<std::size_t>(n), false);
  for (std::size_t k = 0; k < conditions.dirichlet_vertices.size(); ++k) {
    const Index v = conditions.dirichlet_vertices[k];
    const double value = conditions.dirichlet_values[k];
    if (v < 0 || v >= n)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) +
                              " does not exist; the mesh has vertices 0 to " +
                              std::to_string(n - 1),
                          {v});
    check_finite(value, "Dirichlet value", v);
    if (given[v] && fixed_values_[v] != value)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) + " has two values: " +
                              std::to_string(fixed_values_[v]) + " and " + std::to_string(value),
                          {v});
    given[v] = fixed_[v] = true;
    fixed_values_[v] = value;
    if (component_[v] >= 0) floating_[component_[v]] = false;
  }

  // A floating component is held at zero at its best determined vertex, and shifted afterwards.
  std::vector<bool> held = fixed_;
  std::vector<Index> ground(floating_.size(), -1);
  const Vector diagonal = system_.diagonal();
  for (Index v = 0; v < n; ++v) {
    const Index c = component_[v];
    if (c >= 0 && floating_[c] && (ground[c] < 0 || diagonal[v] > diagonal[ground[c]]))
      ground[c] = v;
  }
  for (const Index v : ground)
    if (v >= 0) held[v] = true;
  solver_ = std::make_unique<SpdSolver>(system_, held);
}

PoissonSolution Poisson::solve(const Vector& f) const {
  if (f.size() != system_.rows())
    throw InvalidOption(std::to_string(f.size()) + " values for " + std::to_string(system_.rows()) +
                        " vertices");
  return solve_integrated(mass_ * f);
}

PoissonSolution Poisson::solve_integrated(const Vector& load) const {
  if (load.size() != system_.rows())
    throw InvalidOption(std::to_string(load.size()) + " values for " +
                        std::to_string(system_.rows()) + " vertices");
  if (!load.allFinite())
    throw InvalidOption("the right-hand side holds a value that is not finite");
  PoissonSolution solution;
  Vector b = load + boundary_load_;

  const std::size_t n_components = floating_.size();
  const Vector vertex_mass = mass_ * Vector::Ones(mass_.cols());
  std::vector<double> sum(n_components, 0), total(n_components, 0), measure(n_components, 0);
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0) {
      sum[c] += b[v];
      total[c] += std::abs(b[v]);
      measure[c] += vertex_mass[v];
    }
  for (std::size_t c = 0; c < n_components; ++c) {
    if (!floating_[c]) continue;
    ++solution.floating_components;
    const double imbalance = total[c] > 0 ? std::abs(sum[c]) / total[c] : 0;
    solution.imbalance = std::max(solution.imbalance, imbalance);
    if (imbalance > kImbalanceLimit)
      throw SolverFailure("component " + std::to_string(c) +
                          " has no Dirichlet or Robin data, and its right-hand side and fluxes "
                          "integrate to " +
                          std::to_string(sum[c]) + " (" + std::to_string(imbalance) +
                          " of their absolute integral, at most " +
                          std::to_string(kImbalanceLimit) +
                          "): no solution exists; balance them or give Dirichlet data");
  }
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0 && floating_[c])
      b[v] -= sum[c] / measure[c] * vertex_mass[v];

  const Vector lifted = b - system_ * fixed_values_;
  solution.values = solver_->solve(lifted) + fixed_values_;

  // Floating components: mean zero by mass.
  std::vector<double> mean(n_components, 0);
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0 && floating_[c])
      mean[c] += vertex_mass[v] * solution.values[v] / measure[c];
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0 && floating_[c]) solution.values[v] -= mean[c];

  const Vector residual = system_ * solution.values - b;
  double worst = 0, row_norm = 0;
  for (Index v = 0; v < b.size(); ++v) {
    if (fixed_[v]) continue;
    worst = std::max(worst, std::abs(residual[v]));
    double row = 0;
    for (SparseMatrix::InnerIterator entry(system_, v); entry; ++entry)
      row += std::abs(entry.value());
    row_norm = std::max(row_norm, row);
  }
  const double scale =
      row_norm * solution.values.lpNorm<Eigen::Infinity>() + b.lpNorm<Eigen::Infinity>();
  solution.relative_residual = scale > 0 ? worst / scale : 0;
  return solution;
}

ErrorNorms error_norms(const SparseMatrix& mass, const Vector& u, const Vector& reference,
                       bool remove_mean) {
  if (u.size() != reference.size() || u.size() != mass.rows())
    throw InvalidOption("error norms of " + std::to_string(u.size()) + " and " +
                        std::to_string(reference.size()) + " values");
  Vector e = u - reference;
  if (remove_mean && e.size() > 0) {
    const Vector weights = mass * Vector::Ones(mass.cols());
    e.array() -= weights.dot(e) / weights.sum();
  }
  ErrorNorms norms;
  if (e.size() == 0) return norms;
  norms.rmse = std::sqrt(e.squaredNorm() / static_cast<double>(e.size()));
  norms.l2 = std::sqrt(std::max(0.0, e.dot(mass * e)));
  norms.max = e.lpNorm<Eigen::Infinity>();
  return norms;
}

}  // namespace carat
