#include "carat/io/mesh_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/io/format.h"

namespace carat {
namespace {

using detail::FileContent;
using detail::FormatEntry;
namespace fs = std::filesystem;

const std::vector<FormatEntry>& entries() {
  static const std::vector<FormatEntry> all = {
#define CARAT_FORMAT(name) detail::name##_format(),
#include "carat/io/formats.def"
#undef CARAT_FORMAT
  };
  return all;
}

std::string lower_case_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

const FormatEntry* find_by_extension(const fs::path& path) {
  const std::string extension = lower_case_extension(path);
  for (const FormatEntry& entry : entries())
    for (const std::string& known : entry.format.extensions)
      if (known == extension) return &entry;
  return nullptr;
}

std::string known_extensions(bool FileFormat::*ability) {
  std::string list;
  for (const FormatEntry& entry : entries())
    if (entry.format.*ability)
      for (const std::string& extension : entry.format.extensions)
        list += (list.empty() ? "" : " ") + extension;
  return list;
}

const FormatEntry& find_format(const FileContent& file) {
  for (const FormatEntry& entry : entries())
    if (entry.recognises(file.bytes)) return entry;
  if (const FormatEntry* entry = find_by_extension(file.path)) return *entry;
  throw IoError("neither its content nor its extension '" + file.path.extension().string() +
                "' is a known mesh format; known are " + known_extensions(&FileFormat::reads));
}

Array<char> load(const fs::path& path) {
  struct Handle {
    int value;
    ~Handle() {
      if (value >= 0) ::close(value);
    }
  };
  const auto refuse = [](int error) {
    throw IoError(std::string("cannot be read: ") + std::strerror(error));
  };
  // Without O_NONBLOCK a pipe would wait for its writer.
  const Handle handle{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct ::stat status {};
  if (handle.value < 0 || ::fstat(handle.value, &status) != 0) refuse(errno);
  if (S_ISDIR(status.st_mode)) throw IoError("is a folder; name a mesh file");
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

/// Runs `work` and puts the path in front of what it throws.
template <class Work>
auto with_path(const fs::path& path, Work&& work) {
  const std::string prefix = path.string() + ": ";
  try {
    return work();
  } catch (const IoError& error) {
    throw IoError(prefix + error.what(), error.elements());
  } catch (const InvalidMesh& error) {
    throw InvalidMesh(prefix + error.what(), error.elements());
  } catch (const InvalidOption& error) {
    throw InvalidOption(prefix + error.what(), error.elements());
  } catch (const std::bad_alloc&) {
    throw IoError(prefix + "does not fit into memory; close other programs or use a smaller mesh");
  }
}

void check_fields(const std::vector<Field>& fields, const char* where, Index n_rows) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Field& field = fields[i];
    const std::string name = std::string(where) + " field '" + field.name + "'";
    if (field.name.empty()) throw InvalidOption(name + " has no name; give it one");
    if (field.components < 1)
      throw InvalidOption(name + " has " + std::to_string(field.components) +
                          " components; at least 1 is needed");
    const std::size_t expected =
        static_cast<std::size_t>(n_rows) * static_cast<std::size_t>(field.components);
    if (field.values.size() != expected)
      throw InvalidOption(name + " has " + std::to_string(field.values.size()) +
                          " values; the mesh needs " + std::to_string(n_rows) + " rows of " +
                          std::to_string(field.components));
    for (std::size_t j = 0; j < i; ++j)
      if (fields[j].name == field.name)
        throw InvalidOption(name + " is there twice; rename one of them");
  }
}

}  // namespace

const std::vector<FileFormat>& file_formats() {
  static const std::vector<FileFormat> formats = [] {
    std::vector<FileFormat> list;
    for (const FormatEntry& entry : entries()) list.push_back(entry.format);
    return list;
  }();
  return formats;
}

SurfaceData read_surface(const fs::path& path) {
  return with_path(path, [&] {
    const Array<char> bytes = load(path);
    std::string_view content(bytes.data(), bytes.size());
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (content.starts_with(byte_order_mark)) content.remove_prefix(byte_order_mark.size());
    const FileContent file{path, content, bytes.size() - content.size()};
    return find_format(file).read(file);
  });
}

void write_surface(const fs::path& path, const PolygonMesh& mesh, const MeshFields& fields) {
  const FormatEntry* entry = find_by_extension(path);
  if (entry == nullptr || entry->write == nullptr)
    throw IoError(path.string() + ": the extension '" + path.extension().string() +
                  "' is no format that can be written; use one of " +
                  known_extensions(&FileFormat::writes));
  with_path(path, [&] {
    check_fields(fields.vertex, "vertex", mesh.n_vertices());
    check_fields(fields.face, "face", mesh.n_faces());
  });
  write_atomically(path, [&](const fs::path& temporary) {
    with_path(path, [&] { entry->write(temporary, mesh, fields); });
  });
}

}  // namespace carat
