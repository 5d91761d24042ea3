#include "carat/solve/eigen_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/solve/krylov/largest_pairs.h"

namespace carat {
namespace {

// Up to this many rows the dense method is the faster one.
constexpr Index kDense = 300;
// Beyond this it takes minutes.
constexpr Index kMaxDense = 3000;
// The complement of the pairs found must have room for a small Krylov space.
constexpr Index kSpareDimensions = 32;
// The largest basis, 8 GB; a restart copies most of it.
constexpr double kMaxEntries = 1e9;
// Residuals beyond this are worth as many solves as there are pairs.
constexpr double kGoodResidual = 1e-9;
// 1^T S 1 / sum |S_ij| of constants that S annihilates: rounding leaves about 1e-16.
constexpr double kZeroEnergy = 1e-12;

/// The rows and columns of a matrix that take part.
SparseMatrix restrict_to(const SparseMatrix& matrix, const std::vector<Index>& kept) {
  std::vector<Index> reduced_of(static_cast<std::size_t>(matrix.rows()), -1);
  for (std::size_t i = 0; i < kept.size(); ++i) reduced_of[kept[i]] = static_cast<Index>(i);
  const Index n = static_cast<Index>(kept.size());
  SparseMatrix result(n, n);
  Eigen::Index nonzeros = 0;
  for (const Index row : kept)
    nonzeros += matrix.outerIndexPtr()[row + 1] - matrix.outerIndexPtr()[row];
  result.reserve(nonzeros);
  for (Index i = 0; i < n; ++i) {
    result.startVec(i);
    for (SparseMatrix::InnerIterator entry(matrix, kept[i]); entry; ++entry)
      if (const Index j = reduced_of[entry.col()]; j >= 0) result.insertBack(i, j) = entry.value();
  }
  result.finalize();
  return result;
}

/// S x = lambda M x over the rows that take part, with the null vectors of S that are known: the
/// indicators of floating components.
class Pencil final : public InverseOperator {
 public:
  Pencil(const SparseMatrix& stiffness, const SparseMatrix& mass, std::vector<Index> kept)
      : rows(std::move(kept)), s(restrict_to(stiffness, rows)), m(restrict_to(mass, rows)) {
    find_floating_components();
    ones_ = Vector::Ones(m.cols());
    row_mass_ = m * ones_;
    measure_.assign(floating.size(), 0.0);
    for (Index i = 0; i < size(); ++i)
      if (floating_of_[i] >= 0) measure_[floating_of_[i]] += row_mass_[i];
    for (std::size_t f = 0; f < floating.size(); ++f)
      if (!(measure_[f] > 0))
        throw SolverFailure("the mass of the component of row (vertex) " +
                                std::to_string(rows[floating[f]]) + " is " +
                                std::to_string(measure_[f]) +
                                "; the mass matrix must be positive definite",
                            {rows[floating[f]]});
  }

  Index size() const override { return static_cast<Index>(rows.size()); }
  Index n_zero() const { return static_cast<Index>(floating.size()); }

  Matrix mass_product(const Eigen::Ref<const Matrix>& x) const override { return m * x; }

  void project(Matrix& x) const override { take_out_constants(x, row_mass_, ones_); }

  Matrix solve(Matrix b) const override {
    take_out_constants(b, ones_, row_mass_);
    Matrix x = solver_->solve(b);
    project(x);
    return x;
  }

  /// Every floating component is held at one row: right-hand sides in the range of S ask nothing
  /// of it.
  void factorise() {
    std::vector<Index> ground(floating.size(), -1);
    const Vector diagonal = s.diagonal();
    for (Index i = 0; i < size(); ++i)
      if (const Index f = floating_of_[i];
          f >= 0 && (ground[f] < 0 || diagonal[i] > diagonal[ground[f]]))
        ground[f] = i;
    std::vector<bool> held(rows.size(), false);
    for (const Index i : ground) held[i] = true;
    try {
      solver_ = std::make_unique<Cholesky>(s, held);
    } catch (const SolverFailure& failure) {
      if (failure.elements().empty()) throw;
      const Index row = rows[failure.elements()[0]];
      throw SolverFailure(
          "the stiffness is not positive definite beside the constants of its "
          "components: the pivot of row (vertex) " +
              std::to_string(row) + " is not positive; look for degenerate elements around it",
          {row});
    }
  }
  const FactorInfo& factor_info() const { return solver_->info(); }

  /// The normalised indicator of a floating component.
  Vector zero_mode(Index f) const {
    Vector x = Vector::Zero(size());
    for (Index i = 0; i < size(); ++i)
      if (floating_of_[i] == f) x[i] = 1 / std::sqrt(measure_[f]);
    return x;
  }

  /// Looks for negative curvature with conjugate gradients, scaled by the diagonal: any direction
  /// of it is among the first that a random right-hand side shows.
  void check_mass() const;

  const std::vector<Index> rows;  // reduced -> full
  const SparseMatrix s, m;
  std::vector<Index> floating;  // floating component -> its first row

 private:
  void find_floating_components();
  /// x -= along_f (weights_f . x) / measure_f for each floating component f.
  void take_out_constants(Matrix& x, const Vector& weights, const Vector& along) const;

  std::vector<Index> floating_of_;  // row -> floating component, or -1
  Vector ones_, row_mass_;
  std::vector<double> measure_;
  std::unique_ptr<Cholesky> solver_;
};

void Pencil::find_floating_components() {
  const std::vector<Index> component = matrix_components(s.cwiseAbs() + m.cwiseAbs());
  Index n = 0;
  for (const Index c : component) n = std::max(n, c + 1);
  std::vector<double> energy(static_cast<std::size_t>(n), 0), terms(static_cast<std::size_t>(n), 0);
  std::vector<Index> first(static_cast<std::size_t>(n), -1);
  for (Index i = 0; i < size(); ++i) {
    const Index c = component[i];
    if (first[c] < 0) first[c] = i;
    for (SparseMatrix::InnerIterator entry(s, i); entry; ++entry) {
      energy[c] += entry.value();
      terms[c] += std::abs(entry.value());
    }
  }
  std::vector<Index> number(static_cast<std::size_t>(n), -1);
  for (Index c = 0; c < n; ++c)
    if (std::abs(energy[c]) <= kZeroEnergy * terms[c]) {
      number[c] = n_zero();
      floating.push_back(first[c]);
    }
  floating_of_.resize(rows.size());
  for (Index i = 0; i < size(); ++i) floating_of_[i] = number[component[i]];
}

void Pencil::take_out_constants(Matrix& x, const Vector& weights, const Vector& along) const {
  if (floating.empty()) return;
  std::vector<double> mean(floating.size());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    std::fill(mean.begin(), mean.end(), 0.0);
    for (Index i = 0; i < size(); ++i)
      if (floating_of_[i] >= 0) mean[floating_of_[i]] += weights[i] * x(i, k);
    for (std::size_t f = 0; f < mean.size(); ++f) mean[f] /= measure_[f];
    for (Index i = 0; i < size(); ++i)
      if (floating_of_[i] >= 0) x(i, k) -= mean[floating_of_[i]] * along[i];
  }
}

void Pencil::check_mass() const {
  constexpr int kMaxIterations = 300;
  const Vector diagonal = m.diagonal();
  for (Index i = 0; i < size(); ++i)
    if (!(diagonal[i] > 0) || !std::isfinite(diagonal[i]))
      throw SolverFailure("the mass is not positive definite: the diagonal entry of row (vertex) " +
                              std::to_string(rows[i]) + " is " + std::to_string(diagonal[i]) +
                              "; it must be positive. Lumped masses of concave elements can be "
                              "negative: use the full one",
                          {rows[i]});
  std::mt19937_64 random(1);
  Vector residual(size());
  for (Index i = 0; i < size(); ++i)
    residual[i] = (static_cast<double>(random() >> 11) * 0x1p-52 - 1) * std::sqrt(diagonal[i]);
  Vector scaled = residual.cwiseQuotient(diagonal), direction = scaled;
  double squared = residual.dot(scaled);
  const double goal = 1e-26 * squared;
  for (int iteration = 0; iteration < kMaxIterations && squared > goal; ++iteration) {
    const Vector product = m * direction;
    const double curvature = direction.dot(product);
    if (!(curvature > 0))
      throw SolverFailure("the mass is not positive definite: x^T M x = " +
                          std::to_string(curvature) + " for some x; it must be positive");
    residual -= squared / curvature * product;
    scaled = residual.cwiseQuotient(diagonal);
    const double next = residual.dot(scaled);
    direction = scaled + next / squared * direction;
    squared = next;
  }
}

/// All pairs at once; those of the constants come first, whatever rounding made of their values.
void solve_dense(const Pencil& pencil, Index count, Vector& values, Matrix& vectors) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(Matrix(pencil.s), Matrix(pencil.m));
  if (solver.info() != Eigen::Success)
    throw SolverFailure("eigenpairs: the dense iteration over " + std::to_string(pencil.size()) +
                        " rows did not converge; the matrices are too ill-conditioned");
  values = solver.eigenvalues().segment(pencil.n_zero(), count);
  vectors = solver.eigenvectors().middleCols(pencil.n_zero(), count);
  pencil.project(vectors);
}

double residual_of(const Pencil& pencil, double value, const Vector& x) {
  const Vector s_x = pencil.s * x;
  if (value == 0) {
    const double terms = (pencil.s.cwiseAbs() * x.cwiseAbs()).norm();
    return terms > 0 ? s_x.norm() / terms : 0;
  }
  const Vector m_x = pencil.m * x;
  return (s_x - value * m_x).norm() / (value * m_x.norm());
}

/// Where eigenvalues lie far apart, the rounding of the smallest ones' solves hides in the others'
/// vectors as rough noise; one more application of S^-1 M alone damps it.
/// \return number of right-hand sides solved for
Index refine(const Pencil& pencil, const Vector& values, Matrix& vectors) {
  double worst = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    worst = std::max(worst, residual_of(pencil, values[k], vectors.col(k)));
  if (worst <= kGoodResidual) return 0;
  constexpr Eigen::Index kAtOnce = 8;
  for (Eigen::Index k = 0; k < values.size(); k += kAtOnce) {
    auto some = vectors.middleCols(k, std::min(kAtOnce, values.size() - k));
    some = pencil.solve(pencil.mass_product(some)) * values.segment(k, some.cols()).asDiagonal();
  }
  const Matrix gram = vectors.transpose() * pencil.mass_product(vectors);
  const Eigen::LLT<Matrix> factor(gram);
  if (factor.info() != Eigen::Success)
    throw SolverFailure(
        "eigenpairs: the vectors depend on each other; the matrices are too "
        "ill-conditioned, look for degenerate elements");
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(vectors);
  return static_cast<Index>(values.size());
}

/// The `count` pairs after the zero modes.
/// \return number of right-hand sides solved for
Index solve_nonzero(const Pencil& pencil, Index count, Vector& values, Matrix& vectors) {
  const Index n = pencil.size(), subspace = krylov_dimension(count);
  if (n <= kDense || subspace > n - pencil.n_zero() - kSpareDimensions) {
    if (n > kMaxDense)
      throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(n) +
                          " unknowns; above " + std::to_string(kMaxDense) +
                          " unknowns at most about two thirds of the spectrum can be had");
    solve_dense(pencil, count, values, vectors);
    return 0;
  }
  if (static_cast<double>(subspace) * n > kMaxEntries)
    throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(n) +
                        " unknowns take a basis of " + std::to_string(subspace) +
                        " vectors, more than 8 GB; ask for at most " +
                        std::to_string(static_cast<Index>(kMaxEntries / n / 1.5)));
  LargestPairs pairs = largest_pairs(pencil, count);
  values = pairs.values.cwiseInverse();
  vectors = std::move(pairs.vectors);
  return pairs.solves + refine(pencil, values, vectors);
}

/// Turns x so that its first large entry is positive. The bound is no value that symmetric modes
/// take, so that rounding does not decide.
void fix_sign(Vector& x) {
  const double bound = 0.6 * x.lpNorm<Eigen::Infinity>();
  for (const double value : x) {
    if (std::abs(value) < bound) continue;
    if (value < 0) x = -x;
    return;
  }
}

void check_arguments(const SparseMatrix& stiffness, const SparseMatrix& mass,
                     const std::vector<bool>& fixed) {
  if (stiffness.rows() != stiffness.cols() || mass.rows() != stiffness.rows() ||
      mass.cols() != stiffness.cols())
    throw InvalidOption("a stiffness of " + std::to_string(stiffness.rows()) + " by " +
                        std::to_string(stiffness.cols()) + " and a mass of " +
                        std::to_string(mass.rows()) + " by " + std::to_string(mass.cols()) +
                        "; they must be square and of one size");
  if (!fixed.empty() && fixed.size() != static_cast<std::size_t>(stiffness.rows()))
    throw InvalidOption(std::to_string(fixed.size()) + " flags for " +
                        std::to_string(stiffness.rows()) + " rows");
}

std::vector<Index> rows_that_take_part(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                       const std::vector<bool>& fixed) {
  const auto has_entry = [](const SparseMatrix& matrix, Index row) {
    for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
      if (entry.value() != 0) return true;
    return false;
  };
  std::vector<Index> rows;
  for (Index row = 0; row < stiffness.rows(); ++row)
    if ((fixed.empty() || !fixed[row]) && (has_entry(stiffness, row) || has_entry(mass, row)))
      rows.push_back(row);
  return rows;
}

}  // namespace

EigenPairs smallest_eigenpairs(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                               const std::vector<bool>& fixed) {
  check_arguments(stiffness, mass, fixed);
  std::vector<Index> rows = rows_that_take_part(stiffness, mass, fixed);
  if (count < 1 || static_cast<std::size_t>(count) > rows.size())
    throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(rows.size()) +
                        " unknowns; ask for 1 to " + std::to_string(rows.size()));
  Pencil pencil(stiffness, mass, std::move(rows));
  pencil.check_mass();
  pencil.factorise();

  EigenPairs result;
  result.zero_modes = pencil.n_zero();
  result.factor = pencil.factor_info();
  const Index n_zero = std::min(count, pencil.n_zero());
  Vector values;
  Matrix vectors;
  if (count > n_zero) result.solves = solve_nonzero(pencil, count - n_zero, values, vectors);
  result.values = Vector::Zero(count);
  result.values.tail(count - n_zero) = values;
  result.residuals.resize(count);
  result.vectors.setZero(stiffness.rows(), count);
  for (Index k = 0; k < count; ++k) {
    Vector x = k < n_zero ? pencil.zero_mode(k) : Vector(vectors.col(k - n_zero));
    fix_sign(x);
    result.residuals[k] = residual_of(pencil, result.values[k], x);
    for (Index i = 0; i < pencil.size(); ++i) result.vectors(pencil.rows[i], k) = x[i];
  }
  return result;
}

}  // namespace carat
