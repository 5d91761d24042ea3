#pragma once
// Geodesic distance by the heat method: Crane, Weischedel, Wardetzky 2013.

#include <vector>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"
#include "carat/solve/cholesky.h"

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
};

/// The heat method on one mesh; both factorisations are kept for any number of source sets.
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

  /// \throws InvalidOption  no source, a vertex that does not exist or has no element, weight <= 0
  GeodesicDistance distance(const std::vector<GeodesicSource>& sources) const;
  GeodesicDistance distance(Index source) const { return distance({GeodesicSource{source}}); }

  const Discretization& discretization() const { return discretization_; }
  double time_step() const { return time_step_; }  ///< t  [length^2]
  const FactorInfo& heat_info() const { return heat_->info(); }
  const FactorInfo& poisson_info() const { return poisson_->info(); }

 private:
  Discretization discretization_;
  double time_step_ = 0;
  HeatDirections directions_;
  Vector heat_diagonal_;
  std::unique_ptr<Cholesky> heat_;
  std::unique_ptr<SemidefiniteSolver> poisson_;
};

}  // namespace carat
