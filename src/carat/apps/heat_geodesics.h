#pragma once
// Geodesic distance by the heat method: Crane, Weischedel, Wardetzky 2013.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"
#include "carat/solve/spd_solver.h"

namespace carat {

/// The length h in the time step t = t_coef * h^2.
enum class TimeStepLength { MaxEdge, MeanEdge };

/// Where the gradient of the heat is brought to unit length.
enum class HeatDirections {
  Samples,   ///< in every sample
  Elements,  ///< in every face or cell, where samples are averaged first; not for all operators
};

struct HeatGeodesicsOptions {
  double t_coef = 1;
  TimeStepLength length = TimeStepLength::MaxEdge;
  HeatDirections directions = HeatDirections::Samples;
  /// kind, right_hand_sides (how many source sets are expected) and threads are read; the rest
  /// follows from the mesh. The kind is that of Poisson's equation: see heat_info().
  SolverOptions solver{};
};

/// A point to measure from.
struct GeodesicSource {
  Index vertex = 0;
  double weight = 1;  ///< of its heat among several sources, > 0
};

struct GeodesicDistance {
  /// Distance from the nearest source; +infinity at vertices that no source reaches.  [length]
  /// At the sources it is 0 in the mean of each component.
  Vector values;
  std::vector<Index> unreachable_vertices;
  /// Gradient samples where the heat is below the smallest number, so that no direction is known.
  Index unresolved_samples = 0;
  /// Bytes read at least: those of both solutions, as SolveReport::traffic, and the gradient twice.
  /// Of source sets that are solved together, each has its share.
  double traffic = 0;
};

/// The heat method on one mesh; what solves its two systems is kept for any number of source sets.
///
/// (M + t S) u = sources; X = -grad u / |grad u| a sample; S phi = G^T M_s X in the complement of
/// constants of each component.
class HeatGeodesics {
 public:
  /// \param discretization  with its gradient, for directions of elements also its frames; K = 1
  /// \throws InvalidOption  t_coef not positive, no gradient, sizes that do not fit, directions
  ///                        of elements: see Discretization::lacks_element_directions()
  /// \throws SolverFailure  a system is not positive definite
  HeatGeodesics(const PolygonMesh& mesh, Discretization discretization,
                const HeatGeodesicsOptions& options = {});
  HeatGeodesics(const PolyhedralMesh& mesh, Discretization discretization,
                const HeatGeodesicsOptions& options = {});
  ~HeatGeodesics();
  HeatGeodesics(HeatGeodesics&&) noexcept;
  HeatGeodesics& operator=(HeatGeodesics&&) noexcept;

  /// \throws InvalidOption  no source, a vertex that does not exist or has no element, weight <= 0
  GeodesicDistance distance(const std::vector<GeodesicSource>& sources) const;
  GeodesicDistance distance(Index source) const { return distance({GeodesicSource{source}}); }

  /// Gets the number of a source set and its distances; false: no more are wanted.
  using TakeDistance = std::function<bool(Index set, GeodesicDistance&& distance)>;
  /// The distances from each of many source sets by itself, solved for several at a time: each as
  /// from distance(), to rounding. They are handed over in order, on the calling thread, and not
  /// kept: memory is that of a few sets a thread.
  /// \throws InvalidOption  as distance(), before any work; names the set
  void distances(std::span<const std::vector<GeodesicSource>> sets, const TakeDistance& take) const;

  const Discretization& discretization() const;
  double time_step() const;  ///< t  [length^2]
  /// What diffuses the heat. Distances follow from its decay over hundreds of orders of magnitude,
  /// so it is a factorisation, or where that is too large or Poisson's equation in a volume needs
  /// none, solve_componentwise().
  const SolverInfo& heat_info() const;
  const SolverInfo& poisson_info() const;

 private:
  struct Impl;
  HeatGeodesics(const PolygonMesh& mesh, Discretization&& discretization,
                const HeatGeodesicsOptions& options, SolverOptions solver);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace carat
