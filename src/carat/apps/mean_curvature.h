#pragma once
// Mean curvature from the Laplacian of the coordinates.

#include "carat/operators/discretization.h"

namespace carat {

struct MeanCurvature {
  /// H at every vertex; 0 where it is not defined: on the boundary and at vertices without area.
  Vector values;  ///< [1/length]
  /// Vertices where H is not defined, ascending.
  std::vector<Index> undefined_vertices;
};

/// H = |M^-1 L X| / 2.   [BBA21 section 8.1]
///
/// The system is solved at the inner vertices with zero at the boundary, where L X holds the
/// conormal and not the curvature; flat interiors therefore give 0 to rounding. The coordinates
/// are centred first: the result does not depend on where the mesh lies.
/// \param with_sign  positive where the surface bends away from its normals: +1/R on a sphere of
///                   radius R with outward normals; the normals are those of the faces
/// \throws InvalidOption  mesh and discretization do not fit
/// \throws SolverFailure  the mass matrix is not positive definite
MeanCurvature mean_curvature(const PolygonMesh& mesh, const Discretization& discretization,
                             bool with_sign = false);

}  // namespace carat
