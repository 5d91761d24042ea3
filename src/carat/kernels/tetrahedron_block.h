#pragma once
// Linear elements on several tetrahedra at a time.

#include "carat/base/types.h"

namespace carat {

constexpr int kBlockTets = 8;

/// Linear elements on a tetrahedron; eight numbers, so that one lies in a line of the cache.
struct LinearTet {
  double pair[6];   ///< -S between the vertices 01, 02, 03, 12, 13, 23  [length]
  double volume;    ///< with its sign  [length^3]
  double longest2;  ///< square of the longest edge  [length^2]
};

/// \param points    as in Points::data()                                        [length]
/// \param vertices  kBlockTets lists of 4 vertices
/// \param sign      of each: + if its first three are seen clockwise from the fourth
/// \param tets      receives them; not finite without volume
/// The same bits wherever in a block a tetrahedron stands.
void linear_tet_block(const double* points, const Index* const* vertices, const double* sign,
                      LinearTet* const* tets);

}  // namespace carat
