#include "carat/base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "carat/base/error.h"

namespace carat {
namespace fs = std::filesystem;

namespace {

/// Creates an empty file nobody else has, named like `path` with a number before the extension.
fs::path create_beside(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw IoError(path.string() + ": the folder " + folder.string() +
                  " does not exist; create it first");
  if (fs::is_directory(path, ignored)) throw IoError(path.string() + ": is a folder; name a file");
  for (int attempt = 0; attempt < 1000; ++attempt) {
    fs::path candidate = folder / (path.stem().string() + ".part" + std::to_string(::getpid()) +
                                   "-" + std::to_string(attempt) + path.extension().string());
    const int handle = ::open(candidate.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (handle >= 0) {
      ::close(handle);
      return candidate;
    }
    if (errno != EEXIST)
      throw IoError(path.string() + ": cannot be written: " + std::strerror(errno));
  }
  throw IoError(path.string() + ": no free temporary name beside it; remove old *.part* files");
}

}  // namespace

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = create_beside(path);
  try {
    write(temporary);
    std::error_code failure;
    fs::rename(temporary, path, failure);
    if (failure) throw IoError(path.string() + ": cannot be written: " + failure.message());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

}  // namespace carat
