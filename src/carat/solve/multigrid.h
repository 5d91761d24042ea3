#pragma once
// Algebraic multigrid.

#include <memory>
#include <vector>

#include "carat/solve/preconditioner.h"

namespace carat {

/// One V-cycle of smoothed aggregation [Vanek, Mandel, Brezina 1996], as a preconditioner: cost and
/// memory are linear in the number of unknowns, and the number of iterations hardly grows with it.
///
/// Rows are strongly coupled where -a_ij is three tenths of the largest in one of the two rows;
/// they are joined to aggregates, whose indicators are smoothed by one Jacobi step on the strong
/// part of the matrix, and the coarse matrix is P^T A P. A cycle smooths by Gauss-Seidel forwards
/// before and backwards after the coarse correction, so it is symmetric. All is kept in single
/// precision: that halves the memory that a cycle moves, and errs far less than a cycle does.
class Multigrid final : public Preconditioner {
 public:
  /// \param matrix   symmetric, with both triangles
  /// \param fixed    as for Cholesky
  /// \param threads       of the set-up; 0: all the machine has. The result does not depend on it.
  /// \throws SolverFailure  a diagonal entry is not positive, or a coarse matrix not definite
  Multigrid(const SparseMatrix& matrix, const std::vector<bool>& fixed, int threads = 0);
  ~Multigrid() override;
  /// Not for several threads at a time: the levels hold their vectors.
  void apply(const Vector& r, Vector& z) const override;
  /// Up to eight at a time, which reads the levels once for them.
  void apply_block(const Vector& r, Vector& z, Index k) const override;
  std::int64_t nonzeros() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace carat
