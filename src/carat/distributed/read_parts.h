#pragma once
// Meshes that are in parts already: every process reads its own.

#include <filesystem>

#include "carat/distributed/part_data.h"

namespace carat {

/// Whether a path names a mesh in parts: an index .pvtu or .pvtp, a file .cparts, an OpenFOAM case
/// with the folder processor0 (also if it has the whole mesh). Looks at names alone, not into
/// files.
bool is_in_parts(const std::filesystem::path& path);

/// Collective. Each process reads its own part and nothing else of the mesh.
/// \throws Shared<InvalidOption>  another number of parts than of processes
/// \throws Shared<IoError>        a part that is missing, truncated or damaged; of no known form
/// \throws Shared<InvalidMesh>    parts that do not fit together
AnyPartData read_parts(const std::filesystem::path& path);

}  // namespace carat
