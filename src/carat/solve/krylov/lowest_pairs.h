#pragma once
// The lowest eigenpairs of a pencil without a factorisation.

#include <functional>

#include "carat/base/types.h"

namespace carat {

/// S and M in a subspace, the M-complement of known null vectors of S.
class PreconditionedPencil {
 public:
  virtual ~PreconditionedPencil() = default;
  virtual Index size() const = 0;
  virtual Matrix stiffness_product(const Eigen::Ref<const Matrix>& x) const = 0;
  virtual Matrix mass_product(const Eigen::Ref<const Matrix>& x) const = 0;
  /// About S^-1 r, in the subspace.
  virtual Matrix precondition(const Matrix& r) const = 0;
};

struct LowestPairs {
  Vector values;   // ascending
  Matrix vectors;  // M-orthonormal
  Index iterations = 0;
  Index applications = 0;  // of the preconditioner
};

/// Number of vectors of the block that is iterated.
Index block_size(Index wanted);

/// S x = lambda M x by the locally optimal block preconditioned conjugate gradient method
/// [Knyazev 2001], with a basis that is kept M-orthonormal [Hetmaniuk, Lehoucq 2006].
///
/// The block holds more vectors than are wanted, from random ones on, so that it sees all members
/// of a cluster; the iteration ends when the first one beyond the wanted is accurate enough to show
/// that nothing comes before them. Pairs that have converged,
/// to residuals of 3e-10, are improved no more.
///
/// \param wanted  three times block_size(wanted) must not exceed the dimension of the subspace
/// \param progress  called with the number of pairs that have converged; may throw to end it
/// \throws SolverFailure  no convergence, with the course of the residuals, or M is not definite
LowestPairs lowest_pairs(const PreconditionedPencil& pencil, Index wanted,
                         const std::function<void(Index)>& progress = {});

}  // namespace carat
