#pragma once
// Incomplete Cholesky factors.

#include <vector>

#include "carat/solve/preconditioner.h"
#include "carat/solve/reduction.h"

namespace carat {

/// The Cholesky factor without fill, IC(0), of a matrix scaled to unit diagonal; where a pivot
/// fails, of the matrix with a larger diagonal.
class IncompleteCholesky final : public Preconditioner {
 public:
  /// \param matrix,fixed  as for Cholesky
  /// \throws SolverFailure  a diagonal entry is not positive, or no shift gives a factor
  IncompleteCholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed);
  void apply(const Vector& r, Vector& z) const override;
  std::int64_t nonzeros() const override { return static_cast<std::int64_t>(factor_.size()); }

 private:
  bool factorise(const std::vector<double>& values, double shift);

  Reduction reduction_;
  Vector scale_;                ///< 1 / sqrt(a_ii)
  std::vector<double> factor_;  ///< lower triangle by rows, the diagonal last in a row
  Vector inverse_pivots_;
};

}  // namespace carat
