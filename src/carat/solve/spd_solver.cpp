#include "carat/solve/spd_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "carat/base/error.h"
#include "carat/base/text.h"
#include "carat/solve/incomplete_cholesky.h"
#include "carat/solve/matrix_operator.h"
#include "carat/solve/multigrid.h"

namespace carat {
namespace {

// Where multigrid becomes the faster way, and from how many right-hand sides on a factorisation
// pays all the same (docs/performance.md, Solvers). Smaller systems take milliseconds either way.
constexpr Index kFewOnSurfaces = 10000;
constexpr Index kFewInVolumes = 3000;
constexpr Index kManyOnSurfaces = 8;
constexpr Index kManyInVolumes = 60;
// Where preconditioning through the sparser matrix serves, it takes 10 to 50 iterations. Where it
// is far from the matrix (concave faces, coefficients that jump inside diamonds) it takes hundreds,
// and the matrix itself is the better one to precondition with.
constexpr Index kPatience = 100;
/// What a solution reads of a factor, forwards and backwards, or of a preconditioner: the values.
constexpr double kBytesReadAnEntry = 2 * sizeof(double);
/// Part of the free memory that a factor may take.
constexpr double kMemoryShare = 0.5;

constexpr std::pair<SolverKind, const char*> kNames[] = {
    {SolverKind::Auto, "auto"},
    {SolverKind::Cholesky, "cholesky"},
    {SolverKind::Multigrid, "multigrid"},
    {SolverKind::IncompleteCholesky, "incomplete-cholesky"},
    {SolverKind::SparserCholesky, "sparser-cholesky"},
};

bool are_few(Index n_unknowns, int dimension) {
  return n_unknowns < (dimension == 3 ? kFewInVolumes : kFewOnSurfaces);
}

class FactorPreconditioner final : public Preconditioner {
 public:
  FactorPreconditioner(const SparseMatrix& matrix, const std::vector<bool>& fixed)
      : factor_(matrix, fixed) {}
  void apply(const Vector& r, Vector& z) const override { z = factor_.solve(r); }
  void apply_block(const Vector& r, Vector& z, Index k) const override {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    z.resize(r.size());
    Eigen::Map<Rows>(z.data(), r.size() / k, k) =
        factor_.solve(Eigen::Map<const Rows>(r.data(), r.size() / k, k));
  }
  std::int64_t nonzeros() const override { return factor_.info().nonzeros; }

 private:
  Cholesky factor_;
};

const char* preconditioner_name(SolverKind kind) {
  switch (kind) {
    case SolverKind::Multigrid:
      return "multigrid";
    case SolverKind::IncompleteCholesky:
      return "incomplete Cholesky";
    default:
      return "Cholesky of the sparser matrix";
  }
}

std::unique_ptr<Preconditioner> make_preconditioner(SolverKind kind, const SparseMatrix& matrix,
                                                    const std::vector<bool>& fixed, int threads) {
  switch (kind) {
    case SolverKind::Multigrid:
      return std::make_unique<Multigrid>(matrix, fixed, threads);
    case SolverKind::IncompleteCholesky:
      return std::make_unique<IncompleteCholesky>(matrix, fixed);
    default:
      return std::make_unique<FactorPreconditioner>(matrix, fixed);
  }
}

}  // namespace

std::vector<SolverKind> solver_kinds() {
  std::vector<SolverKind> kinds;
  for (const auto& [kind, name] : kNames) kinds.push_back(kind);
  return kinds;
}

const char* solver_kind_name(SolverKind kind) {
  for (const auto& [known, name] : kNames)
    if (known == kind) return name;
  return "";
}

SolverKind solver_kind(const std::string& name) {
  std::string known;
  for (const auto& [kind, its_name] : kNames) {
    if (name == its_name) return kind;
    known.append(known.empty() ? "" : ", ").append(its_name);
  }
  throw InvalidOption("solver '" + name + "' is not known; known are: " + known);
}

MatrixStorage matrix_storage(const std::string& name) {
  if (name == "full") return MatrixStorage::Full;
  if (name == "triangle") return MatrixStorage::Triangle;
  throw InvalidOption("matrix storage '" + name + "' is not known; known are: full, triangle");
}

double factor_bytes(Index n_unknowns, double nonzeros, int dimension) {
  // Nested dissection fills O(n log n) on surfaces and O(n^(4/3)) in volumes.
  const double n = std::max(2.0, static_cast<double>(n_unknowns));
  const double fill = dimension == 2 ? 40 * n * std::log2(n) : 45 * std::pow(n, 4.0 / 3);
  return fill * std::sqrt(nonzeros / n);
}

bool takes_iteration(const SolverOptions& options, Index n_unknowns) {
  if (options.kind != SolverKind::Auto) return options.kind != SolverKind::Cholesky;
  return !are_few(n_unknowns, options.dimension) &&
         options.right_hand_sides < (options.dimension == 3 ? kManyInVolumes : kManyOnSurfaces);
}

struct SpdSolver::Impl {
  std::shared_ptr<const SymmetricOperator> a;
  std::vector<bool> fixed;
  SolverOptions options;
  SolverInfo info;
  std::vector<Index> fixed_rows;
  mutable std::unique_ptr<Preconditioner> preconditioner;
  mutable bool from_sparser = false;         // the preconditioner
  mutable std::string took_over;             // the method that did, if another than chosen
  mutable std::unique_ptr<Cholesky> direct;  // also what takes over
  double norm = 0;                           // maximum norm over the free rows

  bool is_fixed(Index row) const { return !fixed.empty() && fixed[static_cast<std::size_t>(row)]; }
  Index rows() const { return a->rows(); }

  void choose() {
    info.kind = options.kind;
    if (options.kind != SolverKind::Auto) return;
    const bool volume = options.dimension == 3;
    const Index n = rows() - static_cast<Index>(fixed_rows.size());
    const std::string size =
        std::to_string(n) + (volume ? " unknowns of a volume" : " unknowns of a surface");
    info.kind = SolverKind::Cholesky;
    if (are_few(n, options.dimension)) {
      info.reason = size + " are few";
      return;
    }
    const bool few_sides = takes_iteration(options, n);
    if (!a->assembled() && few_sides) {
      info.kind = SolverKind::Multigrid;
      info.reason = size + " and few right-hand sides: no matrix and no factor of it";
      return;
    }
    const double bytes = factor_bytes(n, static_cast<double>(a->nonzeros()), options.dimension);
    const double free = static_cast<double>(available_memory());
    if (free > 0 && bytes >= kMemoryShare * free) {
      info.kind = SolverKind::Multigrid;
      info.reason = "a factor of " + size + " would take about " + gigabytes(bytes) + " of the " +
                    gigabytes(free) + " that are free";
    } else if (!few_sides) {
      info.reason =
          std::to_string(options.right_hand_sides) + " right-hand sides pay for the factor";
    } else {
      info.kind = SolverKind::Multigrid;
      info.reason = size + " and few right-hand sides: no factor of about " + gigabytes(bytes);
    }
  }

  void factorise() const {
    direct = std::make_unique<Cholesky>(*a->lower_triangle(), fixed, options.dimension);
  }

  void prepare() {
    for (Index row = 0; row < rows(); ++row)
      if (is_fixed(row)) fixed_rows.push_back(row);
    choose();
    const auto start = std::chrono::steady_clock::now();
    if (info.kind != SolverKind::Cholesky) prepare_iteration();
    if (info.kind == SolverKind::Cholesky) {
      factorise();
      info.method = direct->info().method;
      info.ordering = direct->info().ordering;
      info.nonzeros = direct->info().nonzeros;
    }
    info.assembled = a->assembled() || info.kind == SolverKind::Cholesky;
    info.halved = a->halved();
    info.operator_bytes = a->bytes();
    info.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  void prepare_iteration() {
    from_sparser = build_from_sparser();
    if (!from_sparser) try {
        const std::shared_ptr<const SparseMatrix> matrix =
            info.kind == SolverKind::Multigrid ? a->matrix() : a->lower_triangle();
        preconditioner = make_preconditioner(info.kind, *matrix, fixed, options.threads);
        if (!a->assembled()) a = std::make_shared<MatrixOperator>(matrix, options.threads);
      } catch (const SolverFailure& failure) {
        if (options.kind != SolverKind::Auto) throw;
        // The factorisation judges, and names the row.
        info.kind = SolverKind::Cholesky;
        info.reason = "no multigrid: " + std::string(failure.what());
        return;
      }
    info.method = std::string(a->assembled() ? "" : "matrix-free ") + "conjugate gradients" +
                  (a->halved() ? " with one triangle, " : ", ") + preconditioner_name(info.kind);
    if (from_sparser && info.kind != SolverKind::SparserCholesky)
      info.method += " of the sparser matrix";
    info.nonzeros = preconditioner->nonzeros();
    Vector norms = a->row_norms();
    for (const Index row : fixed_rows) norms[row] = 0;
    if (norms.size() > 0) norm = norms.maxCoeff();
  }

  /// \return false: there is no sparser matrix, or it is not definite where the matrix may be
  bool build_from_sparser() {
    if (!options.sparser) return false;
    const SparseMatrix sparser = options.sparser();
    if (sparser.rows() != rows() || sparser.cols() != rows())
      throw InvalidOption("the sparser matrix has " + std::to_string(sparser.rows()) +
                          " rows, the matrix " + std::to_string(rows()));
    try {
      preconditioner = make_preconditioner(info.kind, sparser, fixed, options.threads);
    } catch (const SolverFailure&) {
      return false;
    }
    return true;
  }

  void multiply(const Vector& x, Vector& y) const {
    const Index k = static_cast<Index>(x.size() / std::max(1, rows()));
    a->multiply(x.data(), y.data(), k);
    for (const Index row : fixed_rows) y.segment(Eigen::Index{row} * k, k).setZero();
  }

  Matrix iterate(const Matrix& rhs, const IterationLimits& limits, SolveReport& report) const {
    Matrix b = rhs;
    for (const Index row : fixed_rows) b.row(row).setZero();
    return conjugate_gradients([&](const Vector& x, Vector& y) { multiply(x, y); }, *preconditioner,
                               b, norm, limits, report, options.threads);
  }

  /// As chosen; where that was left to Auto and fails, multigrid of the matrix itself takes over.
  Matrix iterate(const Matrix& rhs, SolveReport& report) const {
    if (options.kind != SolverKind::Auto || !from_sparser) return iterate(rhs, {}, report);
    try {
      return iterate(rhs, {.iterations = kPatience}, report);
    } catch (const SolverFailure&) {
      if (!rhs.allFinite()) throw;
    }
    preconditioner = make_preconditioner(info.kind, *a->matrix(), fixed, options.threads);
    from_sparser = false;
    took_over = "conjugate gradients, multigrid after that of the sparser matrix failed";
    report = {};
    report.method = took_over;
    return iterate(rhs, {}, report);
  }

  Matrix solve(const Matrix& rhs, SolveReport& report) const {
    report.method = took_over.empty() ? info.method : took_over;
    if (!direct) try {
        Matrix result = iterate(rhs, report);
        report.traffic =
            report.passes * (static_cast<double>(a->bytes()) +
                             kBytesReadAnEntry * static_cast<double>(preconditioner->nonzeros()));
        return result;
      } catch (const SolverFailure&) {
        if (options.kind != SolverKind::Auto || !rhs.allFinite()) throw;
        report = {};
        factorise();
      }
    report.method = direct->info().method;
    report.traffic = kBytesReadAnEntry * static_cast<double>(direct->info().nonzeros);
    Matrix result = direct->solve(rhs);
    Vector product(rhs.rows());
    for (Eigen::Index k = 0; k < rhs.cols(); ++k) {
      multiply(result.col(k), product);
      double error = 0, size = 0;
      for (Index row = 0; row < rows(); ++row) {
        if (is_fixed(row)) continue;
        error += std::pow(rhs(row, k) - product[row], 2);
        size += std::pow(rhs(row, k), 2);
      }
      if (size > 0) report.residual = std::max(report.residual, std::sqrt(error / size));
    }
    return result;
  }
};

SpdSolver::SpdSolver(std::shared_ptr<const SymmetricOperator> a, std::vector<bool> fixed,
                     const SolverOptions& options)
    : impl_(std::make_unique<Impl>()) {
  if (!fixed.empty() && fixed.size() != static_cast<std::size_t>(a->rows()))
    throw InvalidOption(std::to_string(fixed.size()) + " flags for " + std::to_string(a->rows()) +
                        " rows");
  impl_->a = std::move(a);
  impl_->fixed = std::move(fixed);
  impl_->options = options;
  impl_->prepare();
  impl_->options.sparser = nullptr;
}

SpdSolver::SpdSolver(std::shared_ptr<const SparseMatrix> matrix, std::vector<bool> fixed,
                     const SolverOptions& options)
    : SpdSolver(
          [&]() -> std::shared_ptr<const SymmetricOperator> {
            if (matrix->rows() != matrix->cols())
              throw InvalidOption("a matrix of " + std::to_string(matrix->rows()) + " rows and " +
                                  std::to_string(matrix->cols()) + " columns is not symmetric");
            return std::make_shared<MatrixOperator>(matrix, options.threads);
          }(),
          std::move(fixed), options) {}

SpdSolver::~SpdSolver() = default;
SpdSolver::SpdSolver(SpdSolver&&) noexcept = default;
SpdSolver& SpdSolver::operator=(SpdSolver&&) noexcept = default;

Matrix SpdSolver::solve(const Matrix& rhs, SolveReport* report) const {
  if (rhs.rows() != impl_->rows())
    throw InvalidOption("a right-hand side of " + std::to_string(rhs.rows()) + " rows for " +
                        std::to_string(impl_->rows()) + " unknowns");
  SolveReport own;
  Matrix result = impl_->solve(rhs, own);
  if (report) *report = own;
  return result;
}

const SolverInfo& SpdSolver::info() const { return impl_->info; }

}  // namespace carat
