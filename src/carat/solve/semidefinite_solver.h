#pragma once
// Symmetric positive semidefinite systems whose kernel are constants.

#include <memory>
#include <vector>

#include "carat/solve/spd_solver.h"

namespace carat {

/// The solution operator of a symmetric positive semidefinite matrix whose kernel is spanned by
/// the constants of its connected components: a stiffness matrix without boundary conditions.
///
/// Works in the complement of the constants: one unknown a component is held at zero, the
/// solution is then shifted to mean zero. Rows without entries are excluded; their value is 0.
class SemidefiniteSolver {
 public:
  /// \param matrix  shared, not copied
  /// \throws SolverFailure  a pivot fails though every component is grounded
  explicit SemidefiniteSolver(std::shared_ptr<const SparseMatrix> matrix,
                              const SolverOptions& options = {});
  /// A factorisation of a copy.
  explicit SemidefiniteSolver(const SparseMatrix& matrix)
      : SemidefiniteSolver(std::make_shared<SparseMatrix>(matrix), {.kind = SolverKind::Cholesky}) {
  }

  /// \param rhs     (n, k). Its mean over each component is subtracted: see imbalance().
  /// \param report  if given: how it went
  /// \return (n, k), mean zero over each component
  Matrix solve(Matrix rhs, SolveReport* report = nullptr) const;

  /// |sum of rhs| / sum |rhs| over the worst component: 0 for a compatible right-hand side.
  double imbalance(const Vector& rhs) const;

  /// Component of every row by non-zero entries, numbered by first row; -1 for empty rows.
  const std::vector<Index>& components() const { return components_; }
  Index n_components() const { return n_components_; }
  const SolverInfo& info() const { return solver_->info(); }

 private:
  std::vector<Index> components_;
  std::vector<Index> sizes_;
  Index n_components_ = 0;
  std::unique_ptr<SpdSolver> solver_;
};

}  // namespace carat
