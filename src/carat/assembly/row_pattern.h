#pragma once
// Sparsity patterns row by row: rows are collected in any order and written transposed, which is
// the same symmetric pattern with every row ascending. Nothing is ever sorted.

#include <cstddef>
#include <utility>
#include <vector>

#include "carat/base/parallel.h"
#include "carat/base/types.h"

namespace carat {

/// Scratch of one thread while it collects rows: every column once.
struct RowCollector {
  explicit RowCollector(Index n_columns) : last_row(static_cast<std::size_t>(n_columns), -1) {}

  void add(Index column, Index row) {
    if (last_row[column] == row) return;
    last_row[column] = row;
    columns.push_back(column);
  }

  Array<Index> last_row;  // of every column: the row that it was added to last
  Array<Index> columns;
};

/// Rows [begin, end) of a pattern, columns in the order they were met.
struct CollectedRows {
  Index begin = 0, end = 0;
  Array<Index> columns;
};

/// Collects the n rows of a symmetric pattern. `collect(row, collector)` returns how many of the
/// row's first columns make up the row of a second pattern inside it.
template <class Collect>
std::vector<CollectedRows> collect_rows(Index n, int threads, Array<Index>& sizes,
                                        Array<Index>& inner_sizes, const Collect& collect) {
  sizes.resize(static_cast<std::size_t>(n));
  inner_sizes.resize(static_cast<std::size_t>(n));
  std::vector<CollectedRows> parts(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n, threads, [&](int block, Index begin, Index end) {
    RowCollector collector(n);
    // Guess the size from the first rows, so that the array rarely grows.
    constexpr Index kSample = 1000;
    for (Index row = begin; row < end; ++row) {
      if (row == begin + kSample)
        collector.columns.reserve(collector.columns.size() / kSample *
                                      static_cast<std::size_t>(end - begin) * 9 / 8 +
                                  64);
      const std::size_t before = collector.columns.size();
      inner_sizes[row] = collect(row, collector);
      sizes[row] = static_cast<Index>(collector.columns.size() - before);
    }
    parts[static_cast<std::size_t>(block)] = {begin, end, std::move(collector.columns)};
  });
  return parts;
}

/// Writes the first counts[row] of the collected columns of every row, transposed.
void write_transposed(const std::vector<CollectedRows>& parts, const Array<Index>& sizes,
                      const Array<Index>& counts, int threads, SparseMatrix& pattern);

}  // namespace carat
