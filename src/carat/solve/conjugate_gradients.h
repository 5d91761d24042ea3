#pragma once
// Preconditioned conjugate gradients.

#include <functional>
#include <string>
#include <vector>

#include "carat/solve/preconditioner.h"

namespace carat {

/// How a linear system was solved.
struct SolveReport {
  std::string method;    ///< as SolverInfo::method; the factorisation's where it had to take over
  Index iterations = 0;  ///< of the worst right-hand side; 0: a factorisation
  double residual = 0;   ///< |b - A x| / |b|, computed anew from the solution, the worst one
  /// Iterations of all groups of right-hand sides that advance together: so often the matrix and
  /// the preconditioner were read.
  Index passes = 0;
  /// Bytes read at least: in every pass the operator and 16 an entry of the preconditioner, of
  /// which multigrid goes down and up; of a factor 16 an entry, once for all right-hand sides.
  double traffic = 0;
};

/// One iteration's limits.
struct IterationLimits {
  double tolerance = 1e-12;  ///< of |b|, for the residual of the recursion
  double accepted = 1e-10;   ///< of |b|, for the residual computed anew, beside rounding
  Index iterations = 500;
};

/// Solves A x = b for symmetric positive definite A and k right-hand sides. Every one has its own
/// iteration; they advance together, so that the matrix and the preconditioner are read once.
/// Results do not depend on the number of threads.
///
/// \param multiply  y = A x for k vectors (n * k), the values of a row side by side; 0 in held-out
///                  rows
/// \param b         (n, k), 0 in held-out rows
/// \param size      estimate of the norm of A, for the part of the residual that is rounding
/// \return (n, k), 0 in held-out rows
/// \throws SolverFailure  not within the limits: says the course of the residual; a direction of
///                        energy <= 0; values that are not finite
Matrix conjugate_gradients(const std::function<void(const Vector&, Vector&)>& multiply,
                           const Preconditioner& preconditioner, const Matrix& b, double size,
                           const IterationLimits& limits, SolveReport& report, int threads = 0);

}  // namespace carat
