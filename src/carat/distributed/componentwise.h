#pragma once
// solve_componentwise() over all processes. Seen by this folder's sources alone.

#include "carat/distributed/part_exchange.h"
#include "carat/solve/conjugate_gradients.h"

namespace carat {

/// \param matrix   with positive diagonal in the rows that take part
/// \param inverse  of the diagonal in the own rows; 0: the row takes no part, and its value is 0
/// \param b        own rows
/// \return own rows
/// \throws SolverFailure  Shared: not within 5000 iterations; not positive definite, or not finite
Vector solve_componentwise(Mat matrix, Vector inverse, Vector b, SolveReport& report);

}  // namespace carat
