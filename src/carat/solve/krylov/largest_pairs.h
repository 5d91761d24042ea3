#pragma once
// The largest eigenpairs of an inverse, none missing.

#include <functional>

#include "carat/base/types.h"

namespace carat {

/// Applies A = S^-1 M, self-adjoint in the inner product of M, where S is definite: in a subspace
/// that A maps into itself, the M-complement of known null vectors of S.
class InverseOperator {
 public:
  virtual ~InverseOperator() = default;
  virtual Index size() const = 0;
  /// M x.
  virtual Matrix mass_product(const Eigen::Ref<const Matrix>& x) const = 0;
  /// Replaces x by its projection to the subspace.
  virtual void project(Matrix& x) const = 0;
  /// S^-1 of b's part in the image of the subspace under M, in the subspace.
  virtual Matrix solve(Matrix b) const = 0;
};

struct LargestPairs {
  Vector values;   // descending
  Matrix vectors;  // M-orthonormal
  Index solves = 0;
};

/// Number of basis vectors that are held for so many pairs.
Index krylov_dimension(Index wanted);

/// A x = theta x by a block Lanczos iteration with thick restarts [Wu, Simon 2000], complete
/// clusters included.
///
/// A Krylov space of a random block shows as many members of a cluster as the block has columns.
/// Where a cluster has as many, rounds are repeated from random blocks in the complement of all
/// pairs found, until one shows that nothing is left that comes before the last wanted pair.
///
/// \param wanted    krylov_dimension(wanted) must not exceed the dimension of the subspace
/// \param progress  called with the number of pairs that have converged; may throw to end it
/// \throws SolverFailure  no convergence, or M is not definite
LargestPairs largest_pairs(const InverseOperator& op, Index wanted,
                           const std::function<void(Index)>& progress = {});

}  // namespace carat
