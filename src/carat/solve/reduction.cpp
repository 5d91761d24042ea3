#include "carat/solve/reduction.h"

#include <cmath>
#include <string>

#include "carat/base/error.h"

namespace carat {

Vector positive_diagonal(const SparseMatrix& matrix, const Reduction& reduction) {
  Vector result(reduction.size());
  for (Index i = 0; i < reduction.size(); ++i) {
    const Index last = reduction.offsets[i + 1] - 1;
    const bool stored = last >= reduction.offsets[i] && reduction.columns[last] == i;
    const double diagonal = stored ? matrix.valuePtr()[reduction.source[last]] : 0;
    if (!(diagonal > 0) || !std::isfinite(diagonal)) {
      const Index row = reduction.kept[i];
      throw SolverFailure("the matrix is not positive definite: the diagonal of row (vertex) " +
                              std::to_string(row) + " is " + std::to_string(diagonal),
                          {row});
    }
    result[i] = diagonal;
  }
  return result;
}

}  // namespace carat
