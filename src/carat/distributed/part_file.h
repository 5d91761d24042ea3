#pragma once
// All parts of a mesh in one file, .cparts, of which every process reads its own bytes alone.

#include <filesystem>

#include "carat/distributed/part_data.h"

namespace carat {

/// Writes all parts complete, with halo, numbers, fields and patches. The file appears under its
/// name only when it is complete.
/// \throws IoError  it cannot be written
void write_part_file(const std::filesystem::path& path, const SurfaceData& data,
                     const MeshDivision& division);
void write_part_file(const std::filesystem::path& path, const VolumeData& data,
                     const MeshDivision& division);

/// How many parts a file has. Reads its table alone.
/// \throws IoError  as read_part
Index count_parts(const std::filesystem::path& path);

/// Reads one part.
/// \throws IoError        missing, no such file, truncated, damaged, of another version or order of
///                        bytes; nothing is allocated that the file cannot hold
/// \throws InvalidOption  no such part
AnyPartData read_part(const std::filesystem::path& path, Index part);

}  // namespace carat
