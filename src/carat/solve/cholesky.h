#pragma once
// Direct solution of symmetric positive definite systems.

#include <memory>
#include <string>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// What a factorisation cost and gave.
struct FactorInfo {
  std::string method;         ///< e.g. "CHOLMOD supernodal"
  std::string ordering;       ///< fill-reducing ordering that was chosen
  std::int64_t nonzeros = 0;  ///< in the factor
  double analyse_seconds = 0, factor_seconds = 0;
};

/// Cholesky factorisation of one matrix, kept for many right-hand sides.
///
/// Rows can be held out of the system ("fixed"): solve() then treats their unknowns as zero, which
/// is how Dirichlet data, vertices without faces and the constants of a semidefinite system are
/// dealt with.
class Cholesky {
 public:
  /// \param matrix  symmetric; its upper triangle is not read
  /// \param fixed   empty, or one flag a row: rows and columns to leave out
  /// \param dimension  of the mesh, which tells the better ordering: 2 or 3; 0: several are tried
  /// \throws SolverFailure  not positive definite: names the row of the failing pivot
  explicit Cholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed = {},
                    int dimension = 0);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  /// New values on the same pattern: no new symbolic analysis.
  /// \throws SolverFailure  not positive definite
  /// \throws InvalidOption  another pattern
  void refactor(const SparseMatrix& matrix);

  /// Several threads may call this at once.
  /// \param rhs  (n, k): k right-hand sides; fixed rows are ignored
  /// \return (n, k); zero in fixed rows
  /// \throws SolverFailure  the solution is not finite
  Matrix solve(const Matrix& rhs) const;

  const FactorInfo& info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Connected components of a symmetric matrix by its non-zero off-diagonal values, of which those
/// in the lower triangle are read, numbered by first row; -1 for rows without a non-zero entry.
/// Cost: O(nnz).
std::vector<Index> matrix_components(const SparseMatrix& matrix);

}  // namespace carat
