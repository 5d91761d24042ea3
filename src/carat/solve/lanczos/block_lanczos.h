#pragma once
// Block Lanczos iteration with thick restarts for the largest eigenvalues of an inverse.

#include <random>

#include "carat/base/types.h"

namespace carat {

/// Applies A = S^-1 M, self-adjoint in the inner product of M, where S is definite: in a subspace
/// that A maps into itself, the M-complement of known null vectors of S.
class InverseOperator {
 public:
  virtual ~InverseOperator() = default;
  virtual Index size() const = 0;
  /// M x.
  virtual Matrix mass_product(const Matrix& x) const = 0;
  /// Replaces x by its projection to the subspace.
  virtual void project(Matrix& x) const = 0;
  /// S^-1 b in the subspace. \param b  M x of vectors x in the subspace
  virtual Matrix solve(const Matrix& b) const = 0;
};

/// Largest eigenpairs A x = theta x, complete clusters included.
///
/// A round starts from a random block and expands it into a Krylov space, restarted from its best
/// Ritz vectors when it is full, until no pair that is still moving can come before the last wanted
/// one. What has converged is locked. A block can miss members of an eigenvalue whose multiplicity
/// exceeds its columns; so rounds are repeated in the complement of what is locked until one finds
/// nothing that comes before the last wanted pair.
class BlockLanczos {
 public:
  /// \param wanted  number of pairs; subspace_size(wanted) must not exceed half the dimension
  BlockLanczos(const InverseOperator& op, Index wanted);
  /// Number of basis vectors held.
  static Index subspace_size(Index wanted);

  /// \throws SolverFailure  no convergence, or M is not definite
  void run();

  /// The wanted pairs, theta descending; vectors M-orthonormal.
  double value(Index i) const { return locked_values_[i]; }
  auto vector(Index i) const { return basis_.col(i); }
  Index solves() const { return solves_; }

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
  void lock(Index converged);
  void take_out(Index first, Index end, Block& block, Eigen::Ref<Matrix> coefficients) const;
  Matrix orthonormalise(Block& block, Index n_columns, const Vector& scales);
  void replace_by_random(Block& block, Index column, Index n_columns);
  Vector random_vector();

  const InverseOperator& op_;
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

}  // namespace carat
