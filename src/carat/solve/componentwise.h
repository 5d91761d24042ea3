#pragma once
// Solutions of which also the tiniest components are accurate.

#include <vector>

#include "carat/solve/conjugate_gradients.h"

namespace carat {

/// What the iteration over one process and that over several have in common. Of matrices and
/// right-hand sides in a unit in which the smallest diagonal entry is near 1.
namespace componentwise {

constexpr double kTolerance = 1e-10;
constexpr Index kIterations = 5000;
constexpr Index kCheckEvery = 10;
/// Components that a row sums up to less than this are lost in the range of double precision.
constexpr double kVanished = 1e-290;
/// Residual and direction are scaled up where the squares of their entries become this small, by a
/// power of two that rounds nothing: their entries span twice the range of their squares.
constexpr double kSmallEnergy = 1e-200;
constexpr int kRescaling = 300;

}  // namespace componentwise

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
