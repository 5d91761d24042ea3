#include "carat/solve/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "carat/base/error.h"
#include "carat/solve/reduction.h"

namespace carat {
namespace {

using Real = float;

/// Couplings of less than this part of the largest one of both rows are weak.
constexpr Real kStrong = 0.1F;
/// Levels of so few rows are solved by a dense factorisation.
constexpr Index kCoarsest = 300;
/// A level that is hardly smaller than the one before is not worth having.
constexpr double kLeastReduction = 0.8;
/// Where coarsening stalls, up to so many rows are still solved exactly.
constexpr Index kLargestDense = 2000;
constexpr int kPowerSteps = 8;
/// What the power iteration may miss of the largest eigenvalue.
constexpr double kPowerMargin = 1.1;
/// Taking weak couplings to the diagonal must leave this part of it.
constexpr Real kLeastDiagonal = 0.1F;

/// Compressed rows in single precision.
struct Rows {
  Array<Index> offsets{0}, columns;
  Array<Real> values;
};

/// One level: its matrix, and what leads to the next.
struct Level {
  Rows matrix;          // off the diagonal, columns ascending
  Array<Index> middle;  // row -> its first entry to the right of the diagonal
  Array<Real> diagonal, inverse_diagonal;
  Rows prolongation, restriction;  // transposes of each other
  mutable Array<Real> x, b, residual;

  Index size() const { return static_cast<Index>(diagonal.size()); }

  void complete() {
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

/// Which entries couple strongly, and the diagonal of the matrix in which the others are added to
/// it: the strong part has the same row sums.
struct StrongPart {
  Array<unsigned char> is_strong;
  Array<Index> offsets, columns;
  Array<Real> diagonal;

  explicit StrongPart(const Level& level) {
    const Index n = level.size();
    const Rows& a = level.matrix;
    Array<Real> largest(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) {
      largest[i] = 0;
      for (Index k = a.offsets[i]; k < a.offsets[i + 1]; ++k)
        largest[i] = std::max(largest[i], -a.values[k]);
    }
    is_strong.resize(a.columns.size());
    columns.resize(a.columns.size());
    offsets.resize(static_cast<std::size_t>(n) + 1);
    diagonal.resize(static_cast<std::size_t>(n));
    Index end = 0;
    offsets[0] = 0;
    for (Index i = 0; i < n; ++i) {
      Real weak = 0;
      for (Index k = a.offsets[i]; k < a.offsets[i + 1]; ++k) {
        const Index j = a.columns[k];
        const Real limit = kStrong * std::min(largest[i], largest[j]);
        const bool strong = limit > 0 && -a.values[k] >= limit;
        is_strong[k] = strong;
        if (strong)
          columns[end++] = j;
        else
          weak += a.values[k];
      }
      const Real own = level.diagonal[i];
      diagonal[i] = own + weak > kLeastDiagonal * own ? own + weak : own;
      offsets[i + 1] = end;
    }
    columns.resize(static_cast<std::size_t>(end));
  }
  bool isolated(Index row) const { return offsets[row] == offsets[row + 1]; }
};

struct Aggregates {
  Array<Index> of_row;  // -1: a row without strong couplings
  Index count = 0;

  Aggregates(const Level& level, const StrongPart& strong) {
    const Index n = level.size();
    of_row.assign(static_cast<std::size_t>(n), -1);
    const auto any_strong = [&](Index row, const auto& test) {
      for (Index k = strong.offsets[row]; k < strong.offsets[row + 1]; ++k)
        if (test(strong.columns[k])) return true;
      return false;
    };
    // Whole neighbourhoods that are still free.
    for (Index i = 0; i < n; ++i) {
      if (of_row[i] >= 0 || strong.isolated(i)) continue;
      if (any_strong(i, [&](Index j) { return of_row[j] >= 0; })) continue;
      of_row[i] = count;
      for (Index k = strong.offsets[i]; k < strong.offsets[i + 1]; ++k)
        of_row[strong.columns[k]] = count;
      ++count;
    }
    // What is left joins the neighbour that it is coupled to most, among these.
    Array<Index> joined = of_row;
    for (Index i = 0; i < n; ++i) {
      if (of_row[i] >= 0) continue;
      Real best = 0;
      for (Index k = level.matrix.offsets[i]; k < level.matrix.offsets[i + 1]; ++k) {
        const Index j = level.matrix.columns[k];
        if (strong.is_strong[k] && of_row[j] >= 0 && -level.matrix.values[k] > best) {
          best = -level.matrix.values[k];
          joined[i] = of_row[j];
        }
      }
    }
    of_row = std::move(joined);
    for (Index i = 0; i < n; ++i) {
      if (of_row[i] >= 0 || strong.isolated(i)) continue;
      of_row[i] = count;
      for (Index k = strong.offsets[i]; k < strong.offsets[i + 1]; ++k)
        if (of_row[strong.columns[k]] < 0) of_row[strong.columns[k]] = count;
      ++count;
    }
  }
};

double square(Real value) { return static_cast<double>(value) * static_cast<double>(value); }

/// Of D^-1 A, A the strong part.
double largest_eigenvalue(const Level& level, const StrongPart& strong) {
  const Index n = level.size();
  Array<Real> x(static_cast<std::size_t>(n)), y(static_cast<std::size_t>(n));
  std::uint32_t state = 1;
  for (Index i = 0; i < n; ++i) {
    state = state * 1664525U + 1013904223U;
    x[i] = static_cast<Real>(state >> 8) * 0x1p-24F - 0.5F;
  }
  double value = 2;
  for (int step = 0; step < kPowerSteps; ++step) {
    double before = 0, after = 0;
    for (Index i = 0; i < n; ++i) {
      Real sum = strong.diagonal[i] * x[i];
      for (Index k = level.matrix.offsets[i]; k < level.matrix.offsets[i + 1]; ++k)
        if (strong.is_strong[k]) sum += level.matrix.values[k] * x[level.matrix.columns[k]];
      y[i] = sum / strong.diagonal[i];
      before += square(x[i]);
      after += square(y[i]);
    }
    if (!(before > 0) || !(after > 0)) break;
    value = std::sqrt(after / before);
    const Real scale = static_cast<Real>(1 / std::sqrt(after));
    for (Index i = 0; i < n; ++i) x[i] = scale * y[i];
  }
  return kPowerMargin * value;
}

/// Sums entries of one row at a time; columns come in the order they are met.
template <class Value>
class RowSums {
 public:
  RowSums(Index n_columns, Array<Index>& columns, Array<Value>& values)
      : place_(static_cast<std::size_t>(n_columns), -1), columns_(columns), values_(values) {}
  void begin_row() { begin_ = static_cast<Index>(columns_.size()); }
  void add(Index column, Value value) {
    Index& place = place_[column];
    if (place < begin_) {
      place = static_cast<Index>(columns_.size());
      columns_.push_back(column);
      values_.push_back(value);
    } else {
      values_[place] += value;
    }
  }
  Index end() const { return static_cast<Index>(columns_.size()); }

 private:
  Array<Index> place_;
  Array<Index>& columns_;
  Array<Value>& values_;
  Index begin_ = 0;
};

Rows smoothed_prolongation(const Level& level, const StrongPart& strong,
                           const Aggregates& aggregates) {
  const Index n = level.size();
  // 4/3 over the largest eigenvalue: the best damping for one step.   [VMB96]
  const Real omega = static_cast<Real>(4.0 / 3.0 / largest_eigenvalue(level, strong));
  Rows p;
  p.offsets.resize(static_cast<std::size_t>(n) + 1);
  p.offsets[0] = 0;
  p.columns.reserve(3 * static_cast<std::size_t>(n));
  p.values.reserve(3 * static_cast<std::size_t>(n));
  RowSums<Real> sums(aggregates.count, p.columns, p.values);
  for (Index i = 0; i < n; ++i) {
    sums.begin_row();
    if (!strong.isolated(i)) {
      sums.add(aggregates.of_row[i], 1 - omega);
      const Real factor = omega / strong.diagonal[i];
      for (Index k = level.matrix.offsets[i]; k < level.matrix.offsets[i + 1]; ++k)
        if (strong.is_strong[k])
          sums.add(aggregates.of_row[level.matrix.columns[k]], -factor * level.matrix.values[k]);
    }
    p.offsets[i + 1] = sums.end();
  }
  return p;
}

Rows transposed(const Rows& rows, Index n_columns) {
  Rows result;
  result.offsets.assign(static_cast<std::size_t>(n_columns) + 1, 0);
  for (const Index column : rows.columns) ++result.offsets[column + 1];
  for (Index i = 0; i < n_columns; ++i) result.offsets[i + 1] += result.offsets[i];
  result.columns.resize(rows.columns.size());
  result.values.resize(rows.columns.size());
  Array<Index> next(result.offsets.begin(), result.offsets.end() - 1);
  for (Index i = 0; i + 1 < static_cast<Index>(rows.offsets.size()); ++i)
    for (Index k = rows.offsets[i]; k < rows.offsets[i + 1]; ++k) {
      const Index place = next[rows.columns[k]]++;
      result.columns[place] = i;
      result.values[place] = rows.values[k];
    }
  return result;
}

/// P^T A P. Sums are in double precision: row sums of a stiffness cancel.
Level galerkin(const Level& fine, Index n_coarse) {
  const Index n = fine.size();
  const Rows& p = fine.prolongation;
  const Rows& r = fine.restriction;
  Rows ap;
  ap.offsets.resize(static_cast<std::size_t>(n) + 1);
  ap.offsets[0] = 0;
  ap.columns.reserve(2 * p.columns.size());
  ap.values.reserve(2 * p.columns.size());
  {
    RowSums<Real> sums(n_coarse, ap.columns, ap.values);
    const auto add_row = [&](Index row, Real factor) {
      for (Index k = p.offsets[row]; k < p.offsets[row + 1]; ++k)
        sums.add(p.columns[k], factor * p.values[k]);
    };
    for (Index i = 0; i < n; ++i) {
      sums.begin_row();
      add_row(i, fine.diagonal[i]);
      for (Index k = fine.matrix.offsets[i]; k < fine.matrix.offsets[i + 1]; ++k)
        add_row(fine.matrix.columns[k], fine.matrix.values[k]);
      ap.offsets[i + 1] = sums.end();
    }
  }
  Array<Index> offsets(static_cast<std::size_t>(n_coarse) + 1), columns;
  Array<double> values;
  offsets[0] = 0;
  {
    RowSums<double> sums(n_coarse, columns, values);
    for (Index i = 0; i < n_coarse; ++i) {
      sums.begin_row();
      for (Index m = r.offsets[i]; m < r.offsets[i + 1]; ++m) {
        const double factor = r.values[m];
        for (Index k = ap.offsets[r.columns[m]]; k < ap.offsets[r.columns[m] + 1]; ++k)
          sums.add(ap.columns[k], factor * static_cast<double>(ap.values[k]));
      }
      offsets[i + 1] = sums.end();
    }
  }
  // Written transposed, its rows ascend; above and below the diagonal the values agree but for
  // rounding.
  Level coarse;
  Array<Index> next(static_cast<std::size_t>(n_coarse) + 1, 0);
  for (Index i = 0; i < n_coarse; ++i)
    for (Index k = offsets[i]; k < offsets[i + 1]; ++k)
      if (columns[k] != i) ++next[columns[k] + 1];
  for (Index i = 0; i < n_coarse; ++i) next[i + 1] += next[i];
  coarse.matrix.offsets = next;
  coarse.matrix.columns.resize(static_cast<std::size_t>(next[n_coarse]));
  coarse.matrix.values.resize(static_cast<std::size_t>(next[n_coarse]));
  coarse.diagonal.assign(static_cast<std::size_t>(n_coarse), 0);
  for (Index i = 0; i < n_coarse; ++i)
    for (Index k = offsets[i]; k < offsets[i + 1]; ++k) {
      if (columns[k] == i) {
        coarse.diagonal[i] = static_cast<Real>(values[k]);
        continue;
      }
      const Index place = next[columns[k]]++;
      coarse.matrix.columns[place] = i;
      coarse.matrix.values[place] = static_cast<Real>(values[k]);
    }
  return coarse;
}

}  // namespace

struct Multigrid::Impl {
  Reduction reduction;
  double scale = 1;  ///< the largest diagonal entry, so that single precision holds the others
  std::vector<Level> levels;
  Eigen::LLT<Matrix> coarsest;  ///< of the last level, if it is small
  bool solves_coarsest = false;
  mutable Vector coarse_values;

  Impl(const SparseMatrix& matrix, const std::vector<bool>& fixed) : reduction(matrix, fixed) {
    if (reduction.size() == 0) return;
    levels.reserve(40);
    levels.push_back(finest(matrix));
    levels.back().complete();
    while (levels.back().size() > kCoarsest && add_level()) {
    }
    factorise_coarsest();
  }

  Level finest(const SparseMatrix& matrix) {
    const Vector diagonal = positive_diagonal(matrix, reduction);
    scale = diagonal.maxCoeff();
    Level level;
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

  bool add_level() {
    Level& fine = levels.back();
    const StrongPart strong(fine);
    const Aggregates aggregates(fine, strong);
    if (aggregates.count == 0 || aggregates.count > kLeastReduction * fine.size()) return false;
    fine.prolongation = smoothed_prolongation(fine, strong, aggregates);
    fine.restriction = transposed(fine.prolongation, aggregates.count);
    Level coarse = galerkin(fine, aggregates.count);
    for (const Real entry : coarse.diagonal)
      if (!(entry > 0) || !std::isfinite(entry))
        throw SolverFailure(
            "multigrid: a coarse matrix is not positive definite, its diagonal is " +
            std::to_string(entry));
    coarse.complete();
    levels.push_back(std::move(coarse));
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

Multigrid::Multigrid(const SparseMatrix& matrix, const std::vector<bool>& fixed)
    : impl_(std::make_unique<Impl>(matrix, fixed)) {}

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
