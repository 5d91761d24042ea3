#pragma once
// The smallest eigenpairs of a symmetric pencil.

#include <cstdint>
#include <vector>

#include "carat/base/types.h"
#include "carat/solve/cholesky.h"

namespace carat {

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
  Index solves = 0;  ///< right-hand sides that were solved for; 0: dense method
  FactorInfo factor;
};

/// The `count` smallest eigenvalues of S x = lambda M x with their vectors.
///
/// S symmetric positive semidefinite, M symmetric positive definite. Rows in which both have no
/// entry take no part. The constants of floating components are known beforehand and taken out of
/// the problem, so that S is inverted where it is definite and no shift has to be chosen. The rest
/// is found by Spectra's restarted Lanczos iteration on S^-1 M, in rounds: when all pairs are
/// there, it starts afresh from a random vector in their complement until nothing below the last
/// pair is left, so that no member of a cluster is missed. The result is the same in every run.
///
/// \param fixed  empty, or one flag a row: rows and columns to leave out (Dirichlet)
/// \throws InvalidOption  count not positive or more than there are rows that take part; so large
///                        a part of a large spectrum that it does not fit in memory; sizes that do
///                        not agree
/// \throws SolverFailure  S is not semidefinite, with a kernel beyond the constants, M is not
///                        definite, values that are not finite, no convergence
/// Cost: one factorisation of S and about 3 or 4 solves a pair, more for few pairs or many equal
/// ones; memory O(nnz of the factor + n * count).
EigenPairs smallest_eigenpairs(const SparseMatrix& stiffness, const SparseMatrix& mass, Index count,
                               const std::vector<bool>& fixed = {});

}  // namespace carat
