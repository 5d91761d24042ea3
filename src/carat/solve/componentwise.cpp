#include "carat/solve/componentwise.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "carat/base/error.h"
#include "carat/base/interrupt.h"
#include "carat/base/parallel.h"
#include "carat/base/text.h"

namespace carat {
namespace {

using namespace componentwise;

/// Sums are those of blocks of so many rows, so that they do not depend on the threads.
constexpr Index kRowsOfSum = 4096;

/// W right-hand sides, the values of a row side by side. Matrix and right-hand sides are multiplied
/// by a power of two that brings the smallest diagonal entry near 1: bounds then do not depend on
/// units.
template <int W>
class Iteration {
 public:
  using Row = Eigen::Array<double, W, 1>;
  using Rows = std::vector<Row, Eigen::aligned_allocator<Row>>;

  /// \param inverse_diagonal  of unit * a
  Iteration(const SparseMatrix& a, double unit, const Vector& inverse_diagonal, int threads)
      : a_(a), unit_(unit), inverse_(inverse_diagonal), threads_(threads) {}

  Matrix solve(const Eigen::Ref<const Matrix>& b, SolveReport& report) {
    const std::size_t n = static_cast<std::size_t>(a_.rows());
    x_.assign(n, Row::Zero());
    q_.assign(n, Row::Zero());
    r_.resize(n);
    p_.resize(n);
    Row scale;  // the residual is r_ times this
    for (int k = 0; k < W; ++k) {
      const double largest = unit_ * b.col(k).cwiseAbs().maxCoeff();
      if (!std::isfinite(b.col(k).sum()))
        throw SolverFailure("the right-hand side holds values that are not finite");
      scale[k] = largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1;
    }
    for (std::size_t i = 0; i < n; ++i)
      r_[i] = unit_ * b.row(static_cast<Index>(i)).transpose().array() / scale;
    Row energy = sum_rows([&](std::size_t i) {
      p_[i] = inverse_[static_cast<Index>(i)] * r_[i];
      return (r_[i] * p_[i]).eval();
    });
    Row worst = Row::Ones();
    Index iterations = 0;
    const auto done = [&] { return (worst <= kTolerance || energy == 0).all(); };
    for (; !done() && iterations < kIterations; ++iterations) {
      throw_if_interrupted();
      const Row curvature = sum_rows([&](std::size_t i) {
        q_[i] = product(i, p_);
        return (p_[i] * q_[i]).eval();
      });
      // Columns that are solved stay as they are.
      const Eigen::Array<bool, W, 1> moves = worst > kTolerance && energy > 0;
      if ((moves && !(curvature > 0)).any())
        throw SolverFailure(
            "the matrix is not positive definite, or holds values that are not finite: conjugate "
            "gradients met a direction without energy");
      const Row step = moves.select(energy / curvature, Row::Zero());
      const Row scaled_step = step * scale;
      const Row next = sum_rows([&](std::size_t i) {
        x_[i] += scaled_step * p_[i];
        r_[i] -= step * q_[i];
        return (inverse_[static_cast<Index>(i)] * r_[i].square()).eval();
      });
      const Row ratio = moves.select(next / energy, Row::Zero());
      const Row growth = (next < kSmallEnergy && scale > std::ldexp(1.0, kRescaling - 1000))
                             .select(Row::Constant(std::ldexp(1.0, kRescaling)), Row::Ones());
      for_rows([&](std::size_t i) {
        p_[i] = (inverse_[static_cast<Index>(i)] * r_[i] + ratio * p_[i]) * growth;
        r_[i] *= growth;
      });
      energy = next * growth.square();
      scale /= growth;
      if (iterations % kCheckEvery == kCheckEvery - 1) worst = moves.select(errors(b), worst);
    }
    worst = errors(b);
    if (!(worst <= kTolerance).all())
      throw SolverFailure("conjugate gradients left a residual of " + scientific(worst.maxCoeff()) +
                          " of its row after " + std::to_string(iterations) +
                          " iterations, at most 1e-10 is a solution");
    report.iterations = std::max(report.iterations, iterations);
    report.passes += iterations;
    report.traffic += iterations * (static_cast<double>(a_.nonZeros()) *
                                        static_cast<double>(sizeof(double) + sizeof(Index)) +
                                    static_cast<double>(sizeof(double)) * a_.rows());
    report.residual = std::max(report.residual, worst.maxCoeff());
    Matrix result(a_.rows(), W);
    for (std::size_t i = 0; i < n; ++i)
      result.row(static_cast<Index>(i)) = x_[i].matrix().transpose();
    return result;
  }

 private:
  template <class Body>
  void for_rows(const Body& body) const {
    parallel_blocks(static_cast<Index>(a_.rows()), threads_, [&](int, Index begin, Index end) {
      for (Index i = begin; i < end; ++i) body(static_cast<std::size_t>(i));
    });
  }

  /// Sum over the rows of what the body returns.
  template <class Body>
  Row sum_rows(const Body& body) const {
    const Index n = static_cast<Index>(a_.rows());
    Rows sums(static_cast<std::size_t>((n + kRowsOfSum - 1) / kRowsOfSum), Row::Zero());
    const auto whole = [](Index row) { return (row + kRowsOfSum - 1) / kRowsOfSum * kRowsOfSum; };
    parallel_blocks(n, threads_, [&](int, Index begin, Index end) {
      for (Index i = whole(begin); i < std::min(n, whole(end)); ++i)
        sums[static_cast<std::size_t>(i / kRowsOfSum)] += body(static_cast<std::size_t>(i));
    });
    Row total = Row::Zero();
    for (const Row& sum : sums) total += sum;
    return total;
  }

  Row product(std::size_t i, const Rows& x) const {
    Row sum = Row::Zero();
    for (SparseMatrix::InnerIterator entry(a_, static_cast<Index>(i)); entry; ++entry)
      sum += unit_ * entry.value() * x[static_cast<std::size_t>(entry.col())];
    return sum;
  }

  /// The worst |b - A x|_i / (|A| |x| + |b|)_i; infinity where a value is not finite.
  Row errors(const Eigen::Ref<const Matrix>& b) {
    for_rows([&](std::size_t i) {
      const Row right = unit_ * b.row(static_cast<Index>(i)).transpose().array();
      Row residual = right, size = right.abs();
      for (SparseMatrix::InnerIterator entry(a_, static_cast<Index>(i)); entry; ++entry) {
        const Row term = unit_ * entry.value() * x_[static_cast<std::size_t>(entry.col())];
        residual -= term;
        size += term.abs();
      }
      const bool free = inverse_[static_cast<Index>(i)] > 0;
      q_[i] = free ? (size < kVanished).select(Row::Zero(), (residual / size).abs()).eval()
                   : Row::Zero().eval();
    });
    Row worst = Row::Zero();
    for (const Row& error : q_)
      worst = (error <= worst).select(worst, error.isFinite().select(error, HUGE_VAL));
    return worst;
  }

  const SparseMatrix& a_;
  double unit_;
  const Vector& inverse_;  // of the diagonal; 0 in fixed rows, which so stay 0
  int threads_;
  Rows x_, r_, p_, q_;
};

}  // namespace

Matrix solve_componentwise(const SparseMatrix& a, const std::vector<bool>& fixed, const Matrix& b,
                           int threads, SolveReport& report) {
  Vector inverse = a.diagonal();
  for (Index i = 0; i < inverse.size(); ++i) {
    if (!fixed.empty() && fixed[static_cast<std::size_t>(i)]) {
      inverse[i] = 0;
      continue;
    }
    if (!(inverse[i] > 0) || !std::isfinite(inverse[i]))
      throw SolverFailure("the matrix is not positive definite: the diagonal of row (vertex) " +
                              std::to_string(i) + " is " + std::to_string(inverse[i]),
                          {i});
    inverse[i] = 1 / inverse[i];
  }
  const double largest = inverse.size() > 0 ? inverse.maxCoeff() : 0.0;
  const double unit = largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1.0;
  inverse /= unit;
  Matrix result(b.rows(), b.cols());
  const auto solve = [&]<int W>(Index first) {
    result.middleCols(first, W) =
        Iteration<W>(a, unit, inverse, threads).solve(b.middleCols(first, W), report);
    return first + W;
  };
  Index k = 0;
  while (k < b.cols()) {
    if (b.cols() - k >= 8)
      k = solve.template operator()<8>(k);
    else if (b.cols() - k >= 4)
      k = solve.template operator()<4>(k);
    else
      k = solve.template operator()<1>(k);
  }
  return result;
}

}  // namespace carat
