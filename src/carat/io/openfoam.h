#pragma once
// OpenFOAM cases that are divided over several processes.

#include <filesystem>
#include <vector>

#include "carat/io/mesh_piece.h"

namespace carat {

/// The folders processor0, processor1, ... of a case, which is named by its folder or a file *.foam
/// in that; empty if it is not divided.
std::vector<std::filesystem::path> foam_processors(const std::filesystem::path& path);

/// Reads the mesh of one of these folders. Its numbers in the whole mesh are those of
/// pointProcAddressing, faceProcAddressing and cellProcAddressing, if these are there; patches
/// towards other processors are none.
/// \throws  as read_mesh
MeshPiece<PolyhedralMesh> read_foam_piece(const std::filesystem::path& folder);

}  // namespace carat
