#pragma once
// Coarser matrices by smoothed aggregation.

#include <optional>

#include "carat/base/types.h"

namespace carat::multigrid {

using Real = float;

/// Compressed rows.
struct Rows {
  Array<Index> offsets{0}, columns;
  Array<Real> values;
};

/// A symmetric matrix, and what leads to the next level.
struct LevelMatrices {
  Rows matrix;  ///< off the diagonal, columns ascending
  Array<Real> diagonal;
  Rows prolongation, restriction;  ///< transposes of each other; empty on the last level

  Index size() const { return static_cast<Index>(diagonal.size()); }
};

/// Makes the prolongation and restriction of `fine`, and the coarse matrix P^T A P.
/// \param threads  the result does not depend on it
/// \return empty: aggregates would hardly be fewer than the rows
std::optional<LevelMatrices> coarsen(LevelMatrices& fine, int threads);

}  // namespace carat::multigrid
