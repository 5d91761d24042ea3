#pragma once
// Geodesic distance over all processes.

#include <memory>

#include "carat/apps/heat_geodesics.h"
#include "carat/mesh/mesh_part.h"
#include "carat/operators/part_discretization.h"

namespace carat {

/// The heat method on a mesh of which every process holds a part, as HeatGeodesics on one that is
/// whole. The heat is iterated to componentwise accuracy, the distance solved as by
/// DistributedPoisson.
class DistributedGeodesics {
 public:
  /// Collective. \param discretization  of discretize_part(), with its gradient, for directions
  ///                                 of elements also its frames
  /// \throws InvalidOption  as HeatGeodesics, Shared
  /// \throws SolverFailure  likewise
  DistributedGeodesics(const MeshPart<PolygonMesh>& part, Discretization discretization,
                       const HeatGeodesicsOptions& options = {});
  DistributedGeodesics(const MeshPart<PolyhedralMesh>& part, Discretization discretization,
                       const HeatGeodesicsOptions& options = {});
  ~DistributedGeodesics();
  DistributedGeodesics(DistributedGeodesics&&) noexcept;

  /// Collective. \param sources  numbered as in the whole mesh, the same in all processes
  /// \return values and unreachable vertices of the part; unresolved samples of the whole mesh
  GeodesicDistance distance(const std::vector<GeodesicSource>& sources) const;
  double time_step() const;
  const Discretization& discretization() const;  ///< the part's

 private:
  struct Impl;
  template <class Mesh>
  void set_up(const MeshPart<Mesh>& part, Discretization&& discretization,
              const HeatGeodesicsOptions& options);
  std::unique_ptr<Impl> impl_;
};

}  // namespace carat
