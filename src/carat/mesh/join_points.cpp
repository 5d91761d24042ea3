#include "carat/mesh/join_points.h"

#include <string>

#include "carat/base/error.h"

namespace carat {

std::vector<std::int64_t> join_points(std::span<const PiecePoint> same) {
  const auto n = static_cast<std::int64_t>(same.size());
  std::int64_t first_used = -1;
  bool several_pieces = false, several_users = false, several_of_a_user = false;
  for (std::int64_t k = 0, last_used = -1; k < n; ++k) {
    several_pieces |= same[static_cast<std::size_t>(k)].piece != same.front().piece;
    if (!same[static_cast<std::size_t>(k)].used) continue;
    if (first_used < 0) first_used = k;
    if (last_used >= 0) {
      const bool one_piece = same[static_cast<std::size_t>(last_used)].piece ==
                             same[static_cast<std::size_t>(k)].piece;
      (one_piece ? several_of_a_user : several_users) = true;
    }
    last_used = k;
  }
  if (several_users && several_of_a_user)
    throw InvalidMesh(
        "several vertices of a piece lie where it meets another one (vertex " +
        std::to_string(same[static_cast<std::size_t>(first_used)].index) + " of piece " +
        std::to_string(same[static_cast<std::size_t>(first_used)].piece) +
        "), so coordinates do not tell which are the same; give the pieces global vertex ids");
  std::vector<std::int64_t> result(same.size());
  for (std::int64_t k = 0; k < n; ++k) {
    const bool used = same[static_cast<std::size_t>(k)].used;
    std::int64_t& stands = result[static_cast<std::size_t>(k)];
    if (several_users) {
      stands = first_used;
    } else if (first_used >= 0) {
      stands = used ? k : -1;
    } else {
      stands = several_pieces ? 0 : k;
    }
  }
  return result;
}

}  // namespace carat
