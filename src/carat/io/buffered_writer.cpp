#include "carat/io/buffered_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

[[noreturn]] void fail(int error) {
  throw IoError(std::string("cannot be written: ") + std::strerror(error));
}

}  // namespace

BufferedWriter::BufferedWriter(const std::filesystem::path& path) {
  buffer_.resize(kCapacity);
  handle_ = ::open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (handle_ < 0) fail(errno);
}

BufferedWriter::~BufferedWriter() {
  if (handle_ >= 0) ::close(handle_);
}

BufferedWriter& BufferedWriter::put_bytes(const void* data, std::size_t size) {
  if (kCapacity - used_ < size) flush();
  if (size > kCapacity) {
    write_out(static_cast<const char*>(data), size);
  } else if (size > 0) {
    std::memcpy(buffer_.data() + used_, data, size);
    used_ += size;
  }
  return *this;
}

void BufferedWriter::close() {
  flush();
  if (::close(std::exchange(handle_, -1)) != 0) fail(errno);
}

void BufferedWriter::flush() { write_out(buffer_.data(), std::exchange(used_, 0)); }

void BufferedWriter::write_out(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(handle_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

}  // namespace carat::detail
