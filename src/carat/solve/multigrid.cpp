#include "carat/solve/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/solve/multigrid/coarsening.h"
#include "carat/solve/reduction.h"

namespace carat {
namespace {

using multigrid::Real;
using multigrid::Rows;

/// Levels of so few rows are solved by a dense factorisation.
constexpr Index kCoarsest = 300;
/// Where coarsening stalls, up to so many rows are still solved exactly.
constexpr Index kLargestDense = 2000;

/// One level of a cycle.
struct Level : multigrid::LevelMatrices {
  Array<Index> middle;  // row -> its first entry to the right of the diagonal
  Array<Real> inverse_diagonal;
  mutable Array<Real> x, b, residual;

  explicit Level(multigrid::LevelMatrices&& matrices)
      : multigrid::LevelMatrices(std::move(matrices)) {
    const Index n = size();
    const auto count = static_cast<std::size_t>(n);
    inverse_diagonal.resize(count);
    middle.resize(count);
    x.resize(count);
    b.resize(count);
    residual.resize(count);
    for (Index i = 0; i < n; ++i) {
      inverse_diagonal[i] = 1 / diagonal[i];
      Index k = matrix.offsets[i];
      while (k < matrix.offsets[i + 1] && matrix.columns[k] < i) ++k;
      middle[i] = k;
    }
  }

  // Gauss-Seidel from x = 0, which needs the lower triangle; what is left of b then is the upper
  // one's part.
  void smooth_forwards() const {
    const Index n = size();
    const Index* const columns = matrix.columns.data();
    const Real* const values = matrix.values.data();
    for (Index i = 0; i < n; ++i) {
      Real sum = b[i];
      for (Index k = matrix.offsets[i]; k < middle[i]; ++k) sum -= values[k] * x[columns[k]];
      x[i] = sum * inverse_diagonal[i];
    }
    for (Index i = 0; i < n; ++i) {
      Real sum = 0;
      for (Index k = middle[i]; k < matrix.offsets[i + 1]; ++k) sum -= values[k] * x[columns[k]];
      residual[i] = sum;
    }
  }
  void smooth_backwards() const {
    const Index* const columns = matrix.columns.data();
    const Real* const values = matrix.values.data();
    for (Index i = size() - 1; i >= 0; --i) {
      Real sum = b[i];
      for (Index k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
        sum -= values[k] * x[columns[k]];
      x[i] = sum * inverse_diagonal[i];
    }
  }
};

}  // namespace

struct Multigrid::Impl {
  Reduction reduction;
  double scale = 1;  ///< the largest diagonal entry, so that single precision holds the others
  std::vector<Level> levels;
  Eigen::LLT<Matrix> coarsest;  ///< of the last level, if it is small
  bool solves_coarsest = false;
  mutable Vector coarse_values;

  Impl(const SparseMatrix& matrix, const std::vector<bool>& fixed, int threads)
      : reduction(matrix, fixed) {
    if (reduction.size() == 0) return;
    levels.reserve(40);
    levels.emplace_back(finest(matrix));
    while (levels.back().size() > kCoarsest && add_level(threads)) {
    }
    factorise_coarsest();
  }

  multigrid::LevelMatrices finest(const SparseMatrix& matrix) {
    const Vector diagonal = positive_diagonal(matrix, reduction);
    scale = diagonal.maxCoeff();
    multigrid::LevelMatrices level;
    const Index n = reduction.size();
    level.diagonal.resize(static_cast<std::size_t>(n));
    Rows& rows = level.matrix;
    rows.offsets.resize(static_cast<std::size_t>(n) + 1);
    rows.columns.resize(2 * reduction.columns.size());
    rows.values.resize(2 * reduction.columns.size());
    rows.offsets[0] = 0;
    Index end = 0;
    for (Index i = 0; i < n; ++i) {
      // Below the smallest normal number of single precision nothing of a row would be left.
      level.diagonal[i] = std::max(static_cast<Real>(diagonal[i] / scale), 1e-37F);
      for (SparseMatrix::InnerIterator entry(matrix, reduction.kept[i]); entry; ++entry) {
        const Index j = reduction.reduced_of[entry.col()];
        if (j < 0 || j == i || entry.value() == 0) continue;
        rows.columns[end] = j;
        rows.values[end++] = static_cast<Real>(entry.value() / scale);
      }
      rows.offsets[i + 1] = end;
    }
    rows.columns.resize(static_cast<std::size_t>(end));
    rows.values.resize(static_cast<std::size_t>(end));
    return level;
  }

  bool add_level(int threads) {
    std::optional<multigrid::LevelMatrices> coarse = multigrid::coarsen(levels.back(), threads);
    if (!coarse) return false;
    for (const Real entry : coarse->diagonal)
      if (!(entry > 0) || !std::isfinite(entry))
        throw SolverFailure(
            "multigrid: a coarse matrix is not positive definite, its diagonal is " +
            std::to_string(entry));
    levels.emplace_back(*std::move(coarse));
    return true;
  }

  void factorise_coarsest() {
    const Level& last = levels.back();
    const Index n = last.size();
    if (n > kLargestDense) return;
    Matrix dense = Matrix::Zero(n, n);
    for (Index i = 0; i < n; ++i) {
      dense(i, i) = last.diagonal[i];
      for (Index k = last.matrix.offsets[i]; k < last.matrix.offsets[i + 1]; ++k)
        dense(i, last.matrix.columns[k]) = last.matrix.values[k];
    }
    coarsest.compute(dense);
    if (coarsest.info() != Eigen::Success)
      throw SolverFailure("multigrid: the coarsest matrix is not positive definite");
    solves_coarsest = true;
    coarse_values.resize(n);
  }

  void cycle(std::size_t number) const {
    const Level& level = levels[number];
    if (number + 1 == levels.size()) {
      solve_last(level);
      return;
    }
    level.smooth_forwards();
    const Level& coarse = levels[number + 1];
    const Rows& r = level.restriction;
    for (Index i = 0; i < coarse.size(); ++i) {
      Real sum = 0;
      for (Index k = r.offsets[i]; k < r.offsets[i + 1]; ++k)
        sum += r.values[k] * level.residual[r.columns[k]];
      coarse.b[i] = sum;
    }
    cycle(number + 1);
    const Rows& p = level.prolongation;
    for (Index i = 0; i < level.size(); ++i) {
      Real sum = level.x[i];
      for (Index k = p.offsets[i]; k < p.offsets[i + 1]; ++k)
        sum += p.values[k] * coarse.x[p.columns[k]];
      level.x[i] = sum;
    }
    level.smooth_backwards();
  }

  void solve_last(const Level& level) const {
    if (!solves_coarsest) {
      level.smooth_forwards();
      level.smooth_backwards();
      return;
    }
    for (Index i = 0; i < level.size(); ++i) coarse_values[i] = level.b[i];
    coarsest.solveInPlace(coarse_values);
    for (Index i = 0; i < level.size(); ++i) level.x[i] = static_cast<Real>(coarse_values[i]);
  }
};

Multigrid::Multigrid(const SparseMatrix& matrix, const std::vector<bool>& fixed, int threads)
    : impl_(std::make_unique<Impl>(matrix, fixed, threads)) {}

Multigrid::~Multigrid() = default;

void Multigrid::apply(const Vector& r, Vector& z) const {
  z.setZero(r.size());
  const std::vector<Index>& kept = impl_->reduction.kept;
  double largest = 0;
  for (const Index row : kept) largest = std::max(largest, std::abs(r[row]));
  if (!(largest > 0)) return;
  const Level& level = impl_->levels.front();
  const double to_one = 1 / largest;
  for (Index i = 0; i < level.size(); ++i) level.b[i] = static_cast<Real>(r[kept[i]] * to_one);
  impl_->cycle(0);
  const double back = largest / impl_->scale;
  for (Index i = 0; i < level.size(); ++i) z[kept[i]] = back * static_cast<double>(level.x[i]);
}

std::int64_t Multigrid::nonzeros() const {
  std::size_t sum = 0;
  for (const Level& level : impl_->levels)
    sum +=
        level.matrix.columns.size() + level.diagonal.size() + 2 * level.prolongation.columns.size();
  return static_cast<std::int64_t>(sum);
}

}  // namespace carat
