#include "carat/solve/multigrid/coarsening.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "carat/base/parallel.h"

namespace carat::multigrid {
namespace {

/// Couplings of less than this part of the largest one of both rows are weak. A smaller part joins
/// rows that hardly matter to each other: on stretched cells and polygons with short sides that
/// costs up to twice the iterations.
constexpr Real kStrong = 0.3F;
/// A level that is hardly smaller than the one before is not worth having.
constexpr double kLeastReduction = 0.8;
/// Taking weak couplings to the diagonal must leave this part of it.
constexpr Real kLeastDiagonal = 0.1F;
/// Of one Jacobi step, over a bound of the largest eigenvalue. Over the eigenvalue itself 4/3 is
/// best [VMB96]; the bound is larger.
constexpr Real kDamping = 1.5F;

/// Which entries couple strongly, and the diagonal of the matrix in which the others are added to
/// it: the strong part has the same row sums.
struct StrongPart {
  Array<unsigned char> is_strong;
  Array<Index> offsets, columns;
  Array<Real> diagonal;

  explicit StrongPart(const LevelMatrices& level) {
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

/// Small sets of strongly coupled rows, which become the unknowns of the next level.
struct Aggregates {
  Array<Index> of_row;  // -1: a row without strong couplings
  Index count = 0;

  Aggregates(const LevelMatrices& level, const StrongPart& strong) {
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

/// Sums entries of one row at a time; columns come in the order they are met.
template <class Value>
class RowSums {
 public:
  RowSums(Index n_columns, std::size_t expected) : place_(static_cast<std::size_t>(n_columns), -1) {
    columns.reserve(expected);
    values.reserve(expected);
  }
  void begin_row() { begin_ = end(); }
  void add(Index column, Value value) {
    Index& place = place_[column];
    if (place < begin_) {
      place = end();
      columns.push_back(column);
      values.push_back(value);
    } else {
      values[place] += value;
    }
  }
  Index end() const { return static_cast<Index>(columns.size()); }

  Array<Index> columns;
  Array<Value> values;

 private:
  Array<Index> place_;
  Index begin_ = 0;
};

template <class Value>
struct SummedRows {
  Array<Index> offsets, columns;
  Array<Value> values;
};

/// \param row  row(i, sums): adds the entries of row i
template <class Value, class Row>
SummedRows<Value> sum_rows(Index n, Index n_columns, double entries_a_row, int threads,
                           const Row& row) {
  SummedRows<Value> result;
  result.offsets.resize(static_cast<std::size_t>(n) + 1);
  result.offsets[0] = 0;
  struct Block {
    Index begin = 0, end = 0;
    std::optional<RowSums<Value>> sums;
  };
  std::vector<Block> blocks(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n, threads, [&](int number, Index begin, Index end) {
    Block& block = blocks[static_cast<std::size_t>(number)];
    block.begin = begin;
    block.end = end;
    RowSums<Value>& sums =
        block.sums.emplace(n_columns, static_cast<std::size_t>(entries_a_row * (end - begin)));
    for (Index i = begin; i < end; ++i) {
      sums.begin_row();
      row(i, sums);
      result.offsets[i + 1] = sums.end();
    }
  });
  result.columns = std::move(blocks[0].sums->columns);
  result.values = std::move(blocks[0].sums->values);
  for (std::size_t k = 1; k < blocks.size() && blocks[k].sums; ++k) {
    RowSums<Value>& sums = *blocks[k].sums;
    const Index before = result.offsets[blocks[k].begin];
    for (Index i = blocks[k].begin; i < blocks[k].end; ++i) result.offsets[i + 1] += before;
    result.columns.insert(result.columns.end(), sums.columns.begin(), sums.columns.end());
    result.values.insert(result.values.end(), sums.values.begin(), sums.values.end());
    blocks[k].sums.reset();
  }
  return result;
}

/// The aggregates' indicators after one Jacobi step on the strong part. Its diagonal is taken
/// together with the row's absolute values, which bounds the eigenvalues by one: no estimate is
/// needed, and a row that is not dominated by its diagonal slows down itself alone.
Rows smoothed_prolongation(const LevelMatrices& level, const StrongPart& strong,
                           const Aggregates& aggregates, int threads) {
  const Rows& a = level.matrix;
  SummedRows<Real> p =
      sum_rows<Real>(level.size(), aggregates.count, 3, threads, [&](Index i, RowSums<Real>& sums) {
        if (strong.isolated(i)) return;
        Real bound = strong.diagonal[i];
        for (Index k = a.offsets[i]; k < a.offsets[i + 1]; ++k)
          if (strong.is_strong[k]) bound -= a.values[k];
        const Real factor = kDamping / bound;
        sums.add(aggregates.of_row[i], 1 - factor * strong.diagonal[i]);
        for (Index k = a.offsets[i]; k < a.offsets[i + 1]; ++k)
          if (strong.is_strong[k]) sums.add(aggregates.of_row[a.columns[k]], -factor * a.values[k]);
      });
  return {std::move(p.offsets), std::move(p.columns), std::move(p.values)};
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
LevelMatrices galerkin(const LevelMatrices& fine, Index n_coarse, int threads) {
  const Rows& p = fine.prolongation;
  const Rows& r = fine.restriction;
  SummedRows<double> sums;
  {
    const SummedRows<Real> ap =
        sum_rows<Real>(fine.size(), n_coarse, 6, threads, [&](Index i, RowSums<Real>& row) {
          const auto add_row = [&](Index j, Real factor) {
            for (Index k = p.offsets[j]; k < p.offsets[j + 1]; ++k)
              row.add(p.columns[k], factor * p.values[k]);
          };
          add_row(i, fine.diagonal[i]);
          for (Index k = fine.matrix.offsets[i]; k < fine.matrix.offsets[i + 1]; ++k)
            add_row(fine.matrix.columns[k], fine.matrix.values[k]);
        });
    sums = sum_rows<double>(n_coarse, n_coarse, 16, threads, [&](Index i, RowSums<double>& row) {
      for (Index m = r.offsets[i]; m < r.offsets[i + 1]; ++m) {
        const double factor = r.values[m];
        for (Index k = ap.offsets[r.columns[m]]; k < ap.offsets[r.columns[m] + 1]; ++k)
          row.add(ap.columns[k], factor * static_cast<double>(ap.values[k]));
      }
    });
  }
  // Written transposed, its rows ascend; above and below the diagonal the values agree but for
  // rounding.
  LevelMatrices coarse;
  Array<Index> next(static_cast<std::size_t>(n_coarse) + 1, 0);
  for (Index i = 0; i < n_coarse; ++i)
    for (Index k = sums.offsets[i]; k < sums.offsets[i + 1]; ++k)
      if (sums.columns[k] != i) ++next[sums.columns[k] + 1];
  for (Index i = 0; i < n_coarse; ++i) next[i + 1] += next[i];
  coarse.matrix.offsets = next;
  coarse.matrix.columns.resize(static_cast<std::size_t>(next[n_coarse]));
  coarse.matrix.values.resize(static_cast<std::size_t>(next[n_coarse]));
  coarse.diagonal.assign(static_cast<std::size_t>(n_coarse), 0);
  for (Index i = 0; i < n_coarse; ++i)
    for (Index k = sums.offsets[i]; k < sums.offsets[i + 1]; ++k) {
      if (sums.columns[k] == i) {
        coarse.diagonal[i] = static_cast<Real>(sums.values[k]);
        continue;
      }
      const Index place = next[sums.columns[k]]++;
      coarse.matrix.columns[place] = i;
      coarse.matrix.values[place] = static_cast<Real>(sums.values[k]);
    }
  return coarse;
}

}  // namespace

std::optional<LevelMatrices> coarsen(LevelMatrices& fine, int threads) {
  const StrongPart strong(fine);
  const Aggregates aggregates(fine, strong);
  if (aggregates.count == 0 || aggregates.count > kLeastReduction * fine.size()) return {};
  fine.prolongation = smoothed_prolongation(fine, strong, aggregates, threads);
  fine.restriction = transposed(fine.prolongation, aggregates.count);
  return galerkin(fine, aggregates.count, threads);
}

}  // namespace carat::multigrid
