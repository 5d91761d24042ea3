#include "carat/apps/heat_geodesics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carat/base/error.h"
#include "carat/operators/common.h"

namespace carat {
namespace {

// Heat at the source. So far above 1, because it decays by a factor an edge: the range of double
// precision below and above 1 doubles the number of edges that it reaches.
constexpr double kSourceHeat = 1e250;

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

}  // namespace

HeatGeodesics::HeatGeodesics(const PolygonMesh& mesh, Discretization discretization,
                             const HeatGeodesicsOptions& options)
    : discretization_(std::move(discretization)), directions_(options.directions) {
  if (!(options.t_coef > 0) || !std::isfinite(options.t_coef))
    throw InvalidOption("t_coef is " + std::to_string(options.t_coef) +
                        "; it must be a positive number");
  require_vertex_unknowns(discretization_, "heat geodesics");
  if (discretization_.n_vertices() != mesh.n_vertices())
    throw InvalidOption("the discretization has " + std::to_string(discretization_.n_vertices()) +
                        " vertices, the mesh " + std::to_string(mesh.n_vertices()));
  if (discretization_.gradient_dimension == 0)
    throw InvalidOption("heat geodesics need a gradient: the operator " + discretization_.name +
                        " defines none, or it was not asked for (DiscretizationParts::Gradient)");
  if (directions_ == HeatDirections::Elements)
    if (const std::string reason = discretization_.lacks_element_directions(); !reason.empty())
      throw InvalidOption("the operator " + discretization_.name +
                          " gives no directions of elements: " + reason);
  const double h = step_length(mesh, options.length);
  time_step_ = options.t_coef * h * h;
  const SparseMatrix heat = discretization_.mass + time_step_ * discretization_.stiffness;
  heat_diagonal_ = heat.diagonal();
  poisson_ = std::make_unique<SemidefiniteSolver>(discretization_.stiffness);
  std::vector<bool> excluded(static_cast<std::size_t>(mesh.n_vertices()));
  for (Index v = 0; v < mesh.n_vertices(); ++v) excluded[v] = poisson_->components()[v] < 0;
  heat_ = std::make_unique<Cholesky>(heat, excluded);
}

// All that it takes from the mesh are lengths of edges.
HeatGeodesics::HeatGeodesics(const PolyhedralMesh& mesh, Discretization discretization,
                             const HeatGeodesicsOptions& options)
    : HeatGeodesics(mesh.face_mesh(), std::move(discretization), options) {}

GeodesicDistance HeatGeodesics::distance(const std::vector<GeodesicSource>& sources) const {
  const Index n = discretization_.n_vertices();
  const std::vector<Index>& component = poisson_->components();
  if (sources.empty()) throw InvalidOption("no source vertex; give at least one");
  Vector heat = Vector::Zero(n);
  double largest_weight = 0;
  for (const GeodesicSource& source : sources) {
    if (source.vertex < 0 || source.vertex >= n)
      throw InvalidOption("source vertex " + std::to_string(source.vertex) +
                              " does not exist; the mesh has vertices 0 to " +
                              std::to_string(n - 1),
                          {source.vertex});
    if (component[source.vertex] < 0)
      throw InvalidOption("source vertex " + std::to_string(source.vertex) +
                              " has no face with an area, or cell with a volume; choose another",
                          {source.vertex});
    if (!(source.weight > 0) || !std::isfinite(source.weight))
      throw InvalidOption("the weight of source vertex " + std::to_string(source.vertex) + " is " +
                              std::to_string(source.weight) + "; it must be positive",
                          {source.vertex});
    largest_weight = std::max(largest_weight, source.weight);
  }
  for (const GeodesicSource& source : sources)
    heat[source.vertex] +=
        kSourceHeat * heat_diagonal_[source.vertex] * (source.weight / largest_weight);

  const Vector u = heat_->solve(heat);
  Vector directions = discretization_.gradient * u;
  GeodesicDistance result;
  std::vector<bool> reached(static_cast<std::size_t>(poisson_->n_components()), false);
  for (const GeodesicSource& source : sources) reached[component[source.vertex]] = true;
  Vector of_elements;
  if (directions_ == HeatDirections::Elements)
    of_elements = discretization_.element_directions(directions);
  const std::vector<bool> vanished = discretization_.normalise_samples(directions);
  for (Index s = 0; s < discretization_.n_samples(); ++s) {
    if (!vanished[static_cast<std::size_t>(s)] || !(discretization_.sample_measure[s] > 0))
      continue;
    const SparseMatrix::InnerIterator entry(discretization_.gradient, discretization_.first_row(s));
    if (entry && component[entry.col()] >= 0 && reached[component[entry.col()]])
      ++result.unresolved_samples;
  }
  if (directions_ == HeatDirections::Elements) directions = of_elements;
  result.values = poisson_->solve(discretization_.apply_divergence(directions));

  std::vector<double> shift(reached.size(), 0), count(reached.size(), 0);
  for (const GeodesicSource& source : sources) {
    shift[component[source.vertex]] += result.values[source.vertex];
    count[component[source.vertex]] += 1;
  }
  for (Index v = 0; v < n; ++v) {
    const Index c = component[v];
    if (c >= 0 && reached[c]) {
      result.values[v] -= shift[c] / count[c];
    } else {
      result.values[v] = std::numeric_limits<double>::infinity();
      result.unreachable_vertices.push_back(v);
    }
  }
  return result;
}

}  // namespace carat
