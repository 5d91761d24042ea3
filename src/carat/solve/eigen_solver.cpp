#include "carat/solve/eigen_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/base/text.h"
#include "carat/solve/krylov/largest_pairs.h"
#include "carat/solve/krylov/products.h"
#include "carat/solve/spd_solver.h"

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
// Where solving by conjugate gradients becomes faster in volumes.
constexpr Index kIterativeFrom = 80000;
/// Part of the free memory that a factor may take.
constexpr double kMemoryShare = 0.5;
// Vectors of a residual beyond this are worth one more solve.
constexpr double kGoodResidual = 1e-10;
// 1^T S 1 / sum |S_ij| of constants that S annihilates: rounding leaves about 1e-16.
constexpr double kZeroEnergy = 1e-12;

constexpr std::pair<EigenMethod, const char*> kNames[] = {
    {EigenMethod::Auto, "auto"},
    {EigenMethod::Cholesky, "cholesky"},
    {EigenMethod::Iterative, "iterative"},
};

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
  Pencil(const SparseMatrix& stiffness, const SparseMatrix& mass, std::vector<Index> kept,
         int threads)
      : rows(std::move(kept)),
        s(restrict_to(stiffness, rows)),
        m(restrict_to(mass, rows)),
        threads_(threads) {
    find_floating_components();
    ones_ = Vector::Ones(m.cols());
    row_mass_ = m * ones_;
    measure_.assign(floating.size(), 0.0);
    for (Index i = 0; i < size(); ++i)
      if (floating_of_[i] >= 0) measure_[floating_of_[i]] += row_mass_[i];
    all_float_as_one_ =
        n_zero() == 1 && std::count(floating_of_.begin(), floating_of_.end(), 0) == size();
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

  Matrix mass_product(const Eigen::Ref<const Matrix>& x) const override {
    traffic_ +=
        static_cast<double>(sizeof(double) + sizeof(Index)) * static_cast<double>(m.nonZeros());
    return sparse_product(m, x, threads_);
  }

  void project(Matrix& x) const override { take_out_constants(x, row_mass_, ones_); }

  Matrix solve(Matrix b) const override {
    take_out_constants(b, ones_, row_mass_);
    Matrix x;
    if (factor_) {
      x = factor_->solve(b);
      traffic_ += 2.0 * sizeof(double) * static_cast<double>(factor_->info().nonzeros);
    } else {
      SolveReport report;
      x = iteration_->solve(b, &report);
      iterations_ += report.iterations;
      traffic_ += report.traffic;
    }
    project(x);
    return x;
  }

  void factorise(int dimension) {
    const std::vector<bool> held = grounds();
    try {
      factor_ = std::make_unique<Cholesky>(s, held, dimension);
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
  FactorInfo factor_info() const {
    if (factor_) return factor_->info();
    FactorInfo info;
    info.method = iteration_->info().method;
    info.nonzeros = iteration_->info().nonzeros;
    info.factor_seconds = iteration_->info().seconds;
    return info;
  }
  Index iterations() const { return iterations_; }
  double traffic() const { return traffic_; }

  /// Solves by conjugate gradients from now on.
  void prepare_iteration(const EigenOptions& options) {
    SolverOptions wanted{
        .kind = SolverKind::Multigrid, .dimension = options.dimension, .threads = options.threads};
    if (options.sparser) wanted.sparser = [&] { return restrict_to(options.sparser(), rows); };
    // The matrix is a member, and so outlives the solver.
    iteration_ = std::make_unique<SpdSolver>(
        std::shared_ptr<const SparseMatrix>(std::shared_ptr<void>(), &s), grounds(), wanted);
  }

  /// Every floating component is held at one row: right-hand sides in the range of S ask nothing
  /// of it.
  std::vector<bool> grounds() const {
    std::vector<Index> ground(floating.size(), -1);
    const Vector diagonal = s.diagonal();
    for (Index i = 0; i < size(); ++i)
      if (const Index f = floating_of_[i];
          f >= 0 && (ground[f] < 0 || diagonal[i] > diagonal[ground[f]]))
        ground[f] = i;
    std::vector<bool> held(rows.size(), false);
    for (const Index i : ground) held[i] = true;
    return held;
  }

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
  bool all_float_as_one_ = false;
  std::unique_ptr<Cholesky> factor_;
  std::unique_ptr<SpdSolver> iteration_;
  mutable Index iterations_ = 0;
  mutable double traffic_ = 0;
  int threads_;
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
  if (all_float_as_one_) {
    for (auto column : x.colwise()) column -= weights.dot(column) / measure_[0] * along;
    return;
  }
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
  std::vector<Index> bad;
  for (Index k = 0; k < values.size(); ++k)
    if (!(residual_of(pencil, values[k], vectors.col(k)) <= kGoodResidual)) bad.push_back(k);
  if (bad.empty()) return 0;
  constexpr std::size_t kAtOnce = 8;
  for (std::size_t first = 0; first < bad.size(); first += kAtOnce) {
    const std::span<const Index> some(&bad[first], std::min(kAtOnce, bad.size() - first));
    Matrix x(pencil.size(), static_cast<Eigen::Index>(some.size()));
    for (std::size_t k = 0; k < some.size(); ++k)
      x.col(static_cast<Eigen::Index>(k)) = values[some[k]] * vectors.col(some[k]);
    x = pencil.solve(pencil.mass_product(x));
    for (std::size_t k = 0; k < some.size(); ++k)
      vectors.col(some[k]) = x.col(static_cast<Eigen::Index>(k));
  }
  const Matrix gram = vectors.transpose() * pencil.mass_product(vectors);
  const Eigen::LLT<Matrix> factor(gram);
  if (factor.info() != Eigen::Success)
    throw SolverFailure(
        "eigenpairs: the vectors depend on each other; the matrices are too "
        "ill-conditioned, look for degenerate elements");
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(vectors);
  return static_cast<Index>(bad.size());
}

/// Whether a block iteration has room beside so many pairs.
bool fits_iteration(const Pencil& pencil, Index count) {
  return pencil.size() > kDense &&
         krylov_dimension(count) <= pencil.size() - pencil.n_zero() - kSpareDimensions;
}

/// \param basis  how many vectors were held
void count_traffic(const Pencil& pencil, Index basis, EigenPairs& result) {
  result.traffic = pencil.traffic() +
                   static_cast<double>(sizeof(double) + sizeof(Index)) *
                       static_cast<double>(result.factor.nonzeros) +
                   static_cast<double>(sizeof(double)) * pencil.size() * basis;
}

/// The `count` pairs after the zero modes, by the inverse that the pencil has been given.
void solve_by_lanczos(const Pencil& pencil, Index count, const EigenOptions& options,
                      EigenPairs& result, Matrix& vectors) {
  const Index n = pencil.size(), basis = krylov_dimension(count);
  if (static_cast<double>(basis) * n > kMaxEntries)
    throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(n) +
                        " unknowns take " + std::to_string(basis) +
                        " vectors, more than 8 GB; ask for at most " +
                        std::to_string(static_cast<Index>(kMaxEntries / n / basis * count)));
  LargestPairs pairs = largest_pairs(pencil, count, options.progress);
  result.bytes = 8 * (result.factor.nonzeros + std::int64_t{n} * basis);
  result.values = pairs.values.cwiseInverse();
  vectors = std::move(pairs.vectors);
  result.solves = pairs.solves + refine(pencil, result.values, vectors);
  result.iterations = pencil.iterations();
  count_traffic(pencil, basis, result);
}

void solve_by_factorisation(Pencil& pencil, Index count, const EigenOptions& options,
                            EigenPairs& result, Matrix& vectors) {
  pencil.factorise(options.dimension);
  result.method = EigenMethod::Cholesky;
  result.factor = pencil.factor_info();
  if (count == 0) return;
  if (fits_iteration(pencil, count)) {
    solve_by_lanczos(pencil, count, options, result, vectors);
    return;
  }
  if (pencil.size() > kMaxDense)
    throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(pencil.size()) +
                        " unknowns; above " + std::to_string(kMaxDense) +
                        " unknowns at most about half of the spectrum can be had");
  solve_dense(pencil, count, result.values, vectors);
  count_traffic(pencil, pencil.size(), result);
}

void solve_by_iteration(Pencil& pencil, Index count, const EigenOptions& options,
                        EigenPairs& result, Matrix& vectors) {
  pencil.prepare_iteration(options);
  result.method = EigenMethod::Iterative;
  result.factor = pencil.factor_info();
  solve_by_lanczos(pencil, count, options, result, vectors);
}

/// \return whether to iterate without a factorisation; result.reason says why
bool choose_iteration(const Pencil& pencil, Index count, const EigenOptions& options,
                      EigenPairs& result) {
  const Index n = pencil.size();
  const bool room = fits_iteration(pencil, count);
  if (options.method != EigenMethod::Auto || !room) {
    if (options.method != EigenMethod::Cholesky && !room)
      result.reason = std::to_string(count) + " pairs of " + std::to_string(n) +
                      " unknowns leave no room for an iteration";
    return options.method == EigenMethod::Iterative && room;
  }
  const bool volume = options.dimension == 3;
  const double bytes =
      factor_bytes(n, static_cast<double>(pencil.s.nonZeros()), options.dimension) +
      8.0 * n * krylov_dimension(count);
  const double free = static_cast<double>(available_memory());
  const std::string size =
      std::to_string(n) + (volume ? " unknowns of a volume" : " unknowns of a surface");
  if (free > 0 && bytes > kMemoryShare * free) {
    result.reason = "a factor of " + size + " would take about " + gigabytes(bytes) + " of the " +
                    gigabytes(free) + " that are free";
    return true;
  }
  if (volume && n >= kIterativeFrom) {
    result.reason = size + ": a factor costs more than iterations in its place";
    return true;
  }
  result.reason = size + ": a factor of about " + gigabytes(bytes) + " pays";
  return false;
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

const char* eigen_method_name(EigenMethod method) {
  for (const auto& [known, name] : kNames)
    if (known == method) return name;
  return "";
}

EigenMethod eigen_method(const std::string& name) {
  std::string known;
  for (const auto& [method, its_name] : kNames) {
    if (name == its_name) return method;
    known.append(known.empty() ? "" : ", ").append(its_name);
  }
  throw InvalidOption("solver '" + name + "' is not known; known are: " + known);
}

EigenPairs smallest_eigenpairs(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                               const std::vector<bool>& fixed, const EigenOptions& options) {
  check_arguments(stiffness, mass, fixed);
  std::vector<Index> rows = rows_that_take_part(stiffness, mass, fixed);
  if (count < 1 || static_cast<std::size_t>(count) > rows.size())
    throw InvalidOption(std::to_string(count) + " eigenpairs of " + std::to_string(rows.size()) +
                        " unknowns; ask for 1 to " + std::to_string(rows.size()));
  Pencil pencil(stiffness, mass, std::move(rows), options.threads);
  pencil.check_mass();

  EigenPairs result;
  result.zero_modes = pencil.n_zero();
  const Index n_zero = std::min(count, pencil.n_zero()), n_other = count - n_zero;
  Matrix vectors;
  bool found = false;
  if (n_other > 0 && choose_iteration(pencil, n_other, options, result)) try {
      solve_by_iteration(pencil, n_other, options, result, vectors);
      found = true;
    } catch (const SolverFailure& failure) {
      if (options.method != EigenMethod::Auto) throw;
      // The factorisation judges, and names the row.
      result.reason = "no iteration: " + std::string(failure.what());
    }
  if (!found) solve_by_factorisation(pencil, n_other, options, result, vectors);
  const Vector values = std::move(result.values);
  result.values = Vector::Zero(count);
  result.values.tail(n_other) = values;
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
