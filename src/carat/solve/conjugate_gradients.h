#pragma once
// Iterative solution of symmetric positive definite systems.

#include <memory>
#include <vector>

#include "carat/solve/spd_solver.h"

namespace carat {

/// Conjugate gradients with an incomplete Cholesky factor on the matrix's own pattern (IC(0); where
/// a pivot fails, of the matrix with a larger diagonal). For large systems of volumes: there a
/// factorisation costs a hundred times as much, in time and memory.
class ConjugateGradients {
 public:
  /// \param matrix,fixed  as for SpdSolver
  /// \throws SolverFailure  a diagonal entry is not positive
  explicit ConjugateGradients(const SparseMatrix& matrix, const std::vector<bool>& fixed = {});
  ~ConjugateGradients();

  /// To a residual of 1e-12 of the right-hand side, both in the norm of the scaled rows.
  /// \param rhs  (n, k); fixed rows are ignored
  /// \return (n, k); zero in fixed rows
  /// \throws SolverFailure  no convergence: says how far it came; the matrix is not positive
  ///                        definite; values that are not finite
  Matrix solve(const Matrix& rhs) const;

  /// Entries of the incomplete factor and its seconds.
  const FactorInfo& info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace carat
