#pragma once
// The free part of a symmetric matrix.

#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Rows that stay, and the lower triangle of the matrix over them: by rows ascending that is the
/// upper triangle by columns.
struct Reduction {
  std::vector<Index> kept;        // reduced -> full
  std::vector<Index> reduced_of;  // full -> reduced, -1: fixed
  std::vector<Index> offsets, columns;
  std::vector<Index> source;  // reduced entry -> position in the full matrix's values

  Reduction(const SparseMatrix& matrix, const std::vector<bool>& fixed) {
    const Index n = static_cast<Index>(matrix.rows());
    reduced_of.assign(static_cast<std::size_t>(n), -1);
    for (Index row = 0; row < n; ++row)
      if (fixed.empty() || !fixed[static_cast<std::size_t>(row)]) {
        reduced_of[row] = static_cast<Index>(kept.size());
        kept.push_back(row);
      }
    offsets.assign(1, 0);
    const Index* const outer = matrix.outerIndexPtr();
    const Index* const inner = matrix.innerIndexPtr();
    for (const Index row : kept) {
      for (Index k = outer[row]; k < outer[row + 1] && inner[k] <= row; ++k) {
        const Index column = reduced_of[inner[k]];
        if (column < 0) continue;
        columns.push_back(column);
        source.push_back(k);
      }
      offsets.push_back(static_cast<Index>(columns.size()));
    }
  }
  Index size() const { return static_cast<Index>(kept.size()); }
};

/// The diagonal of the free rows.
/// \throws SolverFailure  an entry is not positive and finite: names the row
Vector positive_diagonal(const SparseMatrix& matrix, const Reduction& reduction);

}  // namespace carat
