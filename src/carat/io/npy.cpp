#include "carat/io/npy.h"

#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"

namespace carat {
namespace {

namespace fs = std::filesystem;

/// Version 1.0: a dictionary of Python, padded so that the values start at a multiple of 64.
std::string npy_header(Index rows, Index columns) {
  const char order = std::endian::native == std::endian::little ? '<' : '>';
  std::string text = std::string("{'descr': '") + order +
                     "f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " +
                     std::to_string(columns) + "), }";
  constexpr std::size_t kFixed = 10;
  text.resize((kFixed + text.size() + 1 + 63) / 64 * 64 - kFixed - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

void require_space(const fs::path& path, double bytes) {
  std::error_code failure;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(folder, failure);
  if (failure || static_cast<double>(space.available) >= bytes) return;
  char text[80];
  std::snprintf(text, sizeof text, "the matrix takes %.3g GB, %.3g GB are free", bytes * 1e-9,
                static_cast<double>(space.available) * 1e-9);
  throw IoError(path.string() + ": " + text + "; choose another disk, or fewer rows");
}

}  // namespace

void write_npy(const fs::path& path, Index rows, Index columns,
               const std::function<void(const PutRow& put)>& produce) {
  const std::string header = npy_header(rows, columns);
  write_atomically(path, [&](const fs::path& temporary) {
    require_space(path, static_cast<double>(header.size()) +
                            static_cast<double>(sizeof(double)) * rows * columns);
    const auto with_path = [&](const auto& work) {
      try {
        work();
      } catch (const IoError& error) {
        throw IoError(path.string() + ": " + error.what());
      }
    };
    const auto refuse = [&](const std::string& what) {
      throw InvalidOption(path.string() + ": " + what + " for a matrix of " + std::to_string(rows) +
                          " x " + std::to_string(columns));
    };
    detail::BufferedWriter out(temporary);
    out.put(header);
    Index n = 0;
    produce([&](const Vector& values) {
      if (values.size() != columns) refuse("a row of " + std::to_string(values.size()) + " values");
      if (++n > rows) refuse("row " + std::to_string(n));
      with_path([&] {
        out.put_bytes(values.data(), sizeof(double) * static_cast<std::size_t>(columns));
      });
    });
    if (n != rows) refuse(std::to_string(n) + " rows");
    with_path([&] { out.close(); });
  });
}

}  // namespace carat
