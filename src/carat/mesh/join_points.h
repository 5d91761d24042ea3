#pragma once
// Which vertices of several pieces of a mesh are one.

#include <cstdint>
#include <span>
#include <vector>

namespace carat {

/// A point of a piece.
struct PiecePoint {
  std::int64_t piece, index;
  bool used;  ///< by an element of the piece
};

/// Which of the points at one place are one vertex, where pieces have no numbers: those of
/// different pieces. Points of one piece stay apart, as at a slit, and no other piece may meet
/// them there. What no element uses gives way to what is used.
/// \param same  points with equal coordinates, ascending by piece and index
/// \return      for each the place in `same` of the one that stands for it, itself for one that
///              stands for itself; -1: no vertex
/// \throws InvalidMesh  which vertex of another piece is meant cannot be told
std::vector<std::int64_t> join_points(std::span<const PiecePoint> same);

}  // namespace carat
