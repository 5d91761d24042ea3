#pragma once
// From pieces that the processes read to parts that they work on.

#include <cstdint>

#include "carat/distributed/part_data.h"
#include "carat/io/mesh_piece.h"

namespace carat {

/// Collective. Joins the pieces of all processes, one each, to a mesh of which each process gets
/// its part: its own elements and those across their interfaces, with the numbers that the whole
/// mesh has. No process holds more than its part and a share of the lists of vertices and
/// interfaces.
///
/// With ids, vertices and elements are numbered in their order, volumes' faces by theirs or as the
/// cells name them, and the part is the one that part_of() and divide() give. Without ids of
/// vertices, equal coordinates are the same vertex (see mesh/join_points.h), and numbers follow the
/// pieces; elements without ids likewise.
/// \param first_interface      number of the first interface: shows with a small mesh what holds for
///                              interfaces beyond 32 bits
/// \throws Shared<InvalidMesh>  ids of some processes only, or twice; a vertex at two places; an
///                              interface that does not fit; more vertices or elements, or more
///                              interfaces of one piece, than Index can number
/// \throws Shared<IoError>      pieces with different fields
PartData<PolygonMesh> join_pieces(MeshPiece<PolygonMesh> piece, std::int64_t first_interface = 0);
PartData<PolyhedralMesh> join_pieces(MeshPiece<PolyhedralMesh> piece,
                                     std::int64_t first_interface = 0);

}  // namespace carat
