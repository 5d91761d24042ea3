#include "carat/solve/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "carat/base/column_blocks.h"
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

/// The values of one row.
template <Index kWidth>
using Sums = std::array<Real, kWidth>;

template <Index kWidth>
Sums<kWidth> load(const Array<Real>& values, Index row) {
  Sums<kWidth> sums;
  for (Index c = 0; c < kWidth; ++c) sums[c] = values[row * kWidth + c];
  return sums;
}
template <std::size_t kWidth>
void store(const std::array<Real, kWidth>& sums, Array<Real>& values, Index row) {
  for (std::size_t c = 0; c < kWidth; ++c) values[row * kWidth + c] = sums[c];
}

/// sums += sign * (entries [begin, end) of a row) x.
template <int kSign, std::size_t kWidth>
void add_row(std::array<Real, kWidth>& sums, const Rows& rows, Index begin, Index end,
             const Array<Real>& x) {
  for (Index k = begin; k < end; ++k) {
    const Real value = kSign * rows.values[k];
    const Real* const from = x.data() + rows.columns[k] * static_cast<Index>(kWidth);
    for (std::size_t c = 0; c < kWidth; ++c) sums[c] += value * from[c];
  }
}
template <std::size_t kWidth>
void subtract(std::array<Real, kWidth>& sums, const Rows& rows, Index begin, Index end,
              const Array<Real>& x) {
  add_row<-1>(sums, rows, begin, end, x);
}

/// One level of a cycle.
struct Level : multigrid::LevelMatrices {
  Array<Index> middle;  // row -> its first entry to the right of the diagonal
  Array<Real> inverse_diagonal;
  // Of as many vectors as advance together, the values of a row side by side.
  mutable Array<Real> x, b, residual;

  explicit Level(multigrid::LevelMatrices&& matrices)
      : multigrid::LevelMatrices(std::move(matrices)) {
    const Index n = size();
    const auto count = static_cast<std::size_t>(n);
    inverse_diagonal.resize(count);
    middle.resize(count);
    for (Index i = 0; i < n; ++i) {
      inverse_diagonal[i] = 1 / diagonal[i];
      Index k = matrix.offsets[i];
      while (k < matrix.offsets[i + 1] && matrix.columns[k] < i) ++k;
      middle[i] = k;
    }
  }

  void reserve(Index width) const {
    const std::size_t count = diagonal.size() * static_cast<std::size_t>(width);
    for (Array<Real>* const values : {&x, &b, &residual})
      if (values->size() < count) values->resize(count);
  }

  // Gauss-Seidel from x = 0, which needs the lower triangle; what is left of b then is the upper
  // one's part.
  template <Index kWidth>
  void smooth_forwards() const {
    const Index n = size();
    for (Index i = 0; i < n; ++i) {
      Sums<kWidth> sum = load<kWidth>(b, i);
      subtract(sum, matrix, matrix.offsets[i], middle[i], x);
      for (Index c = 0; c < kWidth; ++c) x[i * kWidth + c] = sum[c] * inverse_diagonal[i];
    }
    for (Index i = 0; i < n; ++i) {
      Sums<kWidth> sum{};
      subtract(sum, matrix, middle[i], matrix.offsets[i + 1], x);
      store(sum, residual, i);
    }
  }
  template <Index kWidth>
  void smooth_backwards() const {
    for (Index i = size() - 1; i >= 0; --i) {
      Sums<kWidth> sum = load<kWidth>(b, i);
      subtract(sum, matrix, matrix.offsets[i], matrix.offsets[i + 1], x);
      for (Index c = 0; c < kWidth; ++c) x[i * kWidth + c] = sum[c] * inverse_diagonal[i];
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

  template <Index kWidth>
  void cycle(std::size_t number) const {
    const Level& level = levels[number];
    if (number + 1 == levels.size()) {
      solve_last<kWidth>(level);
      return;
    }
    level.smooth_forwards<kWidth>();
    const Level& coarse = levels[number + 1];
    const Rows& r = level.restriction;
    for (Index i = 0; i < coarse.size(); ++i) {
      Sums<kWidth> sum{};
      add_row<1>(sum, r, r.offsets[i], r.offsets[i + 1], level.residual);
      store(sum, coarse.b, i);
    }
    cycle<kWidth>(number + 1);
    const Rows& p = level.prolongation;
    for (Index i = 0; i < level.size(); ++i) {
      Sums<kWidth> sum = load<kWidth>(level.x, i);
      add_row<1>(sum, p, p.offsets[i], p.offsets[i + 1], coarse.x);
      store(sum, level.x, i);
    }
    level.smooth_backwards<kWidth>();
  }

  template <Index kWidth>
  void solve_last(const Level& level) const {
    if (!solves_coarsest) {
      level.smooth_forwards<kWidth>();
      level.smooth_backwards<kWidth>();
      return;
    }
    for (Index c = 0; c < kWidth; ++c) {
      for (Index i = 0; i < level.size(); ++i) coarse_values[i] = level.b[i * kWidth + c];
      coarsest.solveInPlace(coarse_values);
      for (Index i = 0; i < level.size(); ++i)
        level.x[i * kWidth + c] = static_cast<Real>(coarse_values[i]);
    }
  }

  /// Columns [first, first + kWidth) of k vectors.
  template <Index kWidth>
  void apply(const Vector& r, Vector& z, Index k, Index first) const {
    const std::vector<Index>& kept = reduction.kept;
    std::array<double, kWidth> largest{};
    for (const Index row : kept)
      for (Index c = 0; c < kWidth; ++c)
        largest[c] = std::max(largest[c], std::abs(r[Eigen::Index{row} * k + first + c]));
    std::array<double, kWidth> to_one, back;
    for (Index c = 0; c < kWidth; ++c) {
      to_one[c] = largest[c] > 0 ? 1 / largest[c] : 0;
      back[c] = largest[c] / scale;
    }
    for (const Level& level : levels) level.reserve(kWidth);
    const Level& level = levels.front();
    for (Index i = 0; i < level.size(); ++i)
      for (Index c = 0; c < kWidth; ++c)
        level.b[i * kWidth + c] =
            static_cast<Real>(r[Eigen::Index{kept[i]} * k + first + c] * to_one[c]);
    cycle<kWidth>(0);
    for (Index i = 0; i < level.size(); ++i)
      for (Index c = 0; c < kWidth; ++c)
        z[Eigen::Index{kept[i]} * k + first + c] =
            back[c] * static_cast<double>(level.x[i * kWidth + c]);
  }
};

Multigrid::Multigrid(const SparseMatrix& matrix, const std::vector<bool>& fixed, int threads)
    : impl_(std::make_unique<Impl>(matrix, fixed, threads)) {}

Multigrid::~Multigrid() = default;

void Multigrid::apply(const Vector& r, Vector& z) const { apply_block(r, z, 1); }

void Multigrid::apply_block(const Vector& r, Vector& z, Index k) const {
  z.setZero(r.size());
  if (impl_->levels.empty()) return;
  for_column_groups(k, [&](auto width, Index first) { impl_->apply<width()>(r, z, k, first); });
}

std::int64_t Multigrid::nonzeros() const {
  std::size_t sum = 0;
  for (const Level& level : impl_->levels)
    sum +=
        level.matrix.columns.size() + level.diagonal.size() + 2 * level.prolongation.columns.size();
  return static_cast<std::int64_t>(sum);
}

}  // namespace carat
