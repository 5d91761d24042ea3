#include <gtest/gtest.h>

#include "carat/base/error.h"
#include "carat/mesh/join_points.h"

namespace carat::test {
namespace {

using Numbers = std::vector<std::int64_t>;

Numbers join(const std::vector<PiecePoint>& same) { return join_points(same); }

TEST(JoinPoints, points_of_different_pieces_are_one_vertex) {
  EXPECT_EQ(join({{0, 4, true}}), (Numbers{0}));
  EXPECT_EQ(join({{0, 4, true}, {2, 0, true}, {3, 9, true}}), (Numbers{0, 0, 0}));
}

TEST(JoinPoints, points_of_one_piece_stay_apart) {
  EXPECT_EQ(join({{1, 4, true}, {1, 5, true}}), (Numbers{0, 1}));
  EXPECT_EQ(join({{1, 4, false}, {1, 5, false}}), (Numbers{0, 1}));
  EXPECT_THROW(join({{1, 4, true}, {1, 5, true}, {2, 0, true}}), InvalidMesh);
}

TEST(JoinPoints, what_no_element_uses_gives_way) {
  EXPECT_EQ(join({{0, 0, false}, {1, 4, true}, {1, 5, true}}), (Numbers{-1, 1, 2}));
  EXPECT_EQ(join({{0, 0, false}, {1, 4, true}, {2, 5, true}}), (Numbers{1, 1, 1}));
  EXPECT_EQ(join({{0, 0, false}, {1, 4, false}}), (Numbers{0, 0}));
}

}  // namespace
}  // namespace carat::test
