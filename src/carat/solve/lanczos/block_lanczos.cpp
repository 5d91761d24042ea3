#include "carat/solve/lanczos/block_lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "carat/base/error.h"

namespace carat {
namespace {

// Columns of a block: a factor is read once for all of them.
constexpr Index kBlock = 8;
// |A x - theta x|_M / theta of a converged pair, and what rounding alone leaves of it beside the
// largest theta.
constexpr double kTolerance = 1e-11;
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
// theta of two members of one cluster agree to this.
constexpr double kSameValue = 1e-10;
// A round's first Ritz pair says that nothing larger is left once it is this accurate: from a
// random block the larger ones would have come first.
constexpr double kVisible = 1e-3;
constexpr int kMaxRestarts = 500;

/// basis.middleCols(first, m.rows()) = basis.middleCols(first, m.rows()) * m, some rows at a time.
void transform_columns(Matrix& basis, Index first, const Matrix& m) {
  constexpr Eigen::Index kRows = 512;
  Matrix rows;
  for (Eigen::Index r = 0; r < basis.rows(); r += kRows) {
    const Eigen::Index n = std::min(kRows, basis.rows() - r);
    rows.noalias() = basis.block(r, first, n, m.rows()) * m;
    basis.block(r, first, n, m.cols()) = rows;
  }
}

}  // namespace

Index BlockLanczos::subspace_size(Index wanted) {
  return std::max(2 * wanted, wanted + 8 * kBlock);
}

BlockLanczos::BlockLanczos(const InverseOperator& op, Index wanted)
    : op_(op), wanted_(wanted), capacity_(subspace_size(wanted)) {
  basis_.resize(op.size(), capacity_);
  projection_.setZero(capacity_, capacity_);
}

void BlockLanczos::run() {
  start_round();
  while (run_round()) start_round();
}

/// \return whether it found a pair that comes before the last wanted one
bool BlockLanczos::run_round() {
  const Index before = locked_;
  const double last = before < wanted_ ? 0 : locked_values_[wanted_ - 1];
  Index next_look = std::max(2 * kBlock, wanted_ - locked_ + kBlock);
  for (int restarts = 0;;) {
    expand();
    const bool full = locked_ + size_ + kBlock > capacity_;
    if (!full && size_ < next_look) continue;
    next_look = size_ + std::max(kBlock, size_ / 8);
    solve_projection();
    const Index converged = n_converged();
    if (settled(converged)) {
      const bool found = converged > 0 && ritz_values_[0] > last * (1 + kSameValue);
      lock(converged);
      return found;
    }
    if (!full) continue;
    if (++restarts > kMaxRestarts)
      throw SolverFailure("eigenpairs: " + std::to_string(before + converged) + " of " +
                          std::to_string(wanted_) + " converged in " + std::to_string(solves_) +
                          " solves; the matrices are too ill-conditioned, look for degenerate "
                          "elements");
    restart();
    next_look = size_ + 2 * kBlock;
  }
}

void BlockLanczos::start_round() {
  Block block;
  block.x.resize(op_.size(), kBlock);
  for (Index c = 0; c < kBlock; ++c) block.x.col(c) = random_vector();
  op_.project(block.x);
  // One application beforehand: the random vectors' rough part would only fill a place.
  next_.x = op_.solve(op_.mass_product(block.x));
  solves_ += kBlock;
  next_.mass_x = op_.mass_product(next_.x);
  const Vector scales = next_.x.cwiseProduct(next_.mass_x).colwise().sum().cwiseSqrt().transpose();
  Matrix unused = Matrix::Zero(locked_, kBlock);
  take_out(0, locked_, next_, unused);
  take_out(0, locked_, next_, unused);
  orthonormalise(next_, locked_, scales);
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
  const auto inner = coefficients.bottomRows(n_columns - locked_);
  projection_.block(0, size_, inner.rows(), kBlock) = inner;
  projection_.block(size_, 0, kBlock, inner.rows()) = inner.transpose();
  const Vector scales = coefficients.colwise().norm().transpose();
  coupling_ = orthonormalise(image, n_columns, scales);
  next_ = std::move(image);
  size_ += kBlock;
  after_restart_ = false;
}

/// Takes the components along the basis vectors [first, end) out of a block, and those outside of
/// the subspace, which rounding would feed from block to block.
void BlockLanczos::take_out(Index first, Index end, Block& block,
                            Eigen::Ref<Matrix> coefficients) const {
  if (first == end) return;
  const auto vectors = basis_.middleCols(first, end - first);
  const Matrix along = vectors.transpose() * block.mass_x;
  block.x.noalias() -= vectors * along;
  op_.project(block.x);
  coefficients.middleRows(first, end - first) += along;
  block.mass_x = op_.mass_product(block.x);
}

/// Gram-Schmidt among the columns of a block that is orthogonal to the first n_columns of the
/// basis. Columns that are rounding noise beside `scales` are replaced by random ones.
/// \return R, upper triangular: the block before = the block after * R
Matrix BlockLanczos::orthonormalise(Block& block, Index n_columns, const Vector& scales) {
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
    if (!(squared > 1e-4 * before) && squared > noise * noise) {
      // Little is left: what it has along the basis must be little beside that, too.
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
  Matrix x = random_vector();
  op_.project(x);
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

Vector BlockLanczos::random_vector() {
  Vector x(op_.size());
  for (double& value : x) value = static_cast<double>(random_() >> 11) * 0x1p-52 - 1;
  return x;
}

void BlockLanczos::solve_projection() {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(projection_.topLeftCorner(size_, size_));
  ritz_values_ = solver.eigenvalues().reverse();
  ritz_vectors_ = solver.eigenvectors().rowwise().reverse();
  ritz_errors_ = (coupling_ * ritz_vectors_.bottomRows(kBlock)).colwise().norm().transpose();
}

/// Number of leading Ritz pairs that have converged.
Index BlockLanczos::n_converged() const {
  const double largest =
      locked_ > 0 ? std::max(locked_values_[0], ritz_values_[0]) : ritz_values_[0];
  Index n = 0;
  while (n < size_ && ritz_errors_[n] <= kTolerance * ritz_values_[n] + kRounding * largest) ++n;
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
void BlockLanczos::restart() {
  const Index room = capacity_ - locked_ - kBlock;
  const Index missing = std::max(Index{0}, wanted_ - locked_);
  const Index kept = std::min(missing + std::max(kBlock, (size_ - missing) / 3), room - kBlock);
  transform_columns(basis_, locked_, ritz_vectors_.leftCols(kept));
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
  transform_columns(basis_, locked_, leading);
  basis_.middleCols(locked_, converged).noalias() += next_.x * beyond;
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

}  // namespace carat
