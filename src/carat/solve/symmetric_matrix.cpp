#include "carat/solve/symmetric_matrix.h"

#include <algorithm>
#include <cmath>

#include "carat/base/column_blocks.h"
#include "carat/base/parallel.h"
#include "carat/solve/cholesky.h"

namespace carat {
namespace {

constexpr Index kMostBlocks = 64;
constexpr Index kEnoughBlocks = 8;
/// Fewer rows are not worth a thread.
constexpr Index kRowsOfABlock = 4096;
/// Part of the triangle that may couple blocks, if that is not what it takes to have enough.
constexpr double kCoupling = 1.0 / 16;

/// Where the blocks of n rows begin; those of half as many blocks are among them.
Index begin_of(Index block, Index n_blocks, Index n) {
  return static_cast<Index>(std::int64_t{n} * block / n_blocks);
}

/// Calls visit(begin, end, row) for the rows of all blocks.
template <class Visit>
void for_rows(Index n_blocks, Index n, const Visit& visit) {
  for (Index block = 0; block < n_blocks; ++block) {
    const Index begin = begin_of(block, n_blocks, n), end = begin_of(block + 1, n_blocks, n);
    for (Index row = begin; row < end; ++row) visit(begin, end, row);
  }
}

/// Entries below the diagonal that couple two blocks.
std::int64_t couplings(const SparseMatrix& matrix, Index n_blocks) {
  const Index* const offsets = matrix.outerIndexPtr();
  const Index* const columns = matrix.innerIndexPtr();
  std::int64_t found = 0;
  for_rows(n_blocks, static_cast<Index>(matrix.rows()), [&](Index begin, Index, Index row) {
    for (Index k = offsets[row]; k < offsets[row + 1] && columns[k] < begin; ++k) ++found;
  });
  return found;
}

Index choose_blocks(const SparseMatrix& matrix) {
  const Index most = static_cast<Index>(matrix.rows()) / kRowsOfABlock;
  Index n_blocks = 1;
  while (2 * n_blocks <= std::min(most, kMostBlocks)) n_blocks *= 2;
  const double allowed = kCoupling / 2 * static_cast<double>(matrix.nonZeros());
  while (n_blocks > kEnoughBlocks && static_cast<double>(couplings(matrix, n_blocks)) > allowed)
    n_blocks /= 2;
  return n_blocks;
}

/// Takes the upper triangles of blocks out, in place.
SparseMatrix without_upper_triangles(SparseMatrix&& matrix, Index n_blocks) {
  SparseMatrix stored = std::move(matrix);
  Index* const offsets = stored.outerIndexPtr();
  Index* const columns = stored.innerIndexPtr();
  double* const values = stored.valuePtr();
  Index kept = 0, from = 0;
  for_rows(n_blocks, static_cast<Index>(stored.rows()), [&](Index, Index end, Index row) {
    const Index to = offsets[row + 1];
    for (; from < to; ++from)
      if (columns[from] <= row || columns[from] >= end) {
        columns[kept] = columns[from];
        values[kept++] = values[from];
      }
    offsets[row + 1] = kept;
  });
  stored.data().resize(kept);
  stored.data().squeeze();
  return stored;
}

SparseMatrix compressed(SparseMatrix&& matrix) {
  SparseMatrix result = std::move(matrix);
  result.makeCompressed();
  return result;
}

}  // namespace

SymmetricMatrix::SymmetricMatrix(SparseMatrix&& matrix, int threads)
    : SymmetricMatrix(compressed(std::move(matrix)), 0, threads) {}

/// \param matrix    compressed
/// \param n_blocks  0: chosen
SymmetricMatrix::SymmetricMatrix(SparseMatrix&& matrix, Index n_blocks, int threads)
    : n_blocks_(n_blocks > 0 ? n_blocks : choose_blocks(matrix)), threads_(threads) {
  stored_ = std::make_shared<SparseMatrix>(without_upper_triangles(std::move(matrix), n_blocks_));
}

Index SymmetricMatrix::block_begin(Index block) const { return begin_of(block, n_blocks_, rows()); }

void SymmetricMatrix::multiply(const double* x, double* y, Index k) const {
  parallel_tasks(n_blocks_, threads_, [&](Index block) {
    const Index begin = block_begin(block), end = block_begin(block + 1);
    for_column_groups(k, [&](auto width, Index first) {
      constexpr Index kWidth = decltype(width)::value;
      if (k == kWidth)
        multiply_block<kWidth, kWidth>(begin, end, x, y, k);
      else
        multiply_block<kWidth, 0>(begin, end, x + first, y + first, k);
    });
  });
}

/// \tparam kWidth   vectors that are multiplied
/// \tparam kStride  values a row of x and y; 0: stride_of_x
template <Index kWidth, Index kStride>
void SymmetricMatrix::multiply_block(Index begin, Index end, const double* x, double* __restrict y,
                                     Index stride_of_x) const {
  const auto stride = static_cast<std::size_t>(kStride > 0 ? kStride : stride_of_x);
  const Index* const offsets = stored_->outerIndexPtr();
  const Index* const columns = stored_->innerIndexPtr();
  const double* const values = stored_->valuePtr();
  for (Index row = begin; row < end; ++row) {
    const double* const of_row = x + stride * static_cast<std::size_t>(row);
    double own[kWidth], sum[kWidth] = {};
    for (Index j = 0; j < kWidth; ++j) own[j] = of_row[j];
    const auto gather = [&](Index entry) {
      const double* const at = x + stride * static_cast<std::size_t>(columns[entry]);
      for (Index j = 0; j < kWidth; ++j) sum[j] += values[entry] * at[j];
    };
    Index entry = offsets[row];
    const Index last = offsets[row + 1];
    for (; entry < last && columns[entry] < begin; ++entry) gather(entry);
    // Rows before this one have their own sums by now.
    for (; entry < last && columns[entry] < row; ++entry) {
      gather(entry);
      double* const to = y + stride * static_cast<std::size_t>(columns[entry]);
      for (Index j = 0; j < kWidth; ++j) to[j] += values[entry] * own[j];
    }
    for (; entry < last; ++entry) gather(entry);
    double* const out = y + stride * static_cast<std::size_t>(row);
    for (Index j = 0; j < kWidth; ++j) out[j] = sum[j];
  }
}

Vector SymmetricMatrix::row_norms() const {
  Vector norms = Vector::Zero(rows());
  for_rows(n_blocks_, rows(), [&](Index begin, Index, Index row) {
    for (SparseMatrix::InnerIterator entry(*stored_, row); entry; ++entry) {
      norms[row] += std::abs(entry.value());
      if (entry.col() >= begin && entry.col() < row) norms[entry.col()] += std::abs(entry.value());
    }
  });
  return norms;
}

std::vector<Index> SymmetricMatrix::components() const { return matrix_components(*stored_); }

std::shared_ptr<const SymmetricOperator> SymmetricMatrix::plus(const SparseMatrix& other) const {
  // What the sum has in the upper triangles of blocks is of the other alone, and left out again.
  return std::shared_ptr<const SymmetricOperator>(
      new SymmetricMatrix(SparseMatrix(*stored_ + other), n_blocks_, threads_));
}

std::int64_t SymmetricMatrix::nonzeros() const {
  std::int64_t left_out = 0;
  for_rows(n_blocks_, rows(), [&](Index begin, Index, Index row) {
    for (SparseMatrix::InnerIterator entry(*stored_, row); entry && entry.col() < row; ++entry)
      left_out += entry.col() >= begin;
  });
  return stored_->nonZeros() + left_out;
}

std::shared_ptr<const SparseMatrix> SymmetricMatrix::matrix() const {
  const Index n = rows();
  const Index* const offsets = stored_->outerIndexPtr();
  const Index* const columns = stored_->innerIndexPtr();
  const double* const values = stored_->valuePtr();
  auto full = std::make_shared<SparseMatrix>(n, n);
  full->resizeNonZeros(static_cast<Index>(nonzeros()));
  Index* const ends = full->outerIndexPtr();
  const auto for_left_out = [&](const auto& visit) {
    for_rows(n_blocks_, n, [&](Index begin, Index, Index row) {
      for (Index k = offsets[row]; k < offsets[row + 1] && columns[k] < row; ++k)
        if (columns[k] >= begin) visit(row, k);
    });
  };
  std::fill(ends, ends + n + 1, 0);
  for (Index row = 0; row < n; ++row) ends[row + 1] = offsets[row + 1] - offsets[row];
  for_left_out([&](Index, Index k) { ++ends[columns[k] + 1]; });
  for (Index row = 0; row < n; ++row) ends[row + 1] += ends[row];
  // Every row in ascending order: up to the diagonal, the rest of its block, what is beyond it.
  std::vector<Index> next(ends, ends + n);
  const auto put = [&](Index row, Index column, double value) {
    full->innerIndexPtr()[next[row]] = column;
    full->valuePtr()[next[row]++] = value;
  };
  for (Index row = 0; row < n; ++row)
    for (Index k = offsets[row]; k < offsets[row + 1] && columns[k] <= row; ++k)
      put(row, columns[k], values[k]);
  for_left_out([&](Index row, Index k) { put(columns[k], row, values[k]); });
  for (Index row = 0; row < n; ++row)
    for (Index k = offsets[row]; k < offsets[row + 1]; ++k)
      if (columns[k] > row) put(row, columns[k], values[k]);
  return full;
}

std::size_t SymmetricMatrix::bytes() const {
  return static_cast<std::size_t>(stored_->nonZeros()) * (sizeof(double) + sizeof(Index)) +
         (static_cast<std::size_t>(rows()) + 1) * sizeof(Index);
}

}  // namespace carat
