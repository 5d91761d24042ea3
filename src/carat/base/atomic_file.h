#pragma once
// Output files that are complete or absent.

#include <filesystem>
#include <functional>

namespace carat {

/// Calls write(temporary) with a fresh name beside `path` (same extension), then renames it to
/// `path`. If write throws, or the rename fails, the temporary is removed and an existing file at
/// `path` is untouched.
/// \throws IoError  the folder does not exist or cannot be written; whatever `write` throws
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace carat
