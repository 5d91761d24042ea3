#include "carat/io/mesh_file.h"

#include <string>
#include <string_view>
#include <utility>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/io/format.h"
#include "carat/io/load_file.h"
#include "carat/io/with_path.h"

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

void check_patches(const std::vector<BoundaryPatch>& patches, Index n_faces) {
  for (const BoundaryPatch& patch : patches)
    for (const Index f : patch.faces)
      if (f < 0 || f >= n_faces)
        throw InvalidOption("patch '" + patch.name + "' has face " + std::to_string(f) +
                                "; the mesh has faces 0 to " + std::to_string(n_faces - 1),
                            {f});
}

[[noreturn]] void refuse_to_write(const fs::path& path, bool FileFormat::*ability) {
  const bool volume = ability == &FileFormat::writes_volumes;
  throw IoError(path.string() + ": the extension '" + path.extension().string() +
                "' is no format in which " + (volume ? "volumes" : "surfaces") +
                " can be written; use one of " + known_extensions(ability));
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

MeshData read_mesh(const fs::path& path) {
  return detail::with_path(path, [&] {
    for (const FormatEntry& entry : entries())
      if (entry.takes_path != nullptr && entry.takes_path(path)) return entry.read({path, {}});
    const Array<char> bytes = detail::load_file(path);
    std::string_view content(bytes.data(), bytes.size());
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (content.starts_with(byte_order_mark)) content.remove_prefix(byte_order_mark.size());
    const FileContent file{path, content, bytes.size() - content.size()};
    return find_format(file).read(file);
  });
}

SurfaceData read_surface(const fs::path& path) {
  MeshData data = read_mesh(path);
  if (const VolumeData* volume = std::get_if<VolumeData>(&data))
    throw IoError(path.string() + ": holds a volume mesh (" +
                  std::to_string(volume->mesh.n_cells()) +
                  " cells); a surface mesh is needed, use a command for volumes or extract the "
                  "boundary first");
  return std::get<SurfaceData>(std::move(data));
}

VolumeData read_volume(const fs::path& path) {
  MeshData data = read_mesh(path);
  if (const SurfaceData* surface = std::get_if<SurfaceData>(&data))
    throw IoError(path.string() + ": holds a surface mesh (" +
                  std::to_string(surface->mesh.n_faces()) +
                  " faces, no volume cells); a volume mesh is needed, use a command for surfaces "
                  "or fill it with cells first");
  return std::get<VolumeData>(std::move(data));
}

void write_surface(const fs::path& path, const PolygonMesh& mesh, const MeshFields& fields) {
  const FormatEntry* entry = find_by_extension(path);
  if (entry == nullptr || entry->write == nullptr) refuse_to_write(path, &FileFormat::writes);
  detail::with_path(path, [&] {
    check_fields(fields.vertex, "vertex", mesh.n_vertices());
    check_fields(fields.face, "face", mesh.n_faces());
  });
  write_atomically(path, [&](const fs::path& temporary) {
    detail::with_path(path, [&] { entry->write(temporary, mesh, fields); });
  });
}

void write_volume(const fs::path& path, const PolyhedralMesh& mesh, const MeshFields& fields,
                  const std::vector<BoundaryPatch>& patches) {
  const FormatEntry* entry = find_by_extension(path);
  if (entry == nullptr || entry->write_volume == nullptr)
    refuse_to_write(path, &FileFormat::writes_volumes);
  detail::with_path(path, [&] {
    check_fields(fields.vertex, "vertex", mesh.n_vertices());
    check_fields(fields.cell, "cell", mesh.n_cells());
    check_patches(patches, mesh.n_faces());
  });
  write_atomically(path, [&](const fs::path& temporary) {
    detail::with_path(path, [&] { entry->write_volume(temporary, mesh, fields, patches); });
  });
}

}  // namespace carat
