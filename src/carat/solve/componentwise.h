#pragma once
// Solutions of which also the tiniest components are accurate.

#include <vector>

#include "carat/solve/conjugate_gradients.h"

namespace carat {

/// Solves A x = b for symmetric positive definite A by conjugate gradients until every component
/// is accurate, however small beside the largest: |b - A x|_i <= 1e-10 (|A| |x| + |b|)_i in every
/// row [Oettli, Prager 1964], but for components below 1e-290. A unit that is another multiplies A
/// and b and changes nothing.
///
/// For well conditioned A whose solutions decay, like M + t S with t = h^2. A bound on the norm of
/// the residual would say nothing of what is far from the source. A value advances by one entry an
/// iteration, so that it takes as many as edges lie between the farthest vertices, and some more.
/// The diagonal is all that it is preconditioned with: whatever acts across the mesh would round
/// small components in units of large ones.
///
/// \param fixed  empty, or one flag a row: rows and columns to leave out
/// \param b      (n, k); fixed rows are ignored. Results do not depend on the other columns.
/// \param threads  no result depends on it; 0: all the machine has
/// \return (n, k); zero in fixed rows
/// \throws SolverFailure  not within 5000 iterations; A is not positive definite, or not finite
Matrix solve_componentwise(const SparseMatrix& a, const std::vector<bool>& fixed, const Matrix& b,
                           int threads, SolveReport& report);

}  // namespace carat
