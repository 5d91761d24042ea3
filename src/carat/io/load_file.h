#pragma once
// A whole file in memory.

#include <filesystem>

#include "carat/base/memory.h"

namespace carat::detail {

/// The bytes of a regular file that is not empty.
/// \throws IoError  missing, unreadable, empty, a folder, a pipe; without the path
Array<char> load_file(const std::filesystem::path& path);

}  // namespace carat::detail
