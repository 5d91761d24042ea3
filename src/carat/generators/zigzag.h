#pragma once
// Star-shaped non-convex faces from quads.

#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat {

/// Quads with a kink in the middle of every inner side, half-way to the centre of one of the two
/// faces. Faces of colour 0 have their sides 0 and 2 bent inwards, those of colour 1 their sides
/// 1 and 3; neighbours of different colour agree, else the face with the lower number decides.
struct ZigzagQuads {
  PolygonMesh mesh;
  Points centres;  ///< a kernel point of every face: the mean of its four old corners
};

ZigzagQuads zigzag_quads(const PolygonMesh& quads, const std::vector<bool>& colour);

/// Colours of `patches` checkerboards of n by n faces, row by row.
std::vector<bool> checkerboard(Index patches, Index n);

}  // namespace carat
