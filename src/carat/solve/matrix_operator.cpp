#include "carat/solve/matrix_operator.h"

#include <cmath>

#include "carat/base/column_blocks.h"
#include "carat/base/parallel.h"
#include "carat/solve/cholesky.h"

namespace carat {

void MatrixOperator::multiply(const double* x, double* y, Index k) const {
  for_column_groups(k, [&](auto width, Index first) {
    if (k == 1)
      gather<1, 1>(x, y, k);
    else
      gather<decltype(width)::value, 0>(x + first, y + first, k);
  });
}

/// \tparam kWidth   vectors that are multiplied
/// \tparam kStride  values a row of x and y; 0: stride_of_x
template <Index kWidth, Index kStride>
void MatrixOperator::gather(const double* x, double* y, Index stride_of_x) const {
  const auto stride = static_cast<std::size_t>(kStride > 0 ? kStride : stride_of_x);
  parallel_blocks(rows(), threads_, [&](int, Index begin, Index end) {
    const Index* const offsets = matrix_->outerIndexPtr();
    const Index* const columns = matrix_->innerIndexPtr();
    const double* const values = matrix_->valuePtr();
    for (Index row = begin; row < end; ++row) {
      double sum[kWidth] = {};
      for (Index entry = offsets[row]; entry < offsets[row + 1]; ++entry) {
        const double value = values[entry];
        const double* const at = x + stride * static_cast<std::size_t>(columns[entry]);
        for (Index j = 0; j < kWidth; ++j) sum[j] += value * at[j];
      }
      double* const out = y + stride * static_cast<std::size_t>(row);
      for (Index j = 0; j < kWidth; ++j) out[j] = sum[j];
    }
  });
}

Vector MatrixOperator::row_norms() const {
  Vector norms(rows());
  parallel_blocks(rows(), threads_, [&](int, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      double sum = 0;
      for (SparseMatrix::InnerIterator entry(*matrix_, row); entry; ++entry)
        sum += std::abs(entry.value());
      norms[row] = sum;
    }
  });
  return norms;
}

std::vector<Index> MatrixOperator::components() const { return matrix_components(*matrix_); }

std::shared_ptr<const SymmetricOperator> MatrixOperator::plus(const SparseMatrix& other) const {
  return std::make_shared<MatrixOperator>(std::make_shared<SparseMatrix>(*matrix_ + other),
                                          threads_);
}

std::size_t MatrixOperator::bytes() const {
  return static_cast<std::size_t>(matrix_->nonZeros()) * (sizeof(double) + sizeof(Index)) +
         (static_cast<std::size_t>(matrix_->rows()) + 1) * sizeof(Index);
}

}  // namespace carat
