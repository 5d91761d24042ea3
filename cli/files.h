#pragma once
// Meshes and results between files and commands.

#include <string>

#include "carat/io/mesh_file.h"
#include "cli/mesh_kinds.h"
#include "cli/session.h"

namespace carat::cli {

/// Reads a mesh as the phase "read" and reports its name, kind and sizes.
MeshData read_input(Session& session, const std::string& path);

/// The same for commands that know surfaces only.
/// \param quantity  what they compute, for the message, e.g. "mean curvature"
/// \throws IoError  a volume mesh; says how to extract its boundary
SurfaceData read_surface_input(Session& session, const std::string& path,
                               const std::string& quantity);

/// What is in a file that is about to be written.
enum class Content {
  Mesh,        ///< fields are welcome
  MeshFields,  ///< pointless without fields
  Page,        ///< a view
};

/// Refuses a file that could not be written in the end, before work is spent on it.
/// \throws IoError        unknown extension; the folder is missing
/// \throws InvalidOption  a format without fields where they matter
void check_output(const std::string& path, Content content);

/// Refuses a path whose folder is missing, or that is one.
/// \throws IoError
void check_output_folder(const std::string& path);

/// Refuses a format that cannot hold this kind of mesh. To be called as soon as the kind is known.
/// \throws InvalidOption  names the formats that can
void check_output_kind(const std::string& path, const KindWords& kind);

/// Writes a mesh with fields, or a view of it where the extension is .html, as the phase "write".
/// An empty path writes nothing.
void write_output(Session& session, const std::string& path, const std::string& title,
                  const MeshData& data);

/// Whether the format of that extension carries fields, boundary patches.
bool carries_fields(const std::string& path);
bool carries_patches(const std::string& path);

/// One value a row as a field.
Field scalar_field(const std::string& name, const Vector& values);
/// One vector a row as a field.
Field vector_field(const std::string& name, const Points& vectors);

/// The extremes of finite values and the lowest vertices where they are; -1: there are none.
struct Extremes {
  double least = 0, largest = 0;
  std::int64_t least_vertex = -1, largest_vertex = -1;
};
Extremes extremes(const Vector& values);
/// As an object for JSON.
Json to_json(const Extremes& extremes);
/// As words, e.g. "0 (vertex 3) to 3.1 (vertex 17)".
std::string in_words(const Extremes& extremes);

}  // namespace carat::cli
