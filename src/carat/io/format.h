#pragma once
// What a file format gives to the table of formats.

#include <filesystem>
#include <string_view>

#include "carat/io/mesh_file.h"

namespace carat::detail {

/// A file to read: where it is and all that is in it.
struct FileContent {
  std::filesystem::path path;
  std::string_view bytes;
  std::size_t start = 0;  ///< where the bytes begin in the file: behind a byte order mark
};

/// One format. A new one is a file that defines `<name>_format()` and a line in formats.def.
/// Messages of its errors start with the line or element; the caller puts the path in front.
struct FormatEntry {
  FileFormat format;
  /// Whether the content tells that it is of this format.
  bool (*recognises)(std::string_view content);
  MeshData (*read)(const FileContent& file);
  /// Writes to a temporary path; null if the format has no surfaces or is only read.
  void (*write)(const std::filesystem::path& path, const PolygonMesh& mesh,
                const MeshFields& fields) = nullptr;
  /// The same for volumes.
  void (*write_volume)(const std::filesystem::path& path, const PolyhedralMesh& mesh,
                       const MeshFields& fields,
                       const std::vector<BoundaryPatch>& patches) = nullptr;
  /// For formats of several files: whether the path names one of this format. Such a path is not
  /// loaded: `read` gets it without bytes. Null for formats of one file.
  bool (*takes_path)(const std::filesystem::path& path) = nullptr;
};

#define CARAT_FORMAT(name) FormatEntry name##_format();
#include "carat/io/formats.def"
#undef CARAT_FORMAT

}  // namespace carat::detail
