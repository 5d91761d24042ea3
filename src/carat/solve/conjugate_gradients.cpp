#include "carat/solve/conjugate_gradients.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "carat/base/error.h"
#include "carat/solve/reduction.h"

namespace carat {
namespace {

constexpr double kTolerance = 1e-12;
/// What the true residual may be when the recursive one has converged.
constexpr double kAccepted = 1e-10;
constexpr int kMaxIterations = 3000;
/// Of the unit diagonal: smaller pivots make a factor useless.
constexpr double kLeastPivot = 1e-3;
constexpr double kFirstShift = 1e-3;
constexpr double kLargestShift = 4;

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

}  // namespace

struct ConjugateGradients::Impl {
  Reduction reduction;
  Vector scale;  ///< 1 / sqrt(a_ii): the system is solved with a unit diagonal
  std::vector<double> values, factor;  ///< lower triangles by rows, the diagonal last in a row
  Vector inverse_pivots;
  FactorInfo info;

  Impl(const SparseMatrix& matrix, const std::vector<bool>& fixed) : reduction(matrix, fixed) {
    const auto start = std::chrono::steady_clock::now();
    const Index n = reduction.size();
    scale.resize(n);
    inverse_pivots.resize(n);
    for (Index i = 0; i < n; ++i) {
      const Index last = reduction.offsets[i + 1] - 1;
      const bool has_diagonal = last >= reduction.offsets[i] && reduction.columns[last] == i;
      const double diagonal = has_diagonal ? matrix.valuePtr()[reduction.source[last]] : 0;
      if (!(diagonal > 0) || !std::isfinite(diagonal)) {
        const Index row = reduction.kept[i];
        throw SolverFailure("the matrix is not positive definite: the diagonal of row (vertex) " +
                                std::to_string(row) + " is " + std::to_string(diagonal),
                            {row});
      }
      scale[i] = 1 / std::sqrt(diagonal);
    }
    values.resize(reduction.columns.size());
    for (Index i = 0; i < n; ++i)
      for (Index k = reduction.offsets[i]; k < reduction.offsets[i + 1]; ++k)
        values[k] = matrix.valuePtr()[reduction.source[k]] * scale[i] * scale[reduction.columns[k]];
    factor.resize(values.size());
    double shift = 0;
    while (!factorise(shift)) {
      shift = shift > 0 ? 4 * shift : kFirstShift;
      if (shift > kLargestShift)
        throw SolverFailure(
            "the matrix has no incomplete Cholesky factor: it is not positive "
            "definite, or holds values that are not finite");
    }
    info.method = "conjugate gradients, incomplete Cholesky";
    info.ordering = "as numbered";
    info.nonzeros = static_cast<std::int64_t>(factor.size());
    info.factor_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  /// The factor of the matrix with a diagonal of 1 + shift, on its pattern.
  bool factorise(double shift) {
    const Index n = reduction.size();
    const Index* const offsets = reduction.offsets.data();
    const Index* const columns = reduction.columns.data();
    std::vector<double> row(static_cast<std::size_t>(n), 0.0);
    for (Index i = 0; i < n; ++i) {
      const Index begin = offsets[i], last = offsets[i + 1] - 1;
      for (Index k = begin; k < last; ++k) row[columns[k]] = values[k];
      double pivot = 1 + shift;
      for (Index k = begin; k < last; ++k) {
        const Index j = columns[k];
        double entry = row[j];
        for (Index m = offsets[j]; m < offsets[j + 1] - 1; ++m)
          entry -= factor[m] * row[columns[m]];
        entry *= inverse_pivots[j];
        row[j] = factor[k] = entry;
        pivot -= entry * entry;
      }
      for (Index k = begin; k < last; ++k) row[columns[k]] = 0;
      if (!(pivot > kLeastPivot) || !std::isfinite(pivot)) return false;
      factor[last] = std::sqrt(pivot);
      inverse_pivots[i] = 1 / factor[last];
    }
    return true;
  }

  /// y = A x with the lower triangle alone.
  void multiply(const Vector& x, Vector& y) const {
    const Index n = reduction.size();
    y.setZero();
    for (Index i = 0; i < n; ++i) {
      const double at = x[i];
      double sum = at;
      for (Index k = reduction.offsets[i]; k < reduction.offsets[i + 1] - 1; ++k) {
        const Index j = reduction.columns[k];
        sum += values[k] * x[j];
        y[j] += values[k] * at;
      }
      y[i] += sum;
    }
  }

  /// z = (L L^T)^-1 r.
  void precondition(const Vector& r, Vector& z) const {
    const Index n = reduction.size();
    for (Index i = 0; i < n; ++i) {
      double sum = r[i];
      for (Index k = reduction.offsets[i]; k < reduction.offsets[i + 1] - 1; ++k)
        sum -= factor[k] * z[reduction.columns[k]];
      z[i] = sum * inverse_pivots[i];
    }
    for (Index i = n - 1; i >= 0; --i) {
      const double at = z[i] *= inverse_pivots[i];
      for (Index k = reduction.offsets[i]; k < reduction.offsets[i + 1] - 1; ++k)
        z[reduction.columns[k]] -= factor[k] * at;
    }
  }

  /// \param b  scaled right-hand side
  /// \return scaled solution
  Vector iterate(const Vector& b) const {
    Vector x = Vector::Zero(b.size());
    const double size = b.norm();
    if (!std::isfinite(size))
      throw SolverFailure("the right-hand side holds values that are not finite");
    if (!(size > 0)) return x;
    Vector r = b, z(b.size()), p, q(b.size());
    precondition(r, z);
    p = z;
    double rz = r.dot(z);
    int iteration = 0;
    for (; iteration < kMaxIterations && r.norm() > kTolerance * size; ++iteration) {
      multiply(p, q);
      const double curvature = p.dot(q);
      if (!(curvature > 0))
        throw SolverFailure(
            "the matrix is not positive definite: conjugate gradients met a "
            "direction of energy " +
            scientific(curvature));
      const double step = rz / curvature;
      x += step * p;
      r -= step * q;
      precondition(r, z);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
    }
    multiply(x, q);
    const double residual = (b - q).norm() / size;
    if (!(residual <= kAccepted))
      throw SolverFailure("conjugate gradients stopped at a residual of " + scientific(residual) +
                          " of the right-hand side after " + std::to_string(iteration) +
                          " iterations; at most " + scientific(kAccepted) + " is a solution");
    return x;
  }
};

ConjugateGradients::ConjugateGradients(const SparseMatrix& matrix, const std::vector<bool>& fixed)
    : impl_(std::make_unique<Impl>(matrix, fixed)) {}

ConjugateGradients::~ConjugateGradients() = default;

Matrix ConjugateGradients::solve(const Matrix& rhs) const {
  const Reduction& reduction = impl_->reduction;
  if (rhs.rows() != static_cast<Eigen::Index>(reduction.reduced_of.size()))
    throw InvalidOption("a right-hand side of " + std::to_string(rhs.rows()) + " rows for " +
                        std::to_string(reduction.reduced_of.size()) + " unknowns");
  Matrix result = Matrix::Zero(rhs.rows(), rhs.cols());
  Vector b(reduction.size());
  for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
    for (Index i = 0; i < reduction.size(); ++i) b[i] = rhs(reduction.kept[i], k) * impl_->scale[i];
    const Vector x = impl_->iterate(b);
    for (Index i = 0; i < reduction.size(); ++i)
      result(reduction.kept[i], k) = x[i] * impl_->scale[i];
  }
  return result;
}

const FactorInfo& ConjugateGradients::info() const { return impl_->info; }

}  // namespace carat
