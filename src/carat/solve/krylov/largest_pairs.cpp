#include "carat/solve/krylov/largest_pairs.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/base/interrupt.h"
#include "carat/solve/krylov/products.h"

namespace carat {
namespace {

// Columns of a block: a factor is read once for all of them, which takes a quarter of the time.
constexpr Index kBlock = 8;
// |A x - theta x|_M / theta of a converged pair.
constexpr double kTolerance = 1e-11;
// What rounding leaves of a vector of which nothing is left.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
// theta of two members of one cluster agree to this.
constexpr double kSameValue = 1e-10;
// Members of a cluster are so close that a Krylov space of a few steps does not tell them apart.
constexpr double kCluster = 1e-3;
// A round's first Ritz pair says that nothing larger is left once it is this accurate: from a
// random block the larger ones would have come first.
constexpr double kVisible = 1e-3;
// Rounding of one value is this part of another one, which has to be accurate to kTolerance.
constexpr double kOutlier = 1e-5;
constexpr int kMaxRestarts = 200;
// Squares of a block's columns, each beside what they have along the columns before it: below the
// first the basis is taken out once more, below the second columns are dealt with one by one.
constexpr double kLittleLeft = 1e-4;
constexpr double kDependent = 1e-11;

class BlockLanczos {
 public:
  BlockLanczos(const InverseOperator& op, Index wanted, const std::function<void(Index)>& progress)
      : op_(op), progress_(progress), wanted_(wanted), capacity_(krylov_dimension(wanted)) {
    basis_.resize(op.size(), capacity_);
    projection_.setZero(capacity_, capacity_);
  }
  LargestPairs run();

 private:
  /// A block, and its product with M.
  struct Block {
    Matrix x, mass_x;
  };
  void start_round();
  bool run_round();
  void expand();
  void restart();
  void solve_projection();
  Index n_converged() const;
  bool settled(Index converged) const;
  bool may_miss_members() const;
  void lock(Index converged);
  void take_out(Index first, Index end, Block& block, Matrix& coefficients) const;
  Matrix orthonormalise(Block& block, Index n_columns, const Vector& scales, Matrix& coefficients);
  Matrix orthonormalise_by_columns(Block& block, Index n_columns, const Vector& scales);
  void replace_by_random(Block& block, Index column, Index n_columns);
  void fill_randomly(Matrix& x);

  const InverseOperator& op_;
  const std::function<void(Index)>& progress_;
  Index wanted_, capacity_;
  Index locked_ = 0, size_ = 0, solves_ = 0;
  Matrix basis_;       // (n, capacity): locked vectors, then those of the Krylov space V
  Matrix projection_;  // V^T M A V
  Block next_;         // A V = V projection + next coupling (last block)^T
  Matrix coupling_;    // upper triangular
  bool after_restart_ = false;
  Vector locked_values_, ritz_values_, ritz_errors_;  // errors: |A x - theta x|_M
  Matrix ritz_vectors_;                               // over V
  std::mt19937_64 random_{20210901};
};

LargestPairs BlockLanczos::run() {
  do start_round();
  while (run_round());
  basis_.conservativeResize(Eigen::NoChange, wanted_);
  return {locked_values_.head(wanted_), std::move(basis_), solves_};
}

/// \return whether there may be more pairs that come before the last wanted one
bool BlockLanczos::run_round() {
  const Index before = locked_;
  const double last = before < wanted_ ? 0 : locked_values_[wanted_ - 1];
  Index next_look = std::max(2 * kBlock, wanted_ - locked_ + kBlock);
  for (int restarts = 0;;) {
    throw_if_interrupted();
    expand();
    const bool full = locked_ + size_ + kBlock > capacity_;
    if (!full && size_ < next_look) continue;
    next_look = size_ + std::max(kBlock, size_ / 8);
    solve_projection();
    const Index converged = n_converged();
    if (progress_) progress_(std::min(wanted_, locked_ + converged));
    if (settled(converged)) {
      const bool found =
          locked_ > before || (converged > 0 && ritz_values_[0] > last * (1 + kSameValue));
      lock(converged);
      return found && (before > 0 || may_miss_members());
    }
    if (!full) continue;
    if (++restarts > kMaxRestarts)
      throw SolverFailure("eigenpairs: " + std::to_string(locked_ + converged) + " of " +
                          std::to_string(wanted_) + " converged in " + std::to_string(solves_) +
                          " solves; the matrices are too ill-conditioned, look for degenerate "
                          "elements");
    restart();
    next_look = size_ + 2 * kBlock;
  }
}

/// Whether a cluster has so many members that a block need not show them all.
bool BlockLanczos::may_miss_members() const {
  for (Index first = 0; first + kBlock <= wanted_; ++first)
    if (locked_values_[first + kBlock - 1] > (1 - kCluster) * locked_values_[first]) return true;
  return false;
}

void BlockLanczos::start_round() {
  next_.x.resize(op_.size(), kBlock);
  fill_randomly(next_.x);
  // One application beforehand: the random vectors' rough part would only fill a place.
  next_.x = op_.solve(op_.mass_product(next_.x));
  solves_ += kBlock;
  next_.mass_x = op_.mass_product(next_.x);
  const Vector scales = next_.x.cwiseProduct(next_.mass_x).colwise().sum().cwiseSqrt().transpose();
  Matrix unused = Matrix::Zero(locked_, kBlock);
  take_out(0, locked_, next_, unused);
  take_out(0, locked_, next_, unused);
  orthonormalise(next_, locked_, scales, unused);
  size_ = 0;
  after_restart_ = false;
}

void BlockLanczos::expand() {
  const Index n_before = locked_ + size_, n_columns = n_before + kBlock;
  basis_.middleCols(n_before, kBlock) = next_.x;
  Block image{op_.solve(next_.mass_x), {}};
  solves_ += kBlock;
  image.mass_x = op_.mass_product(image.x);
  // By symmetry the image reaches no further back than one block, except to the vectors kept in a
  // restart. The second pass takes out what rounding left of the others.
  const Index reach = after_restart_ ? locked_ : std::max(locked_, n_before - kBlock);
  Matrix coefficients = Matrix::Zero(n_columns, kBlock);
  take_out(reach, n_columns, image, coefficients);
  take_out(0, n_columns, image, coefficients);
  const Vector scales = coefficients.colwise().norm().transpose();
  coupling_ = orthonormalise(image, n_columns, scales, coefficients);
  const auto inner = coefficients.bottomRows(n_columns - locked_);
  projection_.block(0, size_, inner.rows(), kBlock) = inner;
  projection_.block(size_, 0, kBlock, inner.rows()) = inner.transpose();
  next_ = std::move(image);
  size_ += kBlock;
  after_restart_ = false;
}

/// Takes the components along the basis vectors [first, end) out of a block.
void BlockLanczos::take_out(Index first, Index end, Block& block, Matrix& coefficients) const {
  if (first == end) return;
  const auto vectors = basis_.middleCols(first, end - first);
  const Matrix along = transposed_product(vectors, block.mass_x);
  add_product(block.x, -1, vectors, along);
  coefficients.middleRows(first, end - first) += along;
  block.mass_x = op_.mass_product(block.x);
}

/// Makes the columns of a block, which is orthogonal to the first n_columns of the basis,
/// orthonormal by Cholesky factors of their inner products: twice, as one leaves the square of
/// their condition. What that takes out along the basis is added to the coefficients.
/// \param scales  what the columns were before they were made orthogonal to the basis
/// \return R, upper triangular: the block before = the block after * R
Matrix BlockLanczos::orthonormalise(Block& block, Index n_columns, const Vector& scales,
                                    Matrix& coefficients) {
  Matrix r = Matrix::Identity(kBlock, kBlock);
  for (int pass = 0; pass < 2; ++pass) {
    Matrix gram = transposed_product(block.x, block.mass_x);
    const Vector squares = gram.diagonal();
    for (Index c = 0; c < kBlock && pass == 0; ++c)
      if (!(squares[c] > std::pow(kRounding * scales[c], 2)) || !std::isfinite(squares[c]))
        return orthonormalise_by_columns(block, n_columns, scales);
    const Vector lengths = squares.cwiseSqrt(), inverse = lengths.cwiseInverse();
    gram = inverse.asDiagonal() * gram * inverse.asDiagonal();
    const Eigen::LLT<Matrix> factor(gram);
    const double least = factor.matrixLLT().diagonal().array().square().minCoeff();
    if (factor.info() != Eigen::Success || !(least > kDependent))
      return orthonormalise_by_columns(block, n_columns, scales) * r;
    const Matrix upper = factor.matrixU();
    const Matrix to_orthonormal = inverse.asDiagonal() * upper.triangularView<Eigen::Upper>().solve(
                                                             Matrix::Identity(kBlock, kBlock));
    transform_columns(block.x, to_orthonormal);
    transform_columns(block.mass_x, to_orthonormal);
    r = upper * lengths.asDiagonal() * r;
    if (pass == 0 && least < kLittleLeft) {
      block.mass_x = op_.mass_product(block.x);
      Matrix along = Matrix::Zero(n_columns, kBlock);
      take_out(0, n_columns, block, along);
      coefficients += along * r;
    }
  }
  return r;
}

/// The same by Gram-Schmidt. Columns that are rounding noise beside `scales` are replaced by random
/// ones.
Matrix BlockLanczos::orthonormalise_by_columns(Block& block, Index n_columns,
                                               const Vector& scales) {
  Matrix r = Matrix::Zero(kBlock, kBlock);
  for (Index c = 0; c < kBlock; ++c) {
    auto x = block.x.col(c), mass_x = block.mass_x.col(c);
    const double before = x.dot(mass_x);
    for (int pass = 0; pass < 2; ++pass)
      for (Index i = 0; i < c; ++i) {
        const double along = block.x.col(i).dot(mass_x);
        x -= along * block.x.col(i);
        mass_x -= along * block.mass_x.col(i);
        r(i, c) += along;
      }
    double squared = x.dot(mass_x);
    const double noise = kRounding * scales[c];
    if (!(squared > kLittleLeft * before) && squared > noise * noise) {
      // What it has along the basis must be little beside that, too.
      const Vector along = basis_.leftCols(n_columns).transpose() * mass_x;
      x -= basis_.leftCols(n_columns) * along;
      mass_x = op_.mass_product(x);
      squared = x.dot(mass_x);
    }
    if (!std::isfinite(squared) || (squared < -noise * noise))
      throw SolverFailure("eigenpairs: a vector's square by the mass matrix is " +
                          std::to_string(squared) +
                          "; the mass must be positive definite and finite");
    if (squared > noise * noise) {
      r(c, c) = std::sqrt(squared);
      x /= r(c, c);
      mass_x /= r(c, c);
    } else {
      replace_by_random(block, c, n_columns);
    }
  }
  return r;
}

void BlockLanczos::replace_by_random(Block& block, Index column, Index n_columns) {
  Matrix x(op_.size(), 1);
  fill_randomly(x);
  x = op_.solve(op_.mass_product(x));
  ++solves_;
  for (int pass = 0; pass < 2; ++pass) {
    const Vector mass_x = op_.mass_product(x);
    const Vector along = basis_.leftCols(n_columns).transpose() * mass_x;
    const Vector within = block.x.leftCols(column).transpose() * mass_x;
    x -= basis_.leftCols(n_columns) * along + block.x.leftCols(column) * within;
    x /= std::sqrt(x.col(0).dot(op_.mass_product(x).col(0)));
  }
  block.x.col(column) = x;
  block.mass_x.col(column) = op_.mass_product(x);
}

void BlockLanczos::fill_randomly(Matrix& x) {
  for (double& value : x.reshaped()) value = static_cast<double>(random_() >> 11) * 0x1p-52 - 1;
  op_.project(x);
}

void BlockLanczos::solve_projection() {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(projection_.topLeftCorner(size_, size_));
  ritz_values_ = solver.eigenvalues().reverse();
  ritz_vectors_ = solver.eigenvectors().rowwise().reverse();
  ritz_errors_ = (coupling_ * ritz_vectors_.bottomRows(kBlock)).colwise().norm().transpose();
}

/// Number of leading Ritz pairs that have converged.
Index BlockLanczos::n_converged() const {
  Index n = 0;
  while (n < size_ && ritz_errors_[n] <= kTolerance * ritz_values_[n]) ++n;
  return n;
}

/// Whether the first pair that has not converged comes after the last wanted one.
bool BlockLanczos::settled(Index converged) const {
  if (locked_ + converged < wanted_) return false;
  if (converged == size_) return true;
  std::vector<double> values(locked_values_.data(), locked_values_.data() + locked_);
  values.insert(values.end(), ritz_values_.data(), ritz_values_.data() + converged);
  std::nth_element(values.begin(), values.begin() + (wanted_ - 1), values.end(), std::greater<>());
  const double last = values[static_cast<std::size_t>(wanted_ - 1)];
  return ritz_values_[converged] + ritz_errors_[converged] <= last * (1 + kSameValue) &&
         (converged > 0 || ritz_errors_[0] <= kVisible * ritz_values_[0]);
}

/// Keeps about half of what is beyond the wanted pairs: enough to converge fast, and room to grow.
/// Where values stand out so far that the others drown in their rounding, only those are kept, and
/// what is left starts afresh.
void BlockLanczos::restart() {
  const Index converged = n_converged();
  Index outliers = 0;
  while (outliers < converged && ritz_values_[outliers] * kOutlier > ritz_values_[converged])
    ++outliers;
  if (outliers > 0) {
    lock(outliers);
    start_round();
    return;
  }
  const Index room = capacity_ - locked_ - kBlock;
  const Index missing = std::max(Index{0}, wanted_ - locked_);
  const Index kept = std::min(missing + std::max(kBlock, (size_ - missing) / 3), room - kBlock);
  transform_columns(basis_.middleCols(locked_, size_), ritz_vectors_.leftCols(kept));
  projection_.setZero();
  projection_.diagonal().head(kept) = ritz_values_.head(kept);
  size_ = kept;
  after_restart_ = true;
}

/// Takes converged pairs over, in order, at most a block beyond the wanted ones. Each is replaced
/// by A x / theta, which takes the rough part out of its error and costs no solve: A V is known.
void BlockLanczos::lock(Index converged) {
  const auto leading = ritz_vectors_.leftCols(converged);
  const Matrix beyond = coupling_ * leading.bottomRows(kBlock) *
                        ritz_values_.head(converged).cwiseInverse().asDiagonal();
  transform_columns(basis_.middleCols(locked_, size_), leading);
  add_product(basis_.middleCols(locked_, converged), 1, next_.x, beyond);
  const Index n = locked_ + converged;
  Vector values(n);
  values << locked_values_.head(locked_), ritz_values_.head(converged);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return values[a] > values[b]; });
  order.resize(static_cast<std::size_t>(std::min(n, wanted_ + kBlock)));
  if (locked_ > 0 && converged > 0) {
    const Matrix copy = basis_.middleCols(locked_, converged);
    // Backwards: a locked vector only moves to the right, onto one that has moved already.
    for (Index to = static_cast<Index>(order.size()) - 1; to >= 0; --to) {
      const Index from = order[static_cast<std::size_t>(to)];
      if (from >= locked_)
        basis_.col(to) = copy.col(from - locked_);
      else if (from != to)
        basis_.col(to) = basis_.col(from);
    }
  }
  locked_ = static_cast<Index>(order.size());
  locked_values_.resize(locked_);
  for (Index i = 0; i < locked_; ++i)
    locked_values_[i] = values[order[static_cast<std::size_t>(i)]];
  size_ = 0;
}

}  // namespace

// Room for the steps that a block takes where few pairs are wanted.
Index krylov_dimension(Index wanted) { return 2 * wanted + 8 * kBlock; }

LargestPairs largest_pairs(const InverseOperator& op, Index wanted,
                           const std::function<void(Index)>& progress) {
  return BlockLanczos(op, wanted, progress).run();
}

}  // namespace carat
