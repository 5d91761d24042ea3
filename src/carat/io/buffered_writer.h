#pragma once
// Formats numbers into a large buffer and writes it in few calls.

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "carat/base/memory.h"

namespace carat::detail {

/// A file under construction. Doubles are written as the shortest text that reads back bit by bit.
class BufferedWriter {
 public:
  /// \throws IoError  the file cannot be opened
  explicit BufferedWriter(const std::filesystem::path& path);
  ~BufferedWriter();
  BufferedWriter(const BufferedWriter&) = delete;
  BufferedWriter& operator=(const BufferedWriter&) = delete;

  BufferedWriter& put(char c) {
    if (used_ == kCapacity) flush();
    buffer_[used_++] = c;
    return *this;
  }
  BufferedWriter& put(std::string_view text) { return put_bytes(text.data(), text.size()); }
  BufferedWriter& put(double value) { return put_number(value); }
  template <std::integral T>
  BufferedWriter& put(T value) {
    return put_number(value);
  }
  BufferedWriter& put_bytes(const void* data, std::size_t size);

  /// Writes out what is left and closes the file. Without it the file is incomplete.
  /// \throws IoError  the disk is full or fails
  void close();

 private:
  static constexpr std::size_t kCapacity = std::size_t{1} << 20;
  static constexpr std::size_t kLongestNumber = 32;

  template <class T>
  BufferedWriter& put_number(T value) {
    if (kCapacity - used_ < kLongestNumber) flush();
    char* const first = buffer_.data() + used_;
    used_ +=
        static_cast<std::size_t>(std::to_chars(first, first + kLongestNumber, value).ptr - first);
    return *this;
  }
  void flush();
  void write_out(const char* data, std::size_t size);

  int handle_ = -1;
  std::size_t used_ = 0;
  Array<char> buffer_;
};

}  // namespace carat::detail
