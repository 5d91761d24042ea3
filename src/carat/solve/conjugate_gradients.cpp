#include "carat/solve/conjugate_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "carat/base/error.h"
#include "carat/base/interrupt.h"
#include "carat/base/parallel.h"
#include "carat/base/text.h"

namespace carat {
namespace {

/// What the rounding of a product may add to a residual, in units of |A| |x|.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
/// Restarts from the true residual where that of the recursion has drifted from it.
constexpr int kRestarts = 3;
/// Rows whose products are summed before they meet those of other rows. Sums over a chunk and over
/// chunks have a fixed order, whichever thread computes them.
constexpr Index kChunk = 4096;
/// Rows that are summed side by side.
constexpr Index kLanes = 8;
/// Right-hand sides that advance together.
constexpr Index kTogether = 8;
/// Below so many values a thread costs more than it saves.
constexpr std::int64_t kParallelFrom = 1 << 17;

/// At most six of the residuals, evenly spaced, the last among them.
std::string course(const std::vector<double>& history) {
  std::string text;
  const std::size_t last = history.size() - 1;
  const std::size_t points = std::min<std::size_t>(6, history.size());
  for (std::size_t k = 0; k < points; ++k) {
    const std::size_t at = points > 1 ? last * k / (points - 1) : last;
    text.append(k > 0 ? ", " : "").append(scientific(history[at]));
    text.append(" (").append(std::to_string(at)).append(")");
  }
  return text;
}

/// Operations on k vectors of n rows, with the values of a row side by side.
class Columns {
 public:
  Columns(Index n, Index k, int threads)
      : n_(n), k_(k), threads_(std::int64_t{n} * k < kParallelFrom ? 1 : threads) {}

  /// Calls update(first, last) for ranges of values that cover all vectors.
  template <class Update>
  void for_values(const Update& update) const {
    for_chunks([&](Index, Index begin, Index end) { update(position(begin), position(end)); });
  }
  /// The same, and sums value(i) over the rows of every vector, i a position.
  template <class Update, class Value>
  Vector sums(const Update& update, const Value& value) const {
    Matrix partial(k_, (n_ + kChunk - 1) / kChunk);
    for_chunks([&](Index chunk, Index begin, Index end) {
      update(position(begin), position(end));
      if (k_ == 1)
        sum_chunk(std::integral_constant<Index, 1>{}, begin, end, value, &partial(0, chunk));
      else
        sum_chunk(k_, begin, end, value, &partial(0, chunk));
    });
    Vector total = Vector::Zero(k_);
    for (Eigen::Index chunk = 0; chunk < partial.cols(); ++chunk) total += partial.col(chunk);
    return total;
  }
  Vector dots(const Vector& a, const Vector& b) const {
    return sums([](Eigen::Index, Eigen::Index) {}, [&](Eigen::Index i) { return a[i] * b[i]; });
  }

 private:
  Eigen::Index position(Index row) const { return Eigen::Index{row} * k_; }
  template <class Body>
  void for_chunks(const Body& body) const {
    parallel_blocks(n_, threads_, [&](int, Index begin, Index end) {
      // Chunks that start in this block.
      for (Index chunk = (begin + kChunk - 1) / kChunk; std::int64_t{chunk} * kChunk < end; ++chunk)
        body(chunk, chunk * kChunk,
             static_cast<Index>(std::min<std::int64_t>(n_, std::int64_t{chunk + 1} * kChunk)));
    });
  }
  template <class Count, class Value>
  void sum_chunk(Count k, Index begin, Index end, const Value& value, double* out) const {
    double lanes[kLanes * kTogether];
    const Index width = kLanes * k;
    std::fill(lanes, lanes + width, 0.0);
    const Index whole = begin + (end - begin) / kLanes * kLanes;
    for (Index row = begin; row < whole; row += kLanes) {
      const Eigen::Index first = Eigen::Index{row} * k;
      for (Index j = 0; j < width; ++j) lanes[j] += value(first + j);
    }
    for (Index row = whole; row < end; ++row)
      for (Index j = 0; j < k; ++j) lanes[j] += value(Eigen::Index{row} * k + j);
    for (Index j = 0; j < k; ++j) {
      out[j] = 0;
      for (Index lane = 0; lane < kLanes; ++lane) out[j] += lanes[lane * k + j];
    }
  }

  Index n_, k_;
  int threads_;
};

/// The iterations of a few right-hand sides.
class Iterations {
 public:
  Iterations(const std::function<void(const Vector&, Vector&)>& multiply,
             const Preconditioner& preconditioner, const Eigen::Ref<const Matrix>& b, double size,
             const IterationLimits& limits, int threads)
      : multiply_(multiply),
        preconditioner_(preconditioner),
        size_(size),
        limits_(limits),
        k_(static_cast<Index>(b.cols())),
        columns_(static_cast<Index>(b.rows()), k_, threads),
        b_(b.size()),
        x_(Vector::Zero(b.size())),
        q_(b.size()),
        state_(static_cast<std::size_t>(k_)) {
    as_rows(b_) = b;
    const Vector squares = columns_.dots(b_, b_);
    for (Index j = 0; j < k_; ++j) {
      state_[j].norm = std::sqrt(squares[j]);
      if (!std::isfinite(state_[j].norm))
        throw SolverFailure("the right-hand side holds values that are not finite");
      state_[j].solved = !(state_[j].norm > 0);
    }
  }

  Matrix solve(SolveReport& report) {
    r_ = b_;
    for (int restart = 0; restart <= kRestarts; ++restart) {
      for (State& state : state_) state.resting = state.solved;
      if (all_resting()) break;
      advance();
      compute_residuals(restart == kRestarts);
    }
    Index passes = 0;
    for (const State& state : state_) {
      if (!(state.norm > 0)) continue;
      if (!(state.residual <= limits_.accepted + state.rounding))
        throw SolverFailure("conjugate gradients stopped at a residual of " +
                            scientific(state.residual) + " of the right-hand side after " +
                            std::to_string(state.history.size() - 1) + " iterations, at most " +
                            scientific(limits_.accepted) +
                            " is a solution; residuals by iteration: " + course(state.history));
      report.iterations = std::max(report.iterations, static_cast<Index>(state.history.size()) - 1);
      report.residual = std::max(report.residual, state.residual);
      passes = std::max(passes, static_cast<Index>(state.history.size()) - 1);
    }
    report.passes += passes;
    return as_rows(x_);
  }

 private:
  struct State {
    double norm = 0, residual = 1, rounding = 0;
    double rz = 0;
    std::vector<double> history{1};
    bool resting = false;  // until the next restart
    bool solved = false;   // or given up
  };
  using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

  Rows as_rows(Vector& values) const { return {values.data(), values.size() / k_, k_}; }
  bool all_resting() const {
    return std::all_of(state_.begin(), state_.end(), [](const State& s) { return s.resting; });
  }
  bool spent(const State& state) const {
    return static_cast<Index>(state.history.size()) > limits_.iterations;
  }
  void rest_where_done() {
    for (State& state : state_)
      if (!(state.history.back() > limits_.tolerance) || spent(state)) state.resting = true;
  }

  /// Calls update(i, factor of the vector that value i belongs to).
  template <class Update>
  static void scaled(Eigen::Index first, Eigen::Index last, const Vector& factors,
                     const Update& update) {
    const Eigen::Index k = factors.size();
    if (k == 1) {
      const double factor = factors[0];
      for (Eigen::Index i = first; i < last; ++i) update(i, factor);
    } else {
      for (Eigen::Index row = first; row < last; row += k)
        for (Eigen::Index j = 0; j < k; ++j) update(row + j, factors[j]);
    }
  }

  /// Iterates until all vectors rest.
  void advance() {
    rest_where_done();
    if (all_resting()) return;
    preconditioner_.apply_block(r_, z_, k_);
    p_ = z_;
    take_products(columns_.dots(r_, z_), nullptr);
    Vector factors(k_);
    while (true) {
      throw_if_interrupted();
      multiply_(p_, q_);
      const Vector curvature = columns_.dots(p_, q_);
      for (Index j = 0; j < k_; ++j) {
        const State& state = state_[j];
        factors[j] = 0;
        if (state.resting) continue;
        if (!(curvature[j] > 0) || !(state.rz > 0))
          throw SolverFailure(
              "the matrix or its preconditioner is not positive definite: conjugate gradients met "
              "a direction of energy " +
              scientific(std::min(curvature[j], state.rz)));
        factors[j] = state.rz / curvature[j];
      }
      const Vector squares = columns_.sums(
          [&](Eigen::Index first, Eigen::Index last) {
            scaled(first, last, factors, [&](Eigen::Index i, double step) {
              x_[i] += step * p_[i];
              r_[i] -= step * q_[i];
            });
          },
          [&](Eigen::Index i) { return r_[i] * r_[i]; });
      for (Index j = 0; j < k_; ++j)
        if (!state_[j].resting) state_[j].history.push_back(std::sqrt(squares[j]) / state_[j].norm);
      rest_where_done();
      if (all_resting()) return;
      preconditioner_.apply_block(r_, z_, k_);
      take_products(columns_.dots(r_, z_), &factors);
      columns_.for_values([&](Eigen::Index first, Eigen::Index last) {
        scaled(first, last, factors,
               [&](Eigen::Index i, double factor) { p_[i] = z_[i] + factor * p_[i]; });
      });
    }
  }

  /// \param factors  if given: the new r.z over the old
  void take_products(const Vector& rz, Vector* factors) {
    for (Index j = 0; j < k_; ++j) {
      if (factors) (*factors)[j] = state_[j].resting ? 0 : rz[j] / state_[j].rz;
      state_[j].rz = rz[j];
    }
  }

  void compute_residuals(bool last) {
    multiply_(x_, q_);
    const Vector squares = columns_.sums(
        [&](Eigen::Index first, Eigen::Index end) {
          for (Eigen::Index i = first; i < end; ++i) r_[i] = b_[i] - q_[i];
        },
        [&](Eigen::Index i) { return r_[i] * r_[i]; });
    const Vector lengths = columns_.dots(x_, x_);
    for (Index j = 0; j < k_; ++j) {
      State& state = state_[j];
      if (state.solved) continue;
      state.residual = std::sqrt(squares[j]) / state.norm;
      state.rounding = kRounding * size_ * std::sqrt(lengths[j]) / state.norm;
      state.solved =
          state.residual <= std::max(limits_.tolerance, state.rounding) || spent(state) || last;
      if (!state.solved) state.history.back() = state.residual;
    }
  }

  const std::function<void(const Vector&, Vector&)>& multiply_;
  const Preconditioner& preconditioner_;
  double size_;
  const IterationLimits& limits_;
  Index k_;
  Columns columns_;
  Vector b_, x_, r_, z_, p_, q_;
  std::vector<State> state_;
};

}  // namespace

Matrix conjugate_gradients(const std::function<void(const Vector&, Vector&)>& multiply,
                           const Preconditioner& preconditioner, const Matrix& b, double size,
                           const IterationLimits& limits, SolveReport& report, int threads) {
  Matrix x(b.rows(), b.cols());
  for (Eigen::Index first = 0; first < b.cols(); first += kTogether) {
    const Eigen::Index count = std::min<Eigen::Index>(kTogether, b.cols() - first);
    x.middleCols(first, count) =
        Iterations(multiply, preconditioner, b.middleCols(first, count), size, limits, threads)
            .solve(report);
  }
  return x;
}

}  // namespace carat
