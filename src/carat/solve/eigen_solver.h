#pragma once
// The smallest eigenpairs of a symmetric pencil.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "carat/base/types.h"
#include "carat/solve/cholesky.h"

namespace carat {

enum class EigenMethod {
  Auto,       ///< chosen by dimension, size and memory
  Cholesky,   ///< block Lanczos on S^-1 M, by a factorisation of S
  Iterative,  ///< the same by conjugate gradients with multigrid in place of the factorisation
};

/// "auto", "cholesky", "iterative".
const char* eigen_method_name(EigenMethod method);
/// \throws InvalidOption  unknown name; the message lists the known ones
EigenMethod eigen_method(const std::string& name);

struct EigenOptions {
  EigenMethod method = EigenMethod::Auto;
  int dimension = 2;  ///< of the mesh: factors of volumes fill much faster
  /// As SolverOptions::sparser: what multigrid is built from. Empty: the stiffness itself.
  std::function<SparseMatrix()> sparser{};
  int threads = 0;  ///< of products with the matrices; 0: all the machine has
  /// Called now and then with the number of pairs that have converged. What it throws ends the
  /// computation and reaches the caller.
  std::function<void(Index converged)> progress{};
};

/// Pairs of S x = lambda M x.
struct EigenPairs {
  Vector values;   ///< ascending; exactly 0 for the constants of floating components
  Matrix vectors;  ///< (n, count), M-orthonormal, 0 in rows that take no part. In each the first
                   ///< entry of at least 0.6 of the largest one's magnitude is positive.
  /// |S x - lambda M x| / (lambda |M x|) of each pair over the rows that take part, Euclidean
  /// norms. For lambda = 0: |S x| / | |S| |x| |, the part of S x's terms that does not cancel.
  Vector residuals;
  /// Components that no fixed row touches and whose constants S annihilates, in all the matrix:
  /// the multiplicity of lambda = 0, of which at most `count` are among the pairs.
  Index zero_modes = 0;
  EigenMethod method = EigenMethod::Cholesky;  ///< what was chosen
  std::string reason;                          ///< why; empty where the caller chose
  Index iterations = 0;                        ///< of conjugate gradients, over all blocks
  /// Right-hand sides that were solved for; 0: dense method.
  Index solves = 0;
  /// Of the factor or multigrid and of all vectors held at a time, without the matrices.
  std::int64_t bytes = 0;
  /// Bytes read and written at least: the factor or multigrid once, what each solve reads, as
  /// SolveReport::traffic, with the mass, and the basis once.
  double traffic = 0;
  FactorInfo factor;  ///< also of the multigrid's levels
};

/// The `count` smallest eigenvalues of S x = lambda M x with their vectors.
///
/// S symmetric positive semidefinite, M symmetric positive definite. Rows in which both have no
/// entry take no part. The constants of floating components are known beforehand and taken out of
/// the problem, so that S is inverted where it is definite and no shift has to be chosen. The rest
/// is found by a block Lanczos iteration on S^-1 M. No member of a cluster is missed: where one has
/// as many members as a block has columns, it starts afresh in the complement of what was found
/// until nothing below the last pair is left. Where Auto chose conjugate gradients and they do not
/// converge, a factorisation takes over. The result is the same in every run.
///
/// \param fixed  empty, or one flag a row: rows and columns to leave out (Dirichlet)
/// \throws InvalidOption  count not positive or more than there are rows that take part; so large
///                        a part of a large spectrum that it does not fit in memory; sizes that do
///                        not agree
/// \throws SolverFailure  S is not semidefinite, with a kernel beyond the constants, M is not
///                        definite, values that are not finite, no convergence
/// Cost: one factorisation or multigrid of S and about 3 to 5 solves a pair, in blocks of 8, more
/// for few pairs or many equal ones; memory O(nnz of the factor + 2 n * count).
EigenPairs smallest_eigenpairs(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                               const std::vector<bool>& fixed = {},
                               const EigenOptions& options = {});

}  // namespace carat
