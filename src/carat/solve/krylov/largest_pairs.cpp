#include "carat/solve/krylov/largest_pairs.h"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "carat/base/error.h"

namespace carat {
namespace {

// |A x - theta x|_M / theta of a pair that is kept, ...
constexpr double kTolerance = 1e-11;
// ... and of one that only shows that nothing larger is left: from a random vector the larger ones
// would have come first.
constexpr double kRough = 1e-4;
// theta of two members of one cluster agree to this.
constexpr double kSameValue = 1e-10;
// Pairs asked for where some are missing.
constexpr Index kFew = 4;
constexpr Index kMaxRestarts = 100;
// |A x - theta x| / |A x| that rounding makes of an eigenvector x.
constexpr double kNoise = 1e-12;

/// M x for Spectra. Its bounds for what counts as zero are absolute, so that M and A are divided by
/// units in which random vectors have entries, and images as long as they are, about one.
class MassProduct {
 public:
  using Scalar = double;
  MassProduct(const InverseOperator& op, double unit) : op_(op), unit_(unit) {}
  Eigen::Index rows() const { return op_.size(); }
  Eigen::Index cols() const { return op_.size(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Matrix>(out, rows(), 1) =
        op_.mass_product(Eigen::Map<const Vector>(in, rows())) / unit_;
  }

 private:
  const InverseOperator& op_;
  double unit_;
};

class Rounds {
 public:
  Rounds(const InverseOperator& op, Index wanted) : op_(op), wanted_(wanted) {}
  LargestPairs run();

 private:
  class Inverse;
  struct Pairs {
    Vector values;
    Matrix vectors;
  };
  Matrix random_vector();
  void choose_units();
  Pairs iterate(Index count, double tolerance);
  void take_out_found(Matrix& x) const;
  void merge(Pairs more);

  const InverseOperator& op_;
  Index wanted_, solves_ = 0;
  double mass_unit_ = 1, inverse_unit_ = 1;
  Pairs found_;
  std::mt19937_64 random_{20210901};
};

/// unit S^-1 b for Spectra, in the complement of the pairs found.
///
/// Spectra takes the image of the start vector and that one's image, and orthogonalises the second
/// against the first once. Where an eigenvalue stands out or all are the same, their difference is
/// rounding noise. So its first question gets the start vector itself, and the second one a
/// multiple of that if there is nothing else in the image.
class Rounds::Inverse {
 public:
  using Scalar = double;
  Inverse(Rounds& rounds, const Matrix& start) : rounds_(rounds), start_(start) {}
  Eigen::Index rows() const { return rounds_.op_.size(); }
  Eigen::Index cols() const { return rounds_.op_.size(); }
  void set_shift(double) {}
  void perform_op(const double* in, double* out) {
    Eigen::Map<Matrix>(out, rows(), 1) = image(Eigen::Map<const Vector>(in, rows()));
  }

 private:
  Matrix image(const Eigen::Map<const Vector>& b) {
    if (++calls_ == 1) return start_;
    Matrix x = rounds_.op_.solve(b * (rounds_.mass_unit_ / rounds_.inverse_unit_));
    ++rounds_.solves_;
    rounds_.take_out_found(x);
    if (calls_ == 2) {
      const Matrix along = start_ * (b.dot(x.col(0)) / b.dot(start_.col(0)));
      if ((x - along).norm() <= kNoise * x.norm()) return along;
    }
    return x;
  }

  Rounds& rounds_;
  const Matrix& start_;
  int calls_ = 0;
};

Matrix Rounds::random_vector() {
  Matrix x(op_.size(), 1);
  for (double& value : x.reshaped()) value = static_cast<double>(random_() >> 11) * 0x1p-52 - 1;
  op_.project(x);
  return x;
}

void Rounds::choose_units() {
  const auto square = [&](const Matrix& x, const Matrix& mass_x) {
    const double result = x.col(0).dot(mass_x.col(0));
    if (!(result > 0) || !std::isfinite(result))
      throw SolverFailure("eigenpairs: a vector's square by the mass matrix is " +
                          std::to_string(result) +
                          "; the mass must be positive definite and finite");
    return result;
  };
  const Matrix x = random_vector(), mass_x = op_.mass_product(x);
  const double before = square(x, mass_x);
  const Matrix image = op_.solve(mass_x);
  ++solves_;
  mass_unit_ = before / op_.size();
  inverse_unit_ = std::sqrt(square(image, op_.mass_product(image)) / before);
}

/// One round in the complement of the pairs found.
/// \return those that have converged of the `count` pairs, one at least
Rounds::Pairs Rounds::iterate(Index count, double tolerance) {
  Matrix start = random_vector();
  take_out_found(start);
  Inverse inverse(*this, start);
  MassProduct mass(op_, mass_unit_);
  Spectra::SymGEigsShiftSolver<Inverse, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, krylov_dimension(count), 0.0);
  Index converged = 0;
  try {
    solver.init(start.data());
    converged = static_cast<Index>(solver.compute(Spectra::SortRule::LargestAlge, kMaxRestarts,
                                                  tolerance, Spectra::SortRule::SmallestAlge));
  } catch (const Error&) {
    throw;
  } catch (const std::runtime_error&) {
    // The dense iteration inside: as if none had converged.
  }
  if (converged == 0)
    throw SolverFailure("eigenpairs: " + std::to_string(found_.values.size()) + " of " +
                        std::to_string(wanted_) + " converged in " + std::to_string(solves_) +
                        " solves; the matrices are too ill-conditioned, look for degenerate "
                        "elements");
  Pairs pairs{inverse_unit_ * solver.eigenvalues().cwiseInverse(), solver.eigenvectors()};
  pairs.vectors /= std::sqrt(mass_unit_);
  return pairs;
}

void Rounds::take_out_found(Matrix& x) const {
  if (found_.values.size() == 0) return;
  const Matrix along = found_.vectors.transpose() * op_.mass_product(x);
  x.noalias() -= found_.vectors * along;
}

/// Keeps the wanted ones of the pairs found and of those of one more round.
void Rounds::merge(Pairs more) {
  take_out_found(more.vectors);
  const Index before = static_cast<Index>(found_.values.size());
  Vector values(before + more.values.size());
  values << found_.values, more.values;
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return values[a] > values[b]; });
  const Index n_kept = std::min(wanted_, static_cast<Index>(values.size()));
  Pairs kept{Vector(n_kept), Matrix(op_.size(), n_kept)};
  for (Index i = 0; i < n_kept; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    kept.values[i] = values[from];
    kept.vectors.col(i) =
        from < before ? found_.vectors.col(from) : more.vectors.col(from - before);
  }
  found_ = std::move(kept);
}

LargestPairs Rounds::run() {
  choose_units();
  found_ = iterate(wanted_, kTolerance);
  for (;;) {
    const Index n_found = static_cast<Index>(found_.values.size());
    if (n_found < wanted_) {
      merge(iterate(wanted_ - n_found, kTolerance));
      continue;
    }
    const double last = found_.values[wanted_ - 1];
    const double next = iterate(1, kRough).values[0];
    if (next * (1 + kRough) <= last) break;
    // Where the two may be equal, one pair that is exact settles it.
    Pairs more = iterate(next > last * (1 + kRough) ? kFew : 1, kTolerance);
    if (more.values[0] <= last * (1 + kSameValue)) break;
    merge(std::move(more));
  }
  return {std::move(found_.values), std::move(found_.vectors), solves_};
}

}  // namespace

// More vectors make fewer restarts, each of which costs as much as a few solves, and slower steps.
Index krylov_dimension(Index wanted) { return wanted + std::max(wanted / 2, Index{20}); }

LargestPairs largest_pairs(const InverseOperator& op, Index wanted) {
  return Rounds(op, wanted).run();
}

}  // namespace carat
