#include "carat/io/load_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

struct Handle {
  int value;
  ~Handle() {
    if (value >= 0) ::close(value);
  }
};

[[noreturn]] void refuse(int error) {
  throw IoError(std::string("cannot be read: ") + std::strerror(error));
}

}  // namespace

Array<char> load_file(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe would wait for its writer.
  const Handle handle{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct ::stat status {};
  if (handle.value < 0 || ::fstat(handle.value, &status) != 0) refuse(errno);
  if (S_ISDIR(status.st_mode))
    throw IoError("is a folder without an OpenFOAM mesh (constant/polyMesh); name a mesh file");
  if (!S_ISREG(status.st_mode)) throw IoError("is no regular file; copy its content to one");
  if (status.st_size == 0) throw IoError("is empty; export the mesh again");
  Array<char> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(handle.value, bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(errno);
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace carat::detail
