#include "carat/distributed/part_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/distributed/message.h"

namespace carat {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> kMagic{'c', 'a', 'r', 'a', 't', 'P', 'R', 'T'};
constexpr std::uint32_t kByteOrder = 0x01020304, kVersion = 2;
constexpr std::uint32_t kSurface = 2, kVolume = 3;

/// What a file begins with; the table of parts follows.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t byte_order = kByteOrder, version = kVersion;
  std::uint32_t index_size = sizeof(Index), kind = kSurface;
  std::uint64_t n_parts = 0;
  std::uint64_t checksum = 0;  ///< of the header with 0 here, and of the table
};

struct Entry {
  std::uint64_t offset = 0, size = 0, checksum = 0;
};

/// Changes with every bit of the bytes.
std::uint64_t checksum(std::span<const char> bytes, std::uint64_t value = 0xCBF29CE484222325U) {
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t n = std::min(bytes.size(), sizeof word);
    std::memcpy(&word, bytes.data(), n);
    value = (value ^ word) * 0x9E3779B97F4A7C15U;
    value ^= value >> 32;
    bytes = bytes.subspan(n);
  }
  return value;
}

template <class T>
std::span<const char> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

std::uint64_t checksum_of(Header header, std::span<const Entry> table) {
  header.checksum = 0;
  return checksum(bytes_of(table), checksum(bytes_of(std::span<const Header>(&header, 1))));
}

template <class Data>
void write(const fs::path& path, std::uint32_t kind, const Data& data,
           const MeshDivision& division) {
  Header header;
  header.kind = kind;
  header.n_parts = static_cast<std::uint64_t>(division.n_parts);
  write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    const auto put = [&](std::span<const char> bytes) {
      file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      if (!file) throw IoError(path.string() + ": cannot be written; is the disk full?");
    };
    std::vector<Entry> table(static_cast<std::size_t>(division.n_parts));
    const auto put_head = [&] {
      file.seekp(0);
      put(bytes_of(std::span<const Header>(&header, 1)));
      put(bytes_of(std::span<const Entry>(table)));
    };
    put_head();
    std::uint64_t end = sizeof(Header) + table.size() * sizeof(Entry);
    for (Index p = 0; p < division.n_parts; ++p) {
      Message message;
      carat::put(message, part_data_of(data, division, p));
      const std::span<const char> bytes = message.bytes();
      put(bytes);
      table[static_cast<std::size_t>(p)] = {end, bytes.size(), checksum(bytes)};
      end += bytes.size();
    }
    header.checksum = checksum_of(header, table);
    put_head();
    file.close();
    if (!file) throw IoError(path.string() + ": cannot be written; is the disk full?");
  });
}

/// An open file, of which ranges are read.
class Ranges {
 public:
  explicit Ranges(const fs::path& path)
      : handle_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct ::stat status {};
    if (handle_ < 0 || ::fstat(handle_, &status) != 0) {
      const int error = errno;
      close();
      throw IoError(std::string("cannot be read: ") + std::strerror(error));
    }
    if (!S_ISREG(status.st_mode)) {
      close();
      throw IoError("is no regular file; name a file .cparts");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~Ranges() { close(); }
  Ranges(const Ranges&) = delete;
  Ranges& operator=(const Ranges&) = delete;

  std::uint64_t size() const { return size_; }
  bool holds(std::uint64_t offset, std::uint64_t size) const {
    return offset <= size_ && size <= size_ - offset;
  }
  void read(std::uint64_t offset, std::span<char> bytes) const {
    while (!bytes.empty()) {
      const ssize_t got =
          ::pread(handle_, bytes.data(), bytes.size(), static_cast<::off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw IoError(std::string("cannot be read: ") + std::strerror(errno));
      if (got == 0) throw IoError("ends too early; it is truncated, divide the mesh anew");
      bytes = bytes.subspan(static_cast<std::size_t>(got));
      offset += static_cast<std::uint64_t>(got);
    }
  }

 private:
  void close() const {
    if (handle_ >= 0) ::close(handle_);
  }
  int handle_;
  std::uint64_t size_ = 0;
};

Header read_header(const Ranges& file) {
  Header header;
  if (!file.holds(0, sizeof header))
    throw IoError("has " + std::to_string(file.size()) +
                  " bytes, too few for a mesh in parts; it is truncated, divide the mesh anew");
  file.read(0, {reinterpret_cast<char*>(&header), sizeof header});
  if (header.magic != kMagic) throw IoError("holds no mesh in parts as carat partition writes it");
  if (header.byte_order != kByteOrder)
    throw IoError("comes from a machine with another order of bytes; divide the mesh on this one");
  if (header.version != kVersion || header.index_size != sizeof(Index))
    throw IoError("is of version " + std::to_string(header.version) + " with indices of " +
                  std::to_string(header.index_size) + " bytes, this program reads version " +
                  std::to_string(kVersion) + " with " + std::to_string(sizeof(Index)) +
                  "; divide the mesh anew");
  return header;
}

std::vector<Entry> read_table(const Ranges& file, const Header& header) {
  if (header.n_parts > (file.size() - sizeof header) / sizeof(Entry) ||
      header.n_parts > static_cast<std::uint64_t>(std::numeric_limits<Index>::max()))
    throw IoError(
        "says that it has " + std::to_string(header.n_parts) +
        " parts, more than it can hold; it is truncated or damaged, divide the mesh anew");
  std::vector<Entry> table(static_cast<std::size_t>(header.n_parts));
  file.read(sizeof header, {reinterpret_cast<char*>(table.data()), table.size() * sizeof(Entry)});
  if (header.checksum != checksum_of(header, table) ||
      (header.kind != kSurface && header.kind != kVolume))
    throw IoError("has a damaged table of parts; divide the mesh anew");
  return table;
}

/// Sizes that later work relies on.
template <class Mesh>
bool fits(const PartData<Mesh>& data, Index part, Index n_parts, Index n_elements,
          Index n_interfaces) {
  const PartNumbers& numbers = data.part.numbers;
  const auto has = [](const auto& list, Index n) {
    return list.size() == static_cast<std::size_t>(n);
  };
  const Index n_vertices = data.part.mesh.n_vertices();
  bool good = numbers.part == part && numbers.n_parts == n_parts &&
              has(numbers.vertices, n_vertices) && has(numbers.vertex_rows, n_vertices) &&
              has(numbers.vertex_components, n_vertices) && has(numbers.elements, n_elements) &&
              has(numbers.own_elements, n_elements) && has(numbers.interfaces, n_interfaces) &&
              has(numbers.own_interfaces, n_interfaces);
  const auto check = [&](const std::vector<Field>& fields, Index n) {
    for (const Field& field : fields)
      good &= field.components > 0 &&
              field.values.size() ==
                  static_cast<std::size_t>(n) * static_cast<std::size_t>(field.components);
  };
  check(data.fields.vertex, n_vertices);
  check(data.fields.face, n_elements);
  check(data.fields.cell, n_elements);
  for (const BoundaryPatch& patch : data.patches)
    for (const Index f : patch.faces) good &= f >= 0 && f < n_interfaces;
  return good;
}

template <class Mesh>
PartData<Mesh> unpack(Message message, Index part, Index n_parts) {
  PartData<Mesh> data;
  take(message, data);
  bool good = message.left() == 0;
  if constexpr (std::is_same_v<Mesh, PolygonMesh>) {
    good = good && fits(data, part, n_parts, data.part.mesh.n_faces(), data.part.mesh.n_edges());
  } else {
    good = good && fits(data, part, n_parts, data.part.mesh.n_cells(), data.part.mesh.n_faces());
  }
  if (!good) throw Error("its lists do not fit together");
  return data;
}

template <class Work>
auto with_path(const fs::path& path, const Work& work) {
  try {
    return work();
  } catch (const InvalidOption& error) {
    throw InvalidOption(path.string() + ": " + error.what());
  } catch (const Error& error) {
    throw IoError(path.string() + ": " + error.what());
  }
}

}  // namespace

void write_part_file(const fs::path& path, const SurfaceData& data, const MeshDivision& division) {
  write(path, kSurface, data, division);
}

void write_part_file(const fs::path& path, const VolumeData& data, const MeshDivision& division) {
  write(path, kVolume, data, division);
}

Index count_parts(const fs::path& path) {
  return with_path(path, [&] {
    const Ranges file(path);
    return static_cast<Index>(read_table(file, read_header(file)).size());
  });
}

AnyPartData read_part(const fs::path& path, Index part) {
  return with_path(path, [&]() -> AnyPartData {
    const Ranges file(path);
    const Header header = read_header(file);
    const std::vector<Entry> table = read_table(file, header);
    const auto n_parts = static_cast<Index>(table.size());
    if (part < 0 || part >= n_parts)
      throw InvalidOption("part " + std::to_string(part) +
                          " does not exist; there are parts 0 to " + std::to_string(n_parts - 1));
    const Entry& entry = table[static_cast<std::size_t>(part)];
    const std::string name = "part " + std::to_string(part);
    if (!file.holds(entry.offset, entry.size))
      throw IoError(name +
                    " reaches beyond the end of the file; it is truncated, divide the mesh "
                    "anew");
    std::vector<char> bytes(static_cast<std::size_t>(entry.size));
    file.read(entry.offset, bytes);
    if (checksum(bytes) != entry.checksum)
      throw IoError(name + " is damaged (its checksum differs); divide the mesh anew");
    try {
      if (header.kind == kSurface)
        return unpack<PolygonMesh>(Message(std::move(bytes)), part, n_parts);
      return unpack<PolyhedralMesh>(Message(std::move(bytes)), part, n_parts);
    } catch (const Error& error) {
      throw IoError(name + " is damaged: " + error.what() + "; divide the mesh anew");
    }
  });
}

}  // namespace carat
