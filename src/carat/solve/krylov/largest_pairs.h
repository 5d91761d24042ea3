#pragma once
// The largest eigenpairs of an inverse, none missing.

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

/// A x = theta x by Lanczos iterations with implicit restarts, complete clusters included.
///
/// A Krylov space of one vector shows one member of every cluster, and others as late as rounding
/// brings them in. So rounds are repeated from random vectors in the complement of all pairs found
/// until one shows that nothing is left that comes before the last wanted pair. To see that takes a
/// few solves, as it asks for one rough pair alone.
///
/// \param wanted  krylov_dimension(wanted) must not exceed the dimension of the subspace
/// \throws SolverFailure  no convergence, or M is not definite
LargestPairs largest_pairs(const InverseOperator& op, Index wanted);

}  // namespace carat
