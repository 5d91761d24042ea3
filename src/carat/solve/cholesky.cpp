#include "carat/solve/cholesky.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "carat/base/error.h"
#include "carat/base/interrupt.h"
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

  void check(const char* what) const { check(what, common); }
  void check(const char* what, const cholmod_common& state) const {
    if (state.status >= CHOLMOD_OK && state.status != CHOLMOD_NOT_POSDEF) return;
    if (state.status == CHOLMOD_OUT_OF_MEMORY)
      throw SolverFailure(std::string(what) + " of " + std::to_string(reduction.size()) +
                          " unknowns: not enough memory for the factor");
    if (state.status == CHOLMOD_TOO_LARGE)
      throw SolverFailure(std::string(what) + " of " + std::to_string(reduction.size()) +
                          " unknowns: the factor is too large for 32-bit indices");
    if (state.status < CHOLMOD_OK)
      throw SolverFailure(std::string(what) + " failed (CHOLMOD status " +
                          std::to_string(state.status) + ")");
  }

  /// On surfaces METIS takes as long as the factorisation that it saves a quarter of; in volumes
  /// that has twice to four times fewer operations with it than with AMD (docs/performance.md).
  void analyse(int dimension) {
    const auto start = Clock::now();
    cholmod_sparse a = view();
    if (dimension == 2 || dimension == 3) {
      common.nmethods = 1;
      common.method[0].ordering = dimension == 2 ? CHOLMOD_AMD : CHOLMOD_METIS;
      factor = cholmod_analyze(&a, &common);
      // Builds of CHOLMOD without METIS.
      common.nmethods = 0;
    }
    if (factor == nullptr) factor = cholmod_analyze(&a, &common);
    check("symbolic analysis");
    info.analyse_seconds = seconds_since(start);
    const int ordering = common.method[common.selected].ordering;
    info.ordering = ordering == CHOLMOD_METIS ? "METIS" : ordering == CHOLMOD_AMD ? "AMD" : "other";
  }

  void factorise() {
    throw_if_interrupted();
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
    // One of its own, so that several threads can solve at once.
    struct Common : cholmod_common {
      Common() {
        cholmod_start(this);
        print = 0;
        error_handler = nullptr;
      }
      ~Common() { cholmod_finish(this); }
    } own;
    cholmod_dense b{};
    b.nrow = b.d = static_cast<std::size_t>(reduced.rows());
    b.ncol = static_cast<std::size_t>(reduced.cols());
    b.nzmax = b.nrow * b.ncol;
    b.x = reduced.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &b, &own);
    check("solution", own);
    std::copy_n(static_cast<const double*>(x->x), reduced.size(), reduced.data());
    cholmod_free_dense(&x, &own);
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
  void analyse(int /*dimension*/) {
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

Cholesky::Cholesky(const SparseMatrix& matrix, const std::vector<bool>& fixed, int dimension) {
  if (matrix.rows() != matrix.cols())
    throw InvalidOption("a matrix of " + std::to_string(matrix.rows()) + " rows and " +
                        std::to_string(matrix.cols()) + " columns is not symmetric");
  if (!fixed.empty() && fixed.size() != static_cast<std::size_t>(matrix.rows()))
    throw InvalidOption(std::to_string(fixed.size()) + " flags for " +
                        std::to_string(matrix.rows()) + " rows");
  impl_ = std::make_unique<Impl>(matrix, fixed);
  if (impl_->reduction.size() == 0) return;
  impl_->gather(matrix);
  impl_->analyse(dimension);
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
  // Trees of rows whose roots are their first rows; -1: no entry yet.
  std::vector<Index> parent(static_cast<std::size_t>(n), -1);
  const auto root = [&](Index row) {
    if (parent[row] < 0) parent[row] = row;
    while (parent[row] != row) row = parent[row] = parent[parent[row]];
    return row;
  };
  for (Index row = 0; row < n; ++row)
    for (SparseMatrix::InnerIterator entry(matrix, row); entry && entry.col() <= row; ++entry) {
      if (entry.value() == 0) continue;
      const auto [first, last] = std::minmax({root(row), root(static_cast<Index>(entry.col()))});
      parent[last] = first;
    }
  // Roots come before their rows.
  std::vector<Index> component(static_cast<std::size_t>(n), -1);
  Index next = 0;
  for (Index row = 0; row < n; ++row)
    if (parent[row] >= 0) component[row] = parent[row] == row ? next++ : component[parent[row]];
  return component;
}

}  // namespace carat
