#include "cli/files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "carat/base/error.h"
#include "carat/report/html_view.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

std::string lower_case_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

bool is_page(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".html" || extension == ".htm";
}

bool writes(const FileFormat& format) { return format.writes || format.writes_volumes; }

const FileFormat* writable_format(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  for (const FileFormat& format : file_formats())
    if (writes(format))
      for (const std::string& known : format.extensions)
        if (known == extension) return &format;
  return nullptr;
}

template <class Condition>
std::string extensions(const Condition& condition) {
  std::string list;
  for (const FileFormat& format : file_formats())
    if (condition(format))
      for (const std::string& extension : format.extensions) list += extension + " ";
  return list + ".html";
}

std::string writable_extensions(Content content) {
  return extensions([&](const FileFormat& format) {
    return writes(format) && (content == Content::Mesh || format.fields);
  });
}

/// 0 where it is a folder.
double file_bytes(const std::string& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  return error ? 0 : static_cast<double>(bytes);
}

}  // namespace

MeshData read_input(Session& session, const std::string& path) {
  session.report()["input"] = path;
  MeshData data = session.phase("read", [&] { return read_mesh(path); });
  session.moved("read", file_bytes(path));
  std::visit(
      [&](const auto& held) {
        session.report()["kind"] = words(held.mesh).name;
        session.report()["sizes"] = sizes_to_json(held.mesh);
        session.say(path + ": " + describe_sizes(held.mesh));
      },
      data);
  return data;
}

SurfaceData read_surface_input(Session& session, const std::string& path,
                               const std::string& quantity) {
  MeshData data = read_input(session, path);
  if (std::holds_alternative<VolumeData>(data))
    throw IoError(path + ": is a volume mesh, " + quantity +
                  " is of surfaces; extract its boundary first: carat convert " + path +
                  " boundary.vtp --surface");
  return std::get<SurfaceData>(std::move(data));
}

bool carries_fields(const std::string& path) {
  const FileFormat* const format = writable_format(path);
  return is_page(path) || (format != nullptr && format->fields);
}

bool carries_patches(const std::string& path) {
  const FileFormat* const format = writable_format(path);
  return is_page(path) || (format != nullptr && format->writes_patches);
}

void check_output(const std::string& path, Content content) {
  if (path.empty()) return;
  if (content == Content::Page && !is_page(path))
    throw InvalidOption(path + ": a view is an HTML page; name a file that ends in .html");
  const FileFormat* const format = writable_format(path);
  if (format == nullptr && !is_page(path))
    throw IoError(path + ": the extension '" + fs::path(path).extension().string() +
                  "' is no format that can be written; use one of " + writable_extensions(content));
  if (content == Content::MeshFields && !carries_fields(path))
    throw InvalidOption(path + ": " + format->title +
                        " files carry no fields, the result would be lost; use one of " +
                        writable_extensions(content));
  check_output_folder(path);
}

void check_output_folder(const std::string& path) {
  const fs::path folder =
      fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw IoError(path + ": the folder " + folder.string() + " does not exist; create it first");
  if (fs::is_directory(path, ignored)) throw IoError(path + ": is a folder; name a file");
}

void check_output_kind(const std::string& path, const KindWords& kind) {
  if (path.empty() || is_page(path)) return;
  const FileFormat* const format = writable_format(path);
  const bool volume = kind.name == kVolumeWords.name;
  const auto ability = volume ? &FileFormat::writes_volumes : &FileFormat::writes;
  if (format == nullptr || format->*ability) return;
  throw InvalidOption(path + ": " + format->title + " files are not written with " + kind.plural +
                      "; use one of " +
                      extensions([&](const FileFormat& other) { return other.*ability; }) +
                      (volume ? ", or the boundary alone: carat convert --surface" : ""));
}

void write_output(Session& session, const std::string& path, const std::string& title,
                  const MeshData& data) {
  if (path.empty()) return;
  session.phase("write", [&] {
    if (is_page(path)) {
      write_html_view(path, {{title, data}}, title);
    } else if (const auto* const volume = std::get_if<VolumeData>(&data)) {
      write_volume(path, volume->mesh, volume->fields, volume->patches);
    } else {
      const SurfaceData& surface = std::get<SurfaceData>(data);
      write_surface(path, surface.mesh, surface.fields);
    }
  });
  session.moved("write", file_bytes(path));
  session.report()["output"] = path;
  session.say("written: " + path);
}

Field scalar_field(const std::string& name, const Vector& values) {
  return {name, 1, {values.data(), values.data() + values.size()}};
}

Field vector_field(const std::string& name, const Points& vectors) {
  return {name, 3, {vectors.data(), vectors.data() + vectors.size()}};
}

Extremes extremes(const Vector& values) {
  Extremes found;
  for (Index v = 0; v < values.size(); ++v) {
    if (!std::isfinite(values[v])) continue;
    if (found.least_vertex < 0 || values[v] < found.least) {
      found.least = values[v];
      found.least_vertex = v;
    }
    if (found.largest_vertex < 0 || values[v] > found.largest) {
      found.largest = values[v];
      found.largest_vertex = v;
    }
  }
  return found;
}

Json to_json(const Extremes& extremes) {
  if (extremes.least_vertex < 0) return {{"min", nullptr}, {"max", nullptr}};
  return {{"min", extremes.least},
          {"min_vertex", extremes.least_vertex},
          {"max", extremes.largest},
          {"max_vertex", extremes.largest_vertex}};
}

std::string in_words(const Extremes& extremes) {
  if (extremes.least_vertex < 0) return "nowhere defined";
  return text(extremes.least) + " (vertex " + std::to_string(extremes.least_vertex) + ") to " +
         text(extremes.largest) + " (vertex " + std::to_string(extremes.largest_vertex) + ")";
}

}  // namespace carat::cli
