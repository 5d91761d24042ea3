#include "carat/solve/cholesky.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "carat/base/error.h"
#include "carat/solve/reduction.h"

#ifdef CARAT_WITH_CHOLMOD
#include <cholmod.h>
#else
#include <Eigen/SparseCholesky>
#endif

namespace carat {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string pivot_message(Index row) {
  return "the matrix is not positive definite: the pivot of row (vertex) " + std::to_string(row) +
         " is not positive; look for degenerate elements around it, or for a part of the mesh "
         "without boundary condition";
}

}  // namespace

#ifdef CARAT_WITH_CHOLMOD

struct Cholesky::Impl {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  Reduction reduction;
  std::vector<double> values;
  Index full_nonzeros;
  FactorInfo info;

  Impl(const SparseMatrix& matrix, const std::vector<bool>& fixed)
      : reduction(matrix, fixed), full_nonzeros(static_cast<Index>(matrix.nonZeros())) {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    // LL^T throughout: a non-positive pivot must be an error, not a negative entry of D.
    common.final_ll = 1;
  }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  void gather(const SparseMatrix& matrix) {
    values.resize(reduction.source.size());
    const double* const from = matrix.valuePtr();
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = from[reduction.source[k]];
  }

  cholmod_sparse view() {
    cholmod_sparse a{};
    a.nrow = a.ncol = static_cast<std::size_t>(reduction.size());
    a.nzmax = values.size();
    a.p = reduction.offsets.data();
    a.i = reduction.columns.data();
    a.x = values.data();
    a.stype = 1;  // rows of the lower triangle are columns of the upper
    a.itype = CHOLMOD_INT;
    a.xtype = CHOLMOD_REAL;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = 1;
    a.packed = 1;
    return a;
  }

  void check(const char* what) const {
    if (common.status >= CHOLMOD_OK && common.status != CHOLMOD_NOT_POSDEF) return;
    if (common.status == CHOLMOD_OUT_OF_MEMORY)
      throw SolverFailure(std::string(what) + " of " + std::to_string(reduction.size()) +
                          " unknowns: not enough memory for the factor");
    if (common.status == CHOLMOD_TOO_LARGE)
      throw SolverFailure(std::string(what) + " of " + std::to_string(reduction.size()) +
                          " unknowns: the factor is too large for 32-bit indices");
    if (common.status < CHOLMOD_OK)
      throw SolverFailure(std::string(what) + " failed (CHOLMOD status " +
                          std::to_string(common.status) + ")");
  }

  void analyse() {
    const auto start = Clock::now();
    cholmod_sparse a = view();
    factor = cholmod_analyze(&a, &common);
    check("symbolic analysis");
    info.analyse_seconds = seconds_since(start);
    const int ordering = common.method[common.selected].ordering;
    info.ordering = ordering == CHOLMOD_METIS ? "METIS" : ordering == CHOLMOD_AMD ? "AMD" : "other";
  }

  void factorise() {
    const auto start = Clock::now();
    cholmod_sparse a = view();
    cholmod_factorize(&a, factor, &common);
    check("factorisation");
    if (common.status == CHOLMOD_NOT_POSDEF) {
      const std::size_t column = std::min(factor->minor, factor->n - 1);
      const Index row = reduction.kept[static_cast<const int*>(factor->Perm)[column]];
      throw SolverFailure(pivot_message(row), {row});
    }
    info.factor_seconds = seconds_since(start);
    info.method = factor->is_super ? "CHOLMOD supernodal" : "CHOLMOD simplicial";
    info.nonzeros = static_cast<std::int64_t>(common.lnz);
  }

  void back_solve(Matrix& reduced) const {
    cholmod_common& mutable_common = const_cast<cholmod_common&>(common);
    cholmod_dense b{};
    b.nrow = b.d = static_cast<std::size_t>(reduced.rows());
    b.ncol = static_cast<std::size_t>(reduced.cols());
    b.nzmax = b.nrow * b.ncol;
    b.x = reduced.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &b, &mutable_common);
    check("solution");
    std::copy_n(static_cast<const double*>(x->x), reduced.size(), reduced.data());
    cholmod_free_dense(&x, &mutable_common);
  }
};

#else

struct Cholesky::Impl {
  using Lower = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;
  Eigen::SimplicialLDLT<Lower, Eigen::Upper> factor;  // unlike LL^T it shows the pivots
  Reduction reduction;
  Lower upper;
  Index full_nonzeros;
  FactorInfo info;

  Impl(const SparseMatrix& matrix, const std::vector<bool>& fixed)
      : reduction(matrix, fixed), full_nonzeros(static_cast<Index>(matrix.nonZeros())) {
    upper.resize(reduction.size(), reduction.size());
    upper.resizeNonZeros(static_cast<Eigen::Index>(reduction.columns.size()));
    std::copy(reduction.offsets.begin(), reduction.offsets.end(), upper.outerIndexPtr());
    std::copy(reduction.columns.begin(), reduction.columns.end(), upper.innerIndexPtr());
  }
  void gather(const SparseMatrix& matrix) {
    for (std::size_t k = 0; k < reduction.source.size(); ++k)
      upper.valuePtr()[k] = matrix.valuePtr()[reduction.source[k]];
  }
  void analyse() {
    const auto start = Clock::now();
    factor.analyzePattern(upper);
    info.analyse_seconds = seconds_since(start);
    info.ordering = "AMD";
    info.method = "Eigen simplicial";
  }
  void factorise() {
    const auto start = Clock::now();
    factor.factorize(upper);
    for (Eigen::Index k = 0; k < upper.cols(); ++k)
      if (!(factor.vectorD()[k] > 0)) {
        const Index row = reduction.kept[factor.permutationPinv().indices()[k]];
        throw SolverFailure(pivot_message(row), {row});
      }
    info.factor_seconds = seconds_since(start);
    info.nonzeros = factor.matrixL().nestedExpression().nonZeros();
  }
  void back_solve(Matrix& reduced) const { reduced = factor.solve(reduced).eval(); }
};

#endif

Cholesky::Cholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed) {
  if (matrix.rows() != matrix.cols())
    throw InvalidOption("a matrix of " + std::to_string(matrix.rows()) + " rows and " +
                        std::to_string(matrix.cols()) + " columns is not symmetric");
  if (!fixed.empty() && fixed.size() != static_cast<std::size_t>(matrix.rows()))
    throw InvalidOption(std::to_string(fixed.size()) + " flags for " +
                        std::to_string(matrix.rows()) + " rows");
  impl_ = std::make_unique<Impl>(matrix, fixed);
  if (impl_->reduction.size() == 0) return;
  impl_->gather(matrix);
  impl_->analyse();
  impl_->factorise();
}

Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

void Cholesky::refactor(const SparseMatrix& matrix) {
  if (matrix.rows() != static_cast<Eigen::Index>(impl_->reduction.reduced_of.size()) ||
      matrix.nonZeros() != impl_->full_nonzeros)
    throw InvalidOption("refactor needs a matrix with the pattern of the first one");
  if (impl_->reduction.size() == 0) return;
  impl_->gather(matrix);
  impl_->factorise();
}

Matrix Cholesky::solve(const Matrix& rhs) const {
  const Reduction& reduction = impl_->reduction;
  if (rhs.rows() != static_cast<Eigen::Index>(reduction.reduced_of.size()))
    throw InvalidOption("a right-hand side of " + std::to_string(rhs.rows()) + " rows for " +
                        std::to_string(reduction.reduced_of.size()) + " unknowns");
  Matrix result = Matrix::Zero(rhs.rows(), rhs.cols());
  if (reduction.size() == 0 || rhs.cols() == 0) return result;
  Matrix reduced(reduction.size(), rhs.cols());
  for (Eigen::Index k = 0; k < rhs.cols(); ++k)
    for (Index i = 0; i < reduction.size(); ++i) reduced(i, k) = rhs(reduction.kept[i], k);
  impl_->back_solve(reduced);
  if (!reduced.allFinite())
    throw SolverFailure(
        "the solution is not finite: the right-hand side or the matrix holds "
        "values that are not, or the system is numerically singular");
  for (Eigen::Index k = 0; k < rhs.cols(); ++k)
    for (Index i = 0; i < reduction.size(); ++i) result(reduction.kept[i], k) = reduced(i, k);
  return result;
}

const FactorInfo& Cholesky::info() const { return impl_->info; }

std::vector<Index> matrix_components(const SparseMatrix& matrix) {
  const Index n = static_cast<Index>(matrix.rows());
  std::vector<Index> component(static_cast<std::size_t>(n), -1);
  std::vector<Index> stack;
  Index next = 0;
  for (Index seed = 0; seed < n; ++seed) {
    if (component[seed] >= 0) continue;
    bool empty = true;
    for (SparseMatrix::InnerIterator entry(matrix, seed); entry && empty; ++entry)
      empty = entry.value() == 0;
    if (empty) continue;
    component[seed] = next;
    stack.push_back(seed);
    while (!stack.empty()) {
      const Index row = stack.back();
      stack.pop_back();
      for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
        if (entry.value() != 0 && component[entry.col()] < 0) {
          component[entry.col()] = next;
          stack.push_back(static_cast<Index>(entry.col()));
        }
    }
    ++next;
  }
  return component;
}

SemidefiniteSolver::SemidefiniteSolver(const SparseMatrix& matrix)
    : components_(matrix_components(matrix)) {
  const Index n = static_cast<Index>(matrix.rows());
  for (const Index c : components_) n_components_ = std::max(n_components_, c + 1);
  sizes_.assign(static_cast<std::size_t>(n_components_), 0);
  // Ground the row with the largest diagonal of each component: the best determined one.
  std::vector<Index> ground(static_cast<std::size_t>(n_components_), -1);
  const Vector diagonal = matrix.diagonal();
  for (Index row = 0; row < n; ++row) {
    const Index c = components_[row];
    if (c < 0) continue;
    ++sizes_[c];
    if (ground[c] < 0 || diagonal[row] > diagonal[ground[c]]) ground[c] = row;
  }
  std::vector<bool> fixed(static_cast<std::size_t>(n), false);
  for (Index row = 0; row < n; ++row) fixed[row] = components_[row] < 0;
  for (const Index row : ground) fixed[row] = true;
  solver_ = std::make_unique<Cholesky>(matrix, fixed);
}

Matrix SemidefiniteSolver::solve(Matrix rhs) const {
  const auto remove_means = [&](Matrix& values) {
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      std::vector<double> sum(sizes_.size(), 0.0);
      for (std::size_t row = 0; row < components_.size(); ++row)
        if (components_[row] >= 0) sum[components_[row]] += values(static_cast<Index>(row), k);
      for (std::size_t row = 0; row < components_.size(); ++row) {
        const Index c = components_[row];
        if (c >= 0)
          values(static_cast<Index>(row), k) -= sum[c] / sizes_[c];
        else
          values(static_cast<Index>(row), k) = 0;
      }
    }
  };
  if (rhs.rows() != static_cast<Eigen::Index>(components_.size()))
    throw InvalidOption("a right-hand side of " + std::to_string(rhs.rows()) + " rows for " +
                        std::to_string(components_.size()) + " unknowns");
  remove_means(rhs);
  Matrix result = solver_->solve(rhs);
  remove_means(result);
  return result;
}

double SemidefiniteSolver::imbalance(const Vector& rhs) const {
  std::vector<double> sum(sizes_.size(), 0.0), total(sizes_.size(), 0.0);
  for (std::size_t row = 0; row < components_.size(); ++row)
    if (components_[row] >= 0) {
      sum[components_[row]] += rhs[static_cast<Index>(row)];
      total[components_[row]] += std::abs(rhs[static_cast<Index>(row)]);
    }
  double worst = 0;
  for (std::size_t c = 0; c < sum.size(); ++c)
    if (total[c] > 0) worst = std::max(worst, std::abs(sum[c]) / total[c]);
  return worst;
}

}  // namespace carat
