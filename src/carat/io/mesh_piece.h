#pragma once
// A piece of a mesh, as one of several files holds it.

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "carat/io/mesh_file.h"

namespace carat {

/// Some elements of a mesh with their vertices. Every element is in one piece; vertices, and the
/// interfaces where pieces meet, are in several. Numbers in the whole mesh say which are the same.
/// They need not be dense: only their order counts. Empty lists: not known.
template <class Mesh>
struct MeshPiece {
  Mesh mesh;
  std::vector<std::int64_t> vertex_ids, element_ids;
  std::vector<std::int64_t> interface_ids;  ///< of volumes' faces; surfaces have none
  MeshFields fields;
  std::vector<BoundaryPatch> patches;  ///< of volumes
};

using AnyMeshPiece = std::variant<MeshPiece<PolygonMesh>, MeshPiece<PolyhedralMesh>>;

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
