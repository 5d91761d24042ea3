#pragma once
// A symmetric sparse matrix of which little more than one triangle is stored, as an operator.

#include <vector>

#include "carat/base/symmetric_operator.h"

namespace carat {

/// The lower triangle with the diagonal, which takes half of the memory and of what a product
/// reads, for a product that scatters every entry as well as gathering it.
///
/// Rows form blocks, which a product runs over in parallel. A block is symmetric by itself, so its
/// upper triangle is left out; what couples two blocks is kept in the rows of both. So no block
/// writes to the rows of another, and nothing has to be added up behind them. The blocks follow
/// from the matrix alone: up to 64, fewer where more than a part of the triangle would couple them.
/// Of a numbering without locality they couple nearly everything, and nearly all is stored.
class SymmetricMatrix final : public SymmetricOperator {
 public:
  /// \param matrix   symmetric
  /// \param threads  of products; 0: all the machine has
  explicit SymmetricMatrix(SparseMatrix&& matrix, int threads = 0);

  Index rows() const override { return static_cast<Index>(stored_->rows()); }
  void multiply(const double* x, double* y, Index k) const override;
  Vector diagonal() const override { return stored_->diagonal(); }
  Vector row_norms() const override;
  std::vector<Index> components() const override;
  std::shared_ptr<const SymmetricOperator> plus(const SparseMatrix& other) const override;
  bool assembled() const override { return true; }
  bool halved() const override { return true; }
  std::int64_t nonzeros() const override;
  /// Made now.
  std::shared_ptr<const SparseMatrix> matrix() const override;
  std::shared_ptr<const SparseMatrix> lower_triangle() const override { return stored_; }
  std::size_t bytes() const override;

 private:
  SymmetricMatrix(SparseMatrix&& matrix, Index n_blocks, int threads);
  Index block_begin(Index block) const;
  template <Index kWidth, Index kStride>
  void multiply_block(Index begin, Index end, const double* x, double* y, Index stride_of_x) const;

  std::shared_ptr<const SparseMatrix> stored_;
  Index n_blocks_;
  int threads_;
};

}  // namespace carat
