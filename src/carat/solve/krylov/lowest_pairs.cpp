#include "carat/solve/krylov/lowest_pairs.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/solve/krylov/products.h"

namespace carat {
namespace {

// |S x - lambda M x| / (lambda |M x|) of a converged pair, and of the first one beyond the wanted.
constexpr double kTolerance = 3e-10;
constexpr double kVisible = 1e-2;
// What rounding in the small eigenproblem leaves of a residual, beside the largest of its values
// over the pair's; where that is more than the second, the iteration does not converge.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
constexpr double kMostRounding = 1e-8;
constexpr Index kMaxIterations = 300;
// Part of the inner products' largest eigenvalue below which a direction depends on others.
constexpr double kDependent = 1e-12;
// Products with S and M are computed anew so often, as rounding adds up in their updates.
constexpr Index kRenew = 20;

/// Vectors with their products.
struct Block {
  Matrix x, s_x, m_x;
  Index size() const { return static_cast<Index>(x.cols()); }
};

Block combine(const std::vector<const Block*>& parts, const Matrix& coefficients) {
  const Eigen::Index n = parts.front()->x.rows();
  Block result{Matrix::Zero(n, coefficients.cols()), Matrix::Zero(n, coefficients.cols()),
               Matrix::Zero(n, coefficients.cols())};
  Eigen::Index row = 0;
  for (const Block* const part : parts) {
    const Matrix own = coefficients.middleRows(row, part->size());
    add_product(result.x, 1, part->x, own);
    add_product(result.s_x, 1, part->s_x, own);
    add_product(result.m_x, 1, part->m_x, own);
    row += part->size();
  }
  return result;
}

class Iteration {
 public:
  Iteration(const PreconditionedPencil& pencil, Index wanted) : pencil_(pencil), wanted_(wanted) {}
  LowestPairs run(const std::function<void(Index)>& progress);

 private:
  void start();
  void measure();
  double limit(Index pair) const {
    return std::max(kTolerance, std::min(kMostRounding, kRounding * largest_ / values_[pair]));
  }
  Index n_converged() const;
  void step();
  void orthonormalise(Matrix& w, const std::vector<const Block*>& against) const;
  Block with_products(Matrix x) const;
  [[noreturn]] void give_up(Index converged) const;

  const PreconditionedPencil& pencil_;
  Index wanted_, iterations_ = 0, applications_ = 0;
  Block x_, p_;  // Ritz vectors, and the directions of the last step
  Vector values_, residuals_;
  double largest_ = 0;           // of the small eigenproblem
  std::vector<double> history_;  // of the worst wanted pair
};

Block Iteration::with_products(Matrix x) const {
  Block block{std::move(x), {}, {}};
  block.s_x = pencil_.stiffness_product(block.x);
  block.m_x = pencil_.mass_product(block.x);
  return block;
}

/// Takes the given blocks out of w and makes it M-orthonormal, without directions that depend on
/// others.
void Iteration::orthonormalise(Matrix& w, const std::vector<const Block*>& against) const {
  for (int pass = 0; pass < 2; ++pass) {
    for (const Block* const block : against)
      if (block->size() > 0) add_product(w, -1, block->x, transposed_product(block->m_x, w));
    const Matrix m_w = pencil_.mass_product(w);
    Matrix gram = transposed_product(w, m_w);
    const Vector squares = gram.diagonal();
    if (!gram.allFinite() || !(squares.minCoeff() > 0))
      throw SolverFailure("eigenpairs: a vector's square by the mass matrix is " +
                          std::to_string(squares.minCoeff()) +
                          "; the mass must be positive definite and finite");
    const Vector scale = squares.cwiseSqrt().cwiseInverse();
    gram = scale.asDiagonal() * gram * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(gram);
    const Vector& values = solver.eigenvalues();
    const double least = kDependent * values[values.size() - 1];
    Eigen::Index first = 0;
    while (values[first] <= least) ++first;
    const Eigen::Index kept = values.size() - first;
    const Matrix to_orthonormal = scale.asDiagonal() * solver.eigenvectors().rightCols(kept) *
                                  values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
    transform_columns(w, to_orthonormal);
    w.conservativeResize(Eigen::NoChange, kept);
  }
}

void Iteration::start() {
  std::mt19937_64 random(20210901);
  Matrix x(pencil_.size(), block_size(wanted_));
  for (double& value : x.reshaped()) value = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
  // The random vectors' rough part would only have to be taken out again.
  x = pencil_.precondition(pencil_.mass_product(x));
  applications_ += static_cast<Index>(x.cols());
  orthonormalise(x, {});
  const Block block = with_products(std::move(x));
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(transposed_product(block.x, block.s_x));
  values_ = solver.eigenvalues();
  x_ = combine({&block}, solver.eigenvectors());
  p_.x.resize(pencil_.size(), 0);
}

void Iteration::measure() {
  residuals_.resize(x_.size());
  for (Index k = 0; k < x_.size(); ++k)
    residuals_[k] = (x_.s_x.col(k) - values_[k] * x_.m_x.col(k)).norm() /
                    (std::abs(values_[k]) * x_.m_x.col(k).norm());
  history_.push_back(residuals_.head(wanted_).maxCoeff());
}

Index Iteration::n_converged() const {
  Index n = 0;
  while (n < wanted_ && residuals_[n] <= limit(n)) ++n;
  return n;
}

void Iteration::step() {
  std::vector<Index> active;
  for (Index k = 0; k < x_.size(); ++k)
    if (residuals_[k] > (k < wanted_ ? limit(k) : kVisible / 10)) active.push_back(k);
  const Index n_active = static_cast<Index>(active.size()), m = x_.size();
  Matrix w(pencil_.size(), n_active);
  for (Index k = 0; k < n_active; ++k)
    w.col(k) = x_.s_x.col(active[k]) - values_[active[k]] * x_.m_x.col(active[k]);
  w = pencil_.precondition(w);
  applications_ += n_active;
  orthonormalise(w, {&x_, &p_});
  const Block directions = with_products(std::move(w));

  const std::vector<const Block*> parts{&x_, &p_, &directions};
  const Index size = m + p_.size() + directions.size();
  Matrix projection = Matrix::Zero(size, size);
  Index row = 0;
  for (const Block* const a : parts) {
    Index column = 0;
    for (const Block* const b : parts) {
      if (column <= row && a->size() > 0 && b->size() > 0)
        projection.block(row, column, a->size(), b->size()) = transposed_product(a->x, b->s_x);
      column += b->size();
    }
    row += a->size();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(projection);  // reads the lower triangle
  values_ = solver.eigenvalues().head(m);
  largest_ = solver.eigenvalues()[size - 1];
  const Matrix next = solver.eigenvectors().leftCols(m);
  // The steps of the active vectors, orthonormal among each other and to the vectors reached.
  Matrix steps(size, n_active);
  for (Index k = 0; k < n_active; ++k) steps.col(k) = next.col(active[k]);
  steps.topRows(m).setZero();
  steps -= next * (next.transpose() * steps).eval();
  steps -= next * (next.transpose() * steps).eval();
  const Eigen::ColPivHouseholderQR<Matrix> qr(steps);
  const Index rank = static_cast<Index>(qr.rank());
  steps = qr.householderQ() * Matrix::Identity(size, rank);
  Block x = combine(parts, next);
  p_ = combine(parts, steps);
  x_ = std::move(x);
}

void Iteration::give_up(Index converged) const {
  std::string course;
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t at = (history_.size() - 1) * k / 5;
    char text[48];
    std::snprintf(text, sizeof text, "%s%.1e (%zu)", k > 0 ? ", " : "", history_[at], at);
    course += text;
  }
  throw SolverFailure("eigenpairs: " + std::to_string(converged) + " of " +
                      std::to_string(wanted_) + " converged in " + std::to_string(iterations_) +
                      " iterations; try a factorisation, or look for degenerate elements. Worst "
                      "residuals by iteration: " +
                      course);
}

LowestPairs Iteration::run(const std::function<void(Index)>& progress) {
  start();
  for (;; ++iterations_) {
    if (iterations_ % kRenew == kRenew - 1) x_ = with_products(std::move(x_.x));
    measure();
    const Index converged = n_converged();
    if (progress) progress(converged);
    if (converged == wanted_ && residuals_[wanted_] <= kVisible) break;
    if (iterations_ == kMaxIterations) give_up(converged);
    step();
  }
  x_.x.conservativeResize(Eigen::NoChange, wanted_);
  return {values_.head(wanted_), std::move(x_.x), iterations_, applications_};
}

}  // namespace

// The last pairs of a block converge slowly, as others follow closely.
Index block_size(Index wanted) { return wanted + std::max(Index{8}, wanted / 6); }

LowestPairs lowest_pairs(const PreconditionedPencil& pencil, Index wanted,
                         const std::function<void(Index)>& progress) {
  return Iteration(pencil, wanted).run(progress);
}

}  // namespace carat
