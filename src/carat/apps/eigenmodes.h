#pragma once
// Eigenfunctions of the Laplacian on surfaces and in volumes.

#include <vector>

#include "carat/operators/discretization.h"
#include "carat/solve/eigen_solver.h"

namespace carat {

/// The `count` smallest eigenvalues of -div(K grad u) = lambda u and their functions at the
/// vertices: S x = lambda M x. Where no vertex is fixed, the natural boundary condition du/dn = 0
/// holds. Functions are zero at fixed vertices and at vertices of no element. Values: [1/length^2].
///
/// \param dirichlet_vertices  u = 0 there (anywhere, not only on the boundary)
/// \param options  for large volumes, give the dimension and sparser_stiffness()
/// \throws InvalidOption  a vertex that does not exist; count not positive or more than there are
///                        free vertices of elements, or too large: see smallest_eigenpairs()
/// \throws SolverFailure  as smallest_eigenpairs(), e.g. a lumped mass with a negative entry
EigenPairs eigenmodes(const Discretization& discretization, Index count,
                      const std::vector<Index>& dirichlet_vertices = {},
                      const EigenOptions& options = {});

}  // namespace carat
