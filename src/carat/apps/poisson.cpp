#include "carat/apps/poisson.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/operators/registry.h"
#include "carat/solve/matrix_operator.h"
#include "carat/solve/symmetric_matrix.h"

namespace carat {
namespace {

// Lowest eigenvalue of S over its largest entry below which it is singular: of a solvable problem
// it is of the order of (h / diameter)^2.
constexpr double kSingular = 1e-11;

// A right-hand side that misses balance by more than this is a mistake, not discretisation error.
constexpr double kImbalanceLimit = 0.1;

// Mean number of vertices of a face, a cell, from which on a solution with products takes no longer
// than one with the matrix: products with quads take twice as long as their matrix, with hexagons
// and hexahedra as long, with truncated octahedra an eighth; the matrix's assembly is saved.
constexpr double kManyCorners = 5;
constexpr double kManyCellCorners = 7;

/// Estimate of the lowest eigenvalue over the free rows, by inverse iteration.
double lowest_eigenvalue(const SpdSolver& solver, const std::vector<bool>& held) {
  std::mt19937_64 random(1);
  Vector x(static_cast<Eigen::Index>(held.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] =
        held[static_cast<std::size_t>(i)] ? 0 : static_cast<double>(random() >> 11) * 0x1p-52 - 1;
  double inverse = 0;
  for (int iteration = 0; iteration < 3; ++iteration) {
    const double before = x.norm();
    if (!(before > 0)) return std::numeric_limits<double>::infinity();
    x = solver.solve(x / before);
    inverse = x.norm();
  }
  return std::isfinite(inverse) && inverse > 0 ? 1 / inverse : 0;
}

/// The load of n unknowns: the vertices' own, and zeros.
Vector padded(const Vector& load, Index n) {
  Vector all = Vector::Zero(n);
  all.head(load.size()) = load;
  return all;
}

/// \param matrix  copied or moved, as it comes
template <class Matrix>
std::shared_ptr<const SymmetricOperator> as_operator(
    const std::shared_ptr<const SymmetricOperator>& product, Matrix&& matrix,
    const SolverOptions& solver) {
  if (product) return product;
  SparseMatrix own(std::forward<Matrix>(matrix));
  if (solver.storage == MatrixStorage::Triangle)
    return std::make_shared<SymmetricMatrix>(std::move(own), solver.threads);
  return std::make_shared<MatrixOperator>(std::make_shared<SparseMatrix>(std::move(own)),
                                          solver.threads);
}

/// \param many  elements have so many vertices that products beat the matrix
template <class Entry>
OperatorForm form(const Entry& entry, bool many, Index n_vertices, SolverOptions solver,
                  int dimension) {
  solver.dimension = dimension;
  return entry.options.products && many && takes_iteration(solver, n_vertices)
             ? OperatorForm::Products
             : OperatorForm::Matrices;
}

SolverOptions settled(SolverOptions options, int dimension, std::function<SparseMatrix()> sparser) {
  options.dimension = dimension;
  options.sparser = std::move(sparser);
  return options;
}

}  // namespace

OperatorForm poisson_form(const PolygonMesh& mesh, const std::string& operator_name,
                          const SolverOptions& solver) {
  return form(surface_operator(operator_name), mesh.n_corners() > kManyCorners * mesh.n_faces(),
              mesh.n_vertices(), solver, 2);
}

OperatorForm poisson_form(const PolyhedralMesh& mesh, const std::string& operator_name,
                          const SolverOptions& solver) {
  return form(volume_operator(operator_name),
              static_cast<double>(mesh.corner_cells().size()) > kManyCellCorners * mesh.n_cells(),
              mesh.n_vertices(), solver, 3);
}

Poisson::Operators Poisson::operators(const Discretization& d, const SolverOptions& solver) {
  return {as_operator(d.stiffness_product, d.stiffness, solver),
          as_operator(d.mass_product, d.mass, solver)};
}

Poisson::Operators Poisson::operators(Discretization&& d, const SolverOptions& solver) {
  const Eigen::Index n = d.stiffness.rows();
  Operators result{as_operator(d.stiffness_product, std::move(d.stiffness), solver),
                   as_operator(d.mass_product, std::move(d.mass), solver)};
  // The rest of the discretization still knows how many unknowns it has.
  d.stiffness.resize(n, n);
  d.mass.resize(n, n);
  return result;
}

Poisson::Operators Poisson::operators(const std::shared_ptr<const Discretization>& d, int threads) {
  const auto shared = [&](const std::shared_ptr<const ElementProduct>& product,
                          const SparseMatrix& matrix) -> std::shared_ptr<const SymmetricOperator> {
    if (product) return product;
    return std::make_shared<MatrixOperator>(std::shared_ptr<const SparseMatrix>(d, &matrix),
                                            threads);
  };
  return {shared(d->stiffness_product, d->stiffness), shared(d->mass_product, d->mass)};
}

Poisson::Poisson(const PolygonMesh& mesh, const Discretization& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), discretization,
              operators(discretization, solver), conditions,
              settled(solver, 2, sparser_stiffness(mesh, discretization))) {}

Poisson::Poisson(const PolyhedralMesh& mesh, const Discretization& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), discretization,
              operators(discretization, solver), conditions,
              settled(solver, 3, sparser_stiffness(mesh, discretization))) {}

// What is moved out of is read for its name, options and unknowns beyond the vertices alone.
Poisson::Poisson(const PolygonMesh& mesh, Discretization&& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), discretization,
              operators(std::move(discretization), solver), conditions,
              settled(solver, 2, sparser_stiffness(mesh, discretization))) {}

Poisson::Poisson(const PolyhedralMesh& mesh, Discretization&& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), discretization,
              operators(std::move(discretization), solver), conditions,
              settled(solver, 3, sparser_stiffness(mesh, discretization))) {}

Poisson::Poisson(const PolygonMesh& mesh,
                 const std::shared_ptr<const Discretization>& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), *discretization,
              operators(discretization, solver.threads), conditions,
              settled(solver, 2, sparser_stiffness(mesh, *discretization))) {}

Poisson::Poisson(const PolyhedralMesh& mesh,
                 const std::shared_ptr<const Discretization>& discretization,
                 const BoundaryConditions& conditions, const SolverOptions& solver)
    : Poisson(integrate_boundary(mesh, conditions), *discretization,
              operators(discretization, solver.threads), conditions,
              settled(solver, 3, sparser_stiffness(mesh, *discretization))) {}

Poisson Poisson::with_data(const PolygonMesh& mesh, const BoundaryConditions& conditions) const {
  return with_data(integrate_boundary(mesh, conditions), conditions);
}

Poisson Poisson::with_data(const PolyhedralMesh& mesh, const BoundaryConditions& conditions) const {
  return with_data(integrate_boundary(mesh, conditions), conditions);
}

Poisson Poisson::with_data(BoundaryIntegrals boundary, const BoundaryConditions& conditions) const {
  Poisson other = *this;
  const Index n = system_->rows();
  if (boundary.load.size() != n - extra_.size())
    throw InvalidOption("the problem has " + std::to_string(n - extra_.size()) +
                        " vertices, the mesh " + std::to_string(boundary.load.size()));
  other.boundary_load_ = padded(boundary.load, n);
  other.fix_dirichlet_vertices(n - extra_.size(), conditions);
  other.fix_boundary_unknowns(conditions);
  if (other.fixed_ != fixed_ || conditions.robin_sides != robin_sides_ ||
      conditions.robin_alpha != robin_alpha_)
    throw InvalidOption(
        "other Dirichlet vertices, Robin sides or alpha make another system; construct a new "
        "Poisson for it");
  return other;
}

Poisson::Poisson(BoundaryIntegrals boundary, const Discretization& discretization,
                 Operators operators, const BoundaryConditions& conditions, SolverOptions solver)
    : system_(std::move(operators.stiffness)),
      mass_(std::move(operators.mass)),
      extra_(discretization.extra),
      robin_sides_(conditions.robin_sides),
      robin_alpha_(conditions.robin_alpha) {
  const Index n = system_->rows(), n_vertices = n - extra_.size();
  if (n_vertices != boundary.load.size())
    throw InvalidOption("the discretization has " + std::to_string(n_vertices) +
                        " vertices, the mesh " + std::to_string(boundary.load.size()));
  boundary_load_ = padded(boundary.load, n);
  boundary.robin.conservativeResize(n, n);
  component_ = system_->components();
  const Index n_components =
      component_.empty() ? 0 : *std::max_element(component_.begin(), component_.end()) + 1;
  floating_.assign(static_cast<std::size_t>(n_components), true);
  if (boundary.robin.nonZeros() > 0) {
    system_ = system_->plus(boundary.robin);
    if (solver.sparser)
      solver.sparser = [own = std::move(solver.sparser), &boundary] {
        return SparseMatrix(own() + boundary.robin);
      };
    for (Index v = 0; v < n; ++v)
      if (component_[v] >= 0 && SparseMatrix::InnerIterator(boundary.robin, v))
        floating_[component_[v]] = false;
  }
  fix_dirichlet_vertices(n_vertices, conditions);
  fix_boundary_unknowns(conditions);

  // A floating component is held at zero at its best determined vertex, and shifted afterwards.
  held_ = fixed_;
  if (any_floating()) {
    std::vector<Index> ground(floating_.size(), -1);
    const Vector diagonal = system_->diagonal();
    for (Index v = 0; v < n; ++v) {
      const Index c = component_[v];
      if (c >= 0 && floating_[c] && (ground[c] < 0 || diagonal[v] > diagonal[ground[c]]))
        ground[c] = v;
    }
    for (const Index v : ground)
      if (v >= 0) held_[v] = true;
  }
  const Vector row_norms = system_->row_norms();
  for (Index v = 0; v < n; ++v)
    if (!fixed_[v]) system_norm_ = std::max(system_norm_, row_norms[v]);
  const auto refuse_singular = [&] {
    throw SolverFailure("Poisson: with these boundary conditions the stiffness of the operator " +
                        discretization.name +
                        " is singular, beyond constants; give Dirichlet data on all of the "
                        "boundary, eliminate the unknowns of boundary faces, or use the operator "
                        "diamond");
  };
  if (extra_.size() == 0) {
    solver_ = std::make_shared<SpdSolver>(system_, held_, solver);
    return;
  }
  if (solver.kind != SolverKind::Auto && solver.kind != SolverKind::Cholesky)
    throw InvalidOption("the solver " + std::string(solver_kind_name(solver.kind)) +
                        " needs an operator with unknowns at the vertices only; " +
                        discretization.name + " has others: use cholesky");
  solver.kind = SolverKind::Cholesky;
  try {
    solver_ = std::make_shared<SpdSolver>(system_, held_, solver);
  } catch (const SolverFailure&) {
    refuse_singular();
  }
  if (lowest_eigenvalue(*solver_, held_) <= kSingular * system_->diagonal().maxCoeff())
    refuse_singular();
}

/// Unknowns on boundary faces and edges whose vertices all have Dirichlet data.
void Poisson::fix_boundary_unknowns(const BoundaryConditions& conditions) {
  const std::vector<bool> of_vertices = fixed_;
  const Index n_vertices = static_cast<Index>(component_.size()) - extra_.size();
  for (Index k = 0; k < extra_.size(); ++k) {
    const std::span<const Index> vertices = extra_.boundary_vertices.row(k);
    const Index row = n_vertices + k;
    if (vertices.empty() || component_[row] < 0) continue;
    if (!std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return of_vertices[v]; }))
      continue;
    double value = 0;
    if (conditions.dirichlet_function) {
      const Vec3 x = extra_.positions.row(k).transpose();
      value = conditions.dirichlet_function(x);
      if (!std::isfinite(value))
        throw InvalidOption("the Dirichlet function is " + std::to_string(value) + " at (" +
                            std::to_string(x.x()) + ", " + std::to_string(x.y()) + ", " +
                            std::to_string(x.z()) + "); it must be a finite number");
    } else {
      for (const Index v : vertices)
        value += fixed_values_[v] / static_cast<double>(vertices.size());
    }
    fixed_[row] = true;
    fixed_values_[row] = value;
    floating_[component_[row]] = false;
  }
}

void Poisson::fix_dirichlet_vertices(Index n_vertices, const BoundaryConditions& conditions) {
  if (conditions.dirichlet_vertices.size() != conditions.dirichlet_values.size())
    throw InvalidOption("Dirichlet data: lists of " +
                        std::to_string(conditions.dirichlet_vertices.size()) + " and " +
                        std::to_string(conditions.dirichlet_values.size()) +
                        " entries; they must be equally long");
  const Index n = static_cast<Index>(component_.size());
  fixed_.assign(static_cast<std::size_t>(n), false);
  fixed_values_ = Vector::Zero(n);
  for (Index v = 0; v < n; ++v) fixed_[v] = component_[v] < 0;
  std::vector<bool> given(static_cast<std::size_t>(n), false);
  for (std::size_t k = 0; k < conditions.dirichlet_vertices.size(); ++k) {
    const Index v = conditions.dirichlet_vertices[k];
    const double value = conditions.dirichlet_values[k];
    if (v < 0 || v >= n_vertices)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) +
                              " does not exist; the mesh has vertices 0 to " +
                              std::to_string(n_vertices - 1),
                          {v});
    if (!std::isfinite(value))
      throw InvalidOption("Dirichlet value at vertex " + std::to_string(v) + " is " +
                              std::to_string(value) + "; it must be a finite number",
                          {v});
    if (given[v] && fixed_values_[v] != value)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) + " has two values: " +
                              std::to_string(fixed_values_[v]) + " and " + std::to_string(value),
                          {v});
    given[v] = fixed_[v] = true;
    fixed_values_[v] = value;
    if (component_[v] >= 0) floating_[component_[v]] = false;
  }
}

PoissonSolution Poisson::solve(const Vector& f) const {
  if (f.size() != system_->rows())
    throw InvalidOption(std::to_string(f.size()) + " values for " +
                        std::to_string(system_->rows()) + " unknowns");
  return solve_integrated(*mass_ * f);
}

PoissonSolution Poisson::solve_integrated(const Vector& load) const {
  if (load.size() != system_->rows())
    throw InvalidOption(std::to_string(load.size()) + " values for " +
                        std::to_string(system_->rows()) + " unknowns");
  if (!load.allFinite())
    throw InvalidOption("the right-hand side holds a value that is not finite");
  PoissonSolution solution;
  Vector b = load + boundary_load_;

  const std::size_t n_components = floating_.size();
  const Vector vertex_mass =
      any_floating() ? *mass_ * Vector::Ones(b.size()) : Vector(Vector::Zero(b.size()));
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

  const Vector lifted = b - *system_ * fixed_values_;
  solution.values = solver_->solve(lifted, &solution.solve) + fixed_values_;

  // Floating components: mean zero by mass.
  std::vector<double> mean(n_components, 0);
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0 && floating_[c])
      mean[c] += vertex_mass[v] * solution.values[v] / measure[c];
  for (Index v = 0; v < b.size(); ++v)
    if (const Index c = component_[v]; c >= 0 && floating_[c]) solution.values[v] -= mean[c];

  const Vector residual = *system_ * solution.values - b;
  double worst = 0;
  for (Index v = 0; v < b.size(); ++v)
    if (!fixed_[v]) worst = std::max(worst, std::abs(residual[v]));
  const double scale =
      system_norm_ * solution.values.lpNorm<Eigen::Infinity>() + b.lpNorm<Eigen::Infinity>();
  solution.relative_residual = scale > 0 ? worst / scale : 0;
  return solution;
}

namespace {

/// \param multiply  the mass times a vector
template <class Multiply>
ErrorNorms norms_of(const Multiply& multiply, Eigen::Index rows, const Vector& u,
                    const Vector& reference, bool remove_mean) {
  if (u.size() != reference.size() || u.size() != rows)
    throw InvalidOption("error norms of " + std::to_string(u.size()) + " and " +
                        std::to_string(reference.size()) + " values");
  Vector e = u - reference;
  if (remove_mean && e.size() > 0) {
    const Vector weights = multiply(Vector(Vector::Ones(rows)));
    e.array() -= weights.dot(e) / weights.sum();
  }
  ErrorNorms norms;
  if (e.size() == 0) return norms;
  norms.rmse = std::sqrt(e.squaredNorm() / static_cast<double>(e.size()));
  norms.l2 = std::sqrt(std::max(0.0, e.dot(multiply(e))));
  norms.max = e.lpNorm<Eigen::Infinity>();
  return norms;
}

}  // namespace

ErrorNorms error_norms(const SparseMatrix& mass, const Vector& u, const Vector& reference,
                       bool remove_mean) {
  return norms_of([&](const Vector& x) { return Vector(mass * x); }, mass.rows(), u, reference,
                  remove_mean);
}

ErrorNorms error_norms(const SymmetricOperator& mass, const Vector& u, const Vector& reference,
                       bool remove_mean) {
  return norms_of([&](const Vector& x) { return mass * x; }, mass.rows(), u, reference,
                  remove_mean);
}

}  // namespace carat
