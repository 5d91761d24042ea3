#include "carat/solve/incomplete_cholesky.h"

#include <cmath>

#include "carat/base/error.h"

namespace carat {
namespace {

/// Of the unit diagonal: smaller pivots make a factor useless.
constexpr double kLeastPivot = 1e-3;
constexpr double kFirstShift = 1e-3;
constexpr double kLargestShift = 4;

}  // namespace

IncompleteCholesky::IncompleteCholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed)
    : reduction_(matrix, fixed),
      scale_(positive_diagonal(matrix, reduction_).cwiseSqrt().cwiseInverse()),
      factor_(reduction_.columns.size()),
      inverse_pivots_(reduction_.size()) {
  std::vector<double> values(factor_.size());
  for (Index i = 0; i < reduction_.size(); ++i)
    for (Index k = reduction_.offsets[i]; k < reduction_.offsets[i + 1]; ++k)
      values[k] =
          matrix.valuePtr()[reduction_.source[k]] * scale_[i] * scale_[reduction_.columns[k]];
  double shift = 0;
  while (!factorise(values, shift)) {
    shift = shift > 0 ? 4 * shift : kFirstShift;
    if (shift > kLargestShift)
      throw SolverFailure(
          "the matrix has no incomplete Cholesky factor: it is not positive "
          "definite, or holds values that are not finite");
  }
}

bool IncompleteCholesky::factorise(const std::vector<double>& values, double shift) {
  const Index n = reduction_.size();
  const Index* const offsets = reduction_.offsets.data();
  const Index* const columns = reduction_.columns.data();
  std::vector<double> row(static_cast<std::size_t>(n), 0.0);
  for (Index i = 0; i < n; ++i) {
    const Index begin = offsets[i], last = offsets[i + 1] - 1;
    for (Index k = begin; k < last; ++k) row[columns[k]] = values[k];
    double pivot = 1 + shift;
    for (Index k = begin; k < last; ++k) {
      const Index j = columns[k];
      double entry = row[j];
      for (Index m = offsets[j]; m < offsets[j + 1] - 1; ++m) entry -= factor_[m] * row[columns[m]];
      entry *= inverse_pivots_[j];
      row[j] = factor_[k] = entry;
      pivot -= entry * entry;
    }
    for (Index k = begin; k < last; ++k) row[columns[k]] = 0;
    if (!(pivot > kLeastPivot) || !std::isfinite(pivot)) return false;
    factor_[last] = std::sqrt(pivot);
    inverse_pivots_[i] = 1 / factor_[last];
  }
  return true;
}

void IncompleteCholesky::apply(const Vector& r, Vector& z) const {
  const Index n = reduction_.size();
  const Index* const offsets = reduction_.offsets.data();
  const Index* const columns = reduction_.columns.data();
  Vector y(n);
  for (Index i = 0; i < n; ++i) {
    double sum = r[reduction_.kept[i]] * scale_[i];
    for (Index k = offsets[i]; k < offsets[i + 1] - 1; ++k) sum -= factor_[k] * y[columns[k]];
    y[i] = sum * inverse_pivots_[i];
  }
  for (Index i = n - 1; i >= 0; --i) {
    const double at = y[i] *= inverse_pivots_[i];
    for (Index k = offsets[i]; k < offsets[i + 1] - 1; ++k) y[columns[k]] -= factor_[k] * at;
  }
  z.setZero(r.size());
  for (Index i = 0; i < n; ++i) z[reduction_.kept[i]] = y[i] * scale_[i];
}

}  // namespace carat
