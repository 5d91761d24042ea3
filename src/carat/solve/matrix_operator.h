#pragma once
// A sparse matrix as an operator.

#include "carat/base/symmetric_operator.h"

namespace carat {

/// Products run over blocks of rows in parallel.
class MatrixOperator final : public SymmetricOperator {
 public:
  /// \param matrix   symmetric; shared, not copied
  /// \param threads  of products; 0: all the machine has
  explicit MatrixOperator(std::shared_ptr<const SparseMatrix> matrix, int threads = 0)
      : matrix_(std::move(matrix)), threads_(threads) {}

  Index rows() const override { return static_cast<Index>(matrix_->rows()); }
  void multiply(const double* x, double* y, Index k) const override;
  Vector diagonal() const override { return matrix_->diagonal(); }
  Vector row_norms() const override;
  std::vector<Index> components() const override;
  std::shared_ptr<const SymmetricOperator> plus(const SparseMatrix& other) const override;
  bool assembled() const override { return true; }
  std::shared_ptr<const SparseMatrix> matrix() const override { return matrix_; }
  std::size_t bytes() const override;

 private:
  template <Index kWidth, Index kStride>
  void gather(const double* x, double* y, Index stride) const;

  std::shared_ptr<const SparseMatrix> matrix_;
  int threads_;
};

}  // namespace carat
