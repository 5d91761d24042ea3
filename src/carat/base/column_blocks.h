#pragma once
// Several vectors at once: columns in groups whose number the compiler knows.

#include <type_traits>

#include "carat/base/types.h"

namespace carat {

/// Calls body(width, first) for groups of columns that cover [0, k): width is a
/// std::integral_constant of 8, 4, 2 or 1.
template <class Body>
void for_column_groups(Index k, const Body& body) {
  Index first = 0;
  const auto take = [&]<Index kWidth>(std::integral_constant<Index, kWidth> width) {
    for (; k - first >= kWidth; first += kWidth) body(width, first);
  };
  take(std::integral_constant<Index, 8>{});
  take(std::integral_constant<Index, 4>{});
  take(std::integral_constant<Index, 2>{});
  take(std::integral_constant<Index, 1>{});
}

}  // namespace carat
