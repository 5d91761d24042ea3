#include "carat/distributed/heat_geodesics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "carat/distributed/componentwise.h"
#include "carat/distributed/part_fields.h"
#include "carat/distributed/poisson.h"
#include "carat/distributed/processes.h"
#include "carat/operators/common.h"

namespace carat {
namespace {

// As in apps/heat_geodesics.cpp.
constexpr double kSourceHeat = 1e250;

}  // namespace

struct DistributedGeodesics::Impl {
  Impl(const PartNumbers& part_numbers, Discretization&& own, DistributedPoisson&& solver)
      : numbers(part_numbers),
        exchange(part_numbers),
        discretization(std::move(own)),
        poisson(std::move(solver)) {}

  PartNumbers numbers;
  PartExchange exchange;
  Discretization discretization;  // the part's
  DistributedPoisson poisson;
  std::unique_ptr<PartFields> fields;  // for directions of elements
  double time_step = 0;
  PetscMatrix heat;
  Vector heat_diagonal;  // of the own rows

  bool takes_part(Index own_row) const {
    return components[static_cast<std::size_t>(own_row)] >= 0;
  }
  std::vector<Index> components;  // of the own rows

  /// A source that is one of the part's own vertices.
  struct OwnSource {
    Index vertex, row;  // in the part; among the own rows
    double weight;      // beside the largest
  };
  /// \throws InvalidOption  as distance()
  std::vector<OwnSource> own_sources(const std::vector<GeodesicSource>& sources) const;
};

std::vector<DistributedGeodesics::Impl::OwnSource> DistributedGeodesics::Impl::own_sources(
    const std::vector<GeodesicSource>& sources) const {
  if (sources.empty()) throw InvalidOption("no source vertex; give at least one");
  double largest_weight = 0;
  for (const GeodesicSource& source : sources) {
    const std::string name = "source vertex " + std::to_string(source.vertex);
    if (source.vertex < 0 || source.vertex >= numbers.n_vertices)
      throw InvalidOption(name + " does not exist; the mesh has vertices 0 to " +
                          std::to_string(numbers.n_vertices - 1));
    if (!(source.weight > 0) || !std::isfinite(source.weight))
      throw InvalidOption("the weight of " + name + " is " + std::to_string(source.weight) +
                          "; it must be positive");
    largest_weight = std::max(largest_weight, source.weight);
  }
  std::vector<OwnSource> own;
  for (const GeodesicSource& source : sources) {
    const auto at =
        std::lower_bound(numbers.vertices.begin(), numbers.vertices.end(), source.vertex);
    const Index v = static_cast<Index>(at - numbers.vertices.begin());
    if (at == numbers.vertices.end() || *at != source.vertex || !numbers.own_vertex(v)) continue;
    if (poisson.components()[static_cast<std::size_t>(v)] < 0)
      throw InvalidOption("source vertex " + std::to_string(source.vertex) +
                          " has no face with an area, or cell with a volume; choose another");
    own.push_back({v, numbers.vertex_rows[v] - numbers.first_row, source.weight / largest_weight});
  }
  return own;
}

template <class Mesh>
void DistributedGeodesics::set_up(const MeshPart<Mesh>& part, Discretization&& discretization,
                                  const HeatGeodesicsOptions& options) {
  const EdgeLengths edges = edge_lengths(part);
  const double h = options.length == TimeStepLength::MaxEdge ? edges.longest
                   : edges.count > 0 ? edges.sum / static_cast<double>(edges.count)
                                     : 0;
  together([&] {
    if (!(options.t_coef > 0) || !std::isfinite(options.t_coef))
      throw InvalidOption("t_coef is " + std::to_string(options.t_coef) +
                          "; it must be a positive number");
    require_vertex_unknowns(discretization, "heat geodesics");
    if (discretization.gradient_dimension == 0)
      throw InvalidOption("heat geodesics need a gradient: the operator " + discretization.name +
                          " defines none, or it was not asked for (DiscretizationParts::Gradient)");
    if (options.directions == HeatDirections::Elements)
      if (const std::string reason = discretization.lacks_element_directions(); !reason.empty())
        throw InvalidOption("the operator " + discretization.name +
                            " gives no directions of elements: " + reason);
  });
  DistributedPoisson poisson(part, discretization);
  impl_ = std::make_unique<Impl>(part.numbers, std::move(discretization), std::move(poisson));
  impl_->time_step = options.t_coef * h * h;
  Impl& it = *impl_;
  const Discretization& d = it.discretization;
  if (options.directions == HeatDirections::Elements)
    it.fields = std::make_unique<PartFields>(it.numbers, d);
  SparseMatrix heat;
  together([&] { heat = d.mass + it.time_step * d.stiffness; });
  it.heat = it.exchange.sum(heat);
  const PetscVector diagonal = it.exchange.vector();
  check(MatGetDiagonal(it.heat, diagonal));
  it.heat_diagonal = OwnRows(diagonal).values();
  it.components.resize(static_cast<std::size_t>(it.exchange.n_own()));
  for (std::size_t v = 0; v < it.numbers.vertices.size(); ++v)
    if (const Index own = static_cast<Index>(v); it.numbers.own_vertex(own))
      it.components[static_cast<std::size_t>(it.numbers.vertex_rows[v] - it.numbers.first_row)] =
          it.poisson.components()[v];
  together([&] {
    for (Index row = 0; row < it.heat_diagonal.size(); ++row)
      if (it.takes_part(row) && !(it.heat_diagonal[row] > 0))
        throw SolverFailure("the heat's matrix is not positive definite: a diagonal entry is " +
                            std::to_string(it.heat_diagonal[row]));
  });
}

DistributedGeodesics::DistributedGeodesics(const MeshPart<PolygonMesh>& part,
                                           Discretization discretization,
                                           const HeatGeodesicsOptions& options) {
  set_up(part, std::move(discretization), options);
}

DistributedGeodesics::DistributedGeodesics(const MeshPart<PolyhedralMesh>& part,
                                           Discretization discretization,
                                           const HeatGeodesicsOptions& options) {
  set_up(part, std::move(discretization), options);
}

DistributedGeodesics::~DistributedGeodesics() = default;
DistributedGeodesics::DistributedGeodesics(DistributedGeodesics&&) noexcept = default;

double DistributedGeodesics::time_step() const { return impl_->time_step; }

const Discretization& DistributedGeodesics::discretization() const { return impl_->discretization; }

GeodesicDistance DistributedGeodesics::distance(const std::vector<GeodesicSource>& sources) const {
  const Impl& it = *impl_;
  const Discretization& d = it.discretization;
  const std::vector<Index>& component = it.poisson.components();
  std::vector<Impl::OwnSource> own;
  Vector heat = Vector::Zero(it.exchange.n_own()), inverse = heat;
  std::vector<double> n_sources(static_cast<std::size_t>(it.numbers.n_components), 0);
  together([&] {
    own = it.own_sources(sources);
    for (const Impl::OwnSource& source : own) {
      heat[source.row] += kSourceHeat * it.heat_diagonal[source.row] * source.weight;
      n_sources[static_cast<std::size_t>(component[source.vertex])] += 1;
    }
    for (Index row = 0; row < inverse.size(); ++row)
      if (it.takes_part(row)) inverse[row] = 1 / it.heat_diagonal[row];
  });
  n_sources = sum_of_all(std::move(n_sources));

  SolveReport report;
  const PetscVector values = it.exchange.vector();
  const Vector diffused = solve_componentwise(it.heat, std::move(inverse), std::move(heat), report);
  OwnRows(values).values() = diffused;
  const Vector here = it.exchange.to_part(values);

  GeodesicDistance result;
  Vector directions, divergence;
  std::int64_t unresolved = 0;
  const auto is_reached = [&](Index v) {
    return component[v] >= 0 && n_sources[static_cast<std::size_t>(component[v])] > 0;
  };
  together([&] { directions = d.gradient * here; });
  Vector of_elements;
  if (it.fields) of_elements = it.fields->element_directions(directions);
  together([&] {
    const std::vector<bool> vanished = d.normalise_samples(directions);
    for (Index s = 0; s < d.n_samples(); ++s) {
      if (!vanished[static_cast<std::size_t>(s)] || !(d.sample_measure[s] > 0)) continue;
      const SparseMatrix::InnerIterator entry(d.gradient, d.first_row(s));
      if (entry && is_reached(static_cast<Index>(entry.col()))) ++unresolved;
    }
    divergence = d.apply_divergence(it.fields ? of_elements : directions);
  });
  result.unresolved_samples = static_cast<Index>(sum_of_all(unresolved));
  result.values = it.poisson.solve_integrated(divergence).values;

  // Shifted to 0 at the sources.
  std::vector<double> shift(n_sources.size(), 0);
  for (const Impl::OwnSource& source : own)
    shift[static_cast<std::size_t>(component[source.vertex])] += result.values[source.vertex];
  shift = sum_of_all(std::move(shift));
  for (Index v = 0; v < result.values.size(); ++v) {
    if (is_reached(v)) {
      const std::size_t c = static_cast<std::size_t>(component[v]);
      result.values[v] -= shift[c] / n_sources[c];
    } else {
      result.values[v] = std::numeric_limits<double>::infinity();
      result.unreachable_vertices.push_back(it.numbers.vertices[v]);
    }
  }
  return result;
}

}  // namespace carat
