#pragma once
// A centre of the region that lies behind given planes.

#include <span>

#include "carat/base/types.h"

namespace carat {

/// The region normal . x <= offset.
struct HalfSpace {
  Vec3 normal;    ///< of any length: its weight in the centre
  double offset;  ///< in units of the normal's length
};

/// The weighted analytic centre: where the product of the distances from all planes, each to the
/// power of its normal's length, is largest. It is unique, and moves with the planes.
/// \param planes  bound a region of about unit size about 0
/// \param center  receives it
/// \return false if the region is empty, or flat to rounding
/// Cost: a few dozen passes over the planes, no allocation.
bool half_space_center(std::span<const HalfSpace> planes, Vec3& center);

}  // namespace carat
