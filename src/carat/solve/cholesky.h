#pragma once
// Direct solution of symmetric positive (semi)definite systems.

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
  /// \param matrix  symmetric; entries above and below the diagonal must agree
  /// \param fixed   empty, or one flag a row: rows and columns to leave out
  /// \throws SolverFailure  not positive definite: names the row of the failing pivot
  explicit Cholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed = {});
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  /// New values on the same pattern: no new symbolic analysis.
  /// \throws SolverFailure  not positive definite
  /// \throws InvalidOption  another pattern
  void refactor(const SparseMatrix& matrix);

  /// \param rhs  (n, k): k right-hand sides; fixed rows are ignored
  /// \return (n, k); zero in fixed rows
  /// \throws SolverFailure  the solution is not finite
  Matrix solve(const Matrix& rhs) const;

  const FactorInfo& info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The solution operator of a symmetric positive semidefinite matrix whose kernel is spanned by
/// the constants of its connected components: a stiffness matrix without boundary conditions.
///
/// Works in the complement of the constants: one unknown a component is held at zero, the
/// solution is then shifted to mean zero. Rows without entries are excluded; their value is 0.
class SemidefiniteSolver {
 public:
  /// \throws SolverFailure  a pivot fails though every component is grounded
  explicit SemidefiniteSolver(const SparseMatrix& matrix);

  /// \param rhs  (n, k). Its mean over each component is subtracted: see imbalance().
  /// \return (n, k), mean zero over each component
  Matrix solve(Matrix rhs) const;

  /// |sum of rhs| / sum |rhs| over the worst component: 0 for a compatible right-hand side.
  double imbalance(const Vector& rhs) const;

  /// Component of every row by non-zero entries, numbered by first row; -1 for empty rows.
  const std::vector<Index>& components() const { return components_; }
  Index n_components() const { return n_components_; }
  const FactorInfo& info() const { return solver_->info(); }

 private:
  std::vector<Index> components_;
  std::vector<Index> sizes_;
  Index n_components_ = 0;
  std::unique_ptr<Cholesky> solver_;
};

/// Connected components of a matrix by its non-zero off-diagonal values, numbered by first row;
/// -1 for rows without a non-zero entry.
/// Cost: O(nnz).
std::vector<Index> matrix_components(const SparseMatrix& matrix);

}  // namespace carat
