#include "carat/apps/heat_geodesics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/solve/componentwise.h"
#include "carat/solve/matrix_operator.h"
#include "carat/solve/semidefinite_solver.h"

namespace carat {
namespace {

// Heat at the source. So far above 1, because it decays by a factor an edge: the range of double
// precision below and above 1 doubles the number of edges that it reaches.
constexpr double kSourceHeat = 1e250;

// Right-hand sides that are solved together: twice as many gain little, and take twice the memory.
constexpr Index kGroup = 16;

using Sources = std::vector<GeodesicSource>;

double step_length(const PolygonMesh& mesh, TimeStepLength kind) {
  double longest = 0, sum = 0;
  for (const auto& [v1, v2] : mesh.edges().vertices) {
    const double length = (mesh.point(v2) - mesh.point(v1)).norm();
    longest = std::max(longest, length);
    sum += length;
  }
  const Index n = mesh.n_edges();
  return kind == TimeStepLength::MaxEdge ? longest : n > 0 ? sum / n : 0;
}

SolverOptions settled(SolverOptions options, int dimension, std::function<SparseMatrix()> sparser) {
  options.dimension = dimension;
  options.sparser = std::move(sparser);
  return options;
}

/// M + t S, diffused by a factorisation or by an iteration that keeps the small values.
class Diffusion {
 public:
  /// \param iterate  instead of a factorisation; where false, only if there is no room for one
  Diffusion(std::shared_ptr<const SparseMatrix> matrix, std::vector<bool> excluded,
            SolverOptions options, bool iterate)
      : matrix_(std::move(matrix)), excluded_(std::move(excluded)), threads_(options.threads) {
    if (!iterate) {
      // Whether there is room is all that is left to choose.
      options.right_hand_sides = std::numeric_limits<Index>::max();
      factorise(options);
      if (info_.kind == SolverKind::Cholesky) return;
      factor_.reset();
    }
    info_ = {.kind = SolverKind::Auto,
             .method = "conjugate gradients to componentwise accuracy",
             .reason = iterate ? "as Poisson's equation" : info_.reason,
             .ordering = {},
             .nonzeros = matrix_->rows(),
             .operator_bytes = MatrixOperator(matrix_).bytes()};
  }

  bool is_factorised() const { return factor_ != nullptr; }
  const SolverInfo& info() const { return info_; }

  Matrix solve(const Matrix& heat, SolveReport& report) const {
    if (factor_) return factor_->solve(heat, &report);
    return solve_componentwise(*matrix_, excluded_, heat, threads_, report);
  }

 private:
  void factorise(const SolverOptions& options) {
    factor_ = std::make_unique<SpdSolver>(matrix_, excluded_, options);
    info_ = factor_->info();
    if (info_.kind == SolverKind::Cholesky) info_.reason = "keeps small values accurate";
  }

  std::shared_ptr<const SparseMatrix> matrix_;
  std::vector<bool> excluded_;
  int threads_;
  SolverInfo info_;
  std::unique_ptr<SpdSolver> factor_;
};

}  // namespace

struct HeatGeodesics::Impl {
  std::shared_ptr<const Discretization> discretization;
  double time_step = 0;
  HeatDirections kind;
  int threads;
  Vector heat_diagonal;
  std::unique_ptr<SemidefiniteSolver> poisson;
  std::unique_ptr<Diffusion> diffusion;

  Index n_vertices() const { return discretization->n_vertices(); }

  void check(const Sources& sources) const {
    const Index n = n_vertices();
    if (sources.empty()) throw InvalidOption("no source vertex; give at least one");
    for (const GeodesicSource& source : sources) {
      const std::string vertex = "source vertex " + std::to_string(source.vertex);
      if (source.vertex < 0 || source.vertex >= n)
        throw InvalidOption(
            vertex + " does not exist; the mesh has vertices 0 to " + std::to_string(n - 1),
            {source.vertex});
      if (poisson->components()[source.vertex] < 0)
        throw InvalidOption(
            vertex + " has no face with an area, or cell with a volume; choose another",
            {source.vertex});
      if (!(source.weight > 0) || !std::isfinite(source.weight))
        throw InvalidOption("the weight of " + vertex + " is " + std::to_string(source.weight) +
                                "; it must be positive",
                            {source.vertex});
    }
  }

  /// The heat of the sources, before it spreads.
  template <class Column>
  void place(const Sources& sources, Column&& heat) const {
    double largest_weight = 0;
    for (const GeodesicSource& source : sources)
      largest_weight = std::max(largest_weight, source.weight);
    heat.setZero();
    for (const GeodesicSource& source : sources)
      heat[source.vertex] +=
          kSourceHeat * heat_diagonal[source.vertex] * (source.weight / largest_weight);
  }

  std::vector<bool> reached(const Sources& sources) const {
    std::vector<bool> components(static_cast<std::size_t>(poisson->n_components()), false);
    for (const GeodesicSource& source : sources)
      components[poisson->components()[source.vertex]] = true;
    return components;
  }

  /// The divergence of the unit directions away from the sources.
  Vector divergence(const Sources& sources, const Vector& heat, GeodesicDistance& result) const {
    const Discretization& d = *discretization;
    const std::vector<Index>& component = poisson->components();
    const std::vector<bool> is_reached = reached(sources);
    Vector directions = d.gradient * heat;
    Vector of_elements;
    if (kind == HeatDirections::Elements) of_elements = d.element_directions(directions);
    const std::vector<bool> vanished = d.normalise_samples(directions);
    for (Index s = 0; s < d.n_samples(); ++s) {
      if (!vanished[static_cast<std::size_t>(s)] || !(d.sample_measure[s] > 0)) continue;
      const SparseMatrix::InnerIterator entry(d.gradient, d.first_row(s));
      if (entry && component[entry.col()] >= 0 && is_reached[component[entry.col()]])
        ++result.unresolved_samples;
    }
    return d.apply_divergence(kind == HeatDirections::Elements ? of_elements : directions);
  }

  /// Shifts the potential in result.values to 0 at the sources.
  void finish(const Sources& sources, GeodesicDistance& result) const {
    const std::vector<Index>& component = poisson->components();
    const std::vector<bool> is_reached = reached(sources);
    std::vector<double> shift(is_reached.size(), 0), count(is_reached.size(), 0);
    for (const GeodesicSource& source : sources) {
      shift[component[source.vertex]] += result.values[source.vertex];
      count[component[source.vertex]] += 1;
    }
    for (Index v = 0; v < n_vertices(); ++v) {
      const Index c = component[v];
      if (c >= 0 && is_reached[c]) {
        result.values[v] -= shift[c] / count[c];
      } else {
        result.values[v] = std::numeric_limits<double>::infinity();
        result.unreachable_vertices.push_back(v);
      }
    }
  }

  /// \param inner_threads  of what is done for one set at a time
  void solve(std::span<const Sources> sets, std::span<GeodesicDistance> results,
             int inner_threads) const {
    const Index k = static_cast<Index>(sets.size());
    Matrix values(n_vertices(), k);
    for (Index i = 0; i < k; ++i) place(sets[i], values.col(i));
    SolveReport of_heat, of_distance;
    values = diffusion->solve(values, of_heat);
    parallel_tasks(k, inner_threads, [&](Index i) {
      values.col(i) = divergence(sets[i], values.col(i), results[i]);
    });
    values = poisson->solve(std::move(values), &of_distance);
    const double of_gradient = 2.0 * static_cast<double>(sizeof(double) + sizeof(Index)) *
                               static_cast<double>(discretization->gradient.nonZeros());
    parallel_tasks(k, inner_threads, [&](Index i) {
      results[i].values = values.col(i);
      results[i].traffic = (of_heat.traffic + of_distance.traffic) / k + of_gradient;
      finish(sets[i], results[i]);
    });
  }
};

HeatGeodesics::HeatGeodesics(const PolygonMesh& mesh, Discretization&& discretization,
                             const HeatGeodesicsOptions& options, SolverOptions solver) {
  if (!(options.t_coef > 0) || !std::isfinite(options.t_coef))
    throw InvalidOption("t_coef is " + std::to_string(options.t_coef) +
                        "; it must be a positive number");
  require_vertex_unknowns(discretization, "heat geodesics");
  if (discretization.n_vertices() != mesh.n_vertices())
    throw InvalidOption("the discretization has " + std::to_string(discretization.n_vertices()) +
                        " vertices, the mesh " + std::to_string(mesh.n_vertices()));
  if (discretization.gradient_dimension == 0)
    throw InvalidOption("heat geodesics need a gradient: the operator " + discretization.name +
                        " defines none, or it was not asked for (DiscretizationParts::Gradient)");
  if (options.directions == HeatDirections::Elements)
    if (const std::string reason = discretization.lacks_element_directions(); !reason.empty())
      throw InvalidOption("the operator " + discretization.name +
                          " gives no directions of elements: " + reason);
  auto impl = std::make_unique<Impl>();
  impl->kind = options.directions;
  impl->threads = solver.threads;
  impl->discretization = std::make_shared<const Discretization>(std::move(discretization));
  const Discretization& d = *impl->discretization;
  const double h = step_length(mesh, options.length);
  impl->time_step = options.t_coef * h * h;
  const std::shared_ptr<const SparseMatrix> stiffness(impl->discretization, &d.stiffness);
  impl->poisson = std::make_unique<SemidefiniteSolver>(stiffness, solver);

  auto heat = std::make_shared<SparseMatrix>(d.mass + impl->time_step * d.stiffness);
  impl->heat_diagonal = heat->diagonal();
  std::vector<bool> excluded(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index v = 0; v < mesh.n_vertices(); ++v) excluded[v] = impl->poisson->components()[v] < 0;
  // On surfaces a factor takes less time than as many iterations as edges lie across.
  const bool iterate = solver.dimension == 3 && impl->poisson->info().kind != SolverKind::Cholesky;
  solver.kind = SolverKind::Auto;
  solver.sparser = nullptr;
  impl->diffusion =
      std::make_unique<Diffusion>(std::move(heat), std::move(excluded), solver, iterate);
  impl_ = std::move(impl);
}

HeatGeodesics::HeatGeodesics(const PolygonMesh& mesh, Discretization discretization,
                             const HeatGeodesicsOptions& options)
    : HeatGeodesics(mesh, std::move(discretization), options,
                    settled(options.solver, 2, sparser_stiffness(mesh, discretization))) {}

// All that it takes from the mesh are lengths of edges.
HeatGeodesics::HeatGeodesics(const PolyhedralMesh& mesh, Discretization discretization,
                             const HeatGeodesicsOptions& options)
    : HeatGeodesics(mesh.face_mesh(), std::move(discretization), options,
                    settled(options.solver, 3, sparser_stiffness(mesh, discretization))) {}

HeatGeodesics::~HeatGeodesics() = default;
HeatGeodesics::HeatGeodesics(HeatGeodesics&&) noexcept = default;
HeatGeodesics& HeatGeodesics::operator=(HeatGeodesics&&) noexcept = default;

const Discretization& HeatGeodesics::discretization() const { return *impl_->discretization; }
double HeatGeodesics::time_step() const { return impl_->time_step; }
const SolverInfo& HeatGeodesics::heat_info() const { return impl_->diffusion->info(); }
const SolverInfo& HeatGeodesics::poisson_info() const { return impl_->poisson->info(); }

GeodesicDistance HeatGeodesics::distance(const Sources& sources) const {
  impl_->check(sources);
  GeodesicDistance result;
  impl_->solve({&sources, 1}, {&result, 1}, 1);
  return result;
}

void HeatGeodesics::distances(std::span<const Sources> sets, const TakeDistance& take) const {
  for (std::size_t i = 0; i < sets.size(); ++i) try {
      impl_->check(sets[i]);
    } catch (const InvalidOption& error) {
      throw InvalidOption("source set " + std::to_string(i) + ": " + error.what(),
                          error.elements());
    }
  // Factors are solved with by several threads, each for sets of its own. An iteration brings its
  // own threads.
  const bool by_factors =
      impl_->diffusion->is_factorised() && impl_->poisson->info().kind == SolverKind::Cholesky;
  const int threads = resolve_threads(impl_->threads);
  const std::size_t group = static_cast<std::size_t>(kGroup);
  const std::size_t block = by_factors ? group * static_cast<std::size_t>(threads) : group;
  for (std::size_t first = 0; first < sets.size(); first += block) {
    const std::size_t size = std::min(block, sets.size() - first);
    std::vector<GeodesicDistance> results(size);
    parallel_tasks(static_cast<Index>((size + group - 1) / group), by_factors ? threads : 1,
                   [&](Index task) {
                     const std::size_t from = group * static_cast<std::size_t>(task);
                     const std::size_t n = std::min(group, size - from);
                     impl_->solve(sets.subspan(first + from, n),
                                  std::span(results).subspan(from, n), by_factors ? 1 : threads);
                   });
    for (std::size_t i = 0; i < size; ++i)
      if (!take(static_cast<Index>(first + i), std::move(results[i]))) return;
  }
}

}  // namespace carat
