// OpenFOAM: the folder polyMesh with its files points, faces, owner, neighbour and boundary, in
// text or binary, each perhaps packed with gzip.

#include <array>
#include <charconv>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/foam_file.h"
#include "carat/io/format.h"

namespace carat::detail {
namespace {

namespace fs = std::filesystem;

bool has_file(const fs::path& folder, const char* name) {
  std::error_code ignored;
  return fs::is_regular_file(folder / name, ignored) ||
         fs::is_regular_file(folder / (std::string(name) + ".gz"), ignored);
}

bool is_case_file(const fs::path& path) {
  return path.extension() == ".foam" || path.extension() == ".OpenFOAM";
}

/// The folder polyMesh that a path means; empty if it means none.
fs::path find_mesh_folder(const fs::path& path) {
  std::error_code ignored;
  const auto is_mesh = [](const fs::path& folder) {
    return has_file(folder, "faces") && has_file(folder, "owner");
  };
  const fs::path folder = fs::absolute(path, ignored).parent_path();
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && !is_case_file(path)) {
    const bool of_mesh = folder.filename() == "polyMesh" &&
                         (!path.has_extension() || path.extension() == ".gz") && is_mesh(folder);
    return of_mesh ? folder : fs::path();
  }
  const fs::path start = is_folder ? path : folder;
  for (const fs::path& candidate : {start / "constant" / "polyMesh", start / "polyMesh", start})
    if (is_mesh(candidate)) return candidate;
  return {};
}

bool takes_path(const fs::path& path) {
  return is_case_file(path) || !find_mesh_folder(path).empty();
}

/// A file that was taken out of its folder.
bool recognises_openfoam(std::string_view content) {
  FoamTokens tokens(content.substr(0, 4096));
  return tokens.next() == "FoamFile" && tokens.next() == "{";
}

/// Runs `work` and puts the file's name in front of what it throws.
template <class Work>
auto in_file(const char* name, Work&& work) {
  try {
    return work();
  } catch (const IoError& error) {
    throw IoError(std::string(name) + ": " + error.what(), error.elements());
  }
}

struct PatchEntry {
  std::string type;
  std::int64_t start = -1, n_faces = -1;
};

[[noreturn]] void fail_in(const FoamFile& file, const FoamTokens& tokens,
                          const std::string& message) {
  throw IoError(file.line_of(tokens.position()) + message);
}

/// Moves behind the bracket that closes one which is open.
void skip_to_closing(const FoamFile& file, FoamTokens& tokens, std::string_view open) {
  const std::string_view close = open == "{" ? "}" : ")";
  for (int depth = 1; depth > 0;) {
    const std::string_view token = tokens.next();
    if (token.empty()) fail_in(file, tokens, "a bracket is not closed; the file is truncated");
    if (token == open) ++depth;
    if (token == close) --depth;
  }
}

std::int64_t to_number(const FoamFile& file, const FoamTokens& tokens, std::string_view text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || stop != end)
    fail_in(file, tokens, in_quotes(text) + " is not a whole number; correct it");
  return value;
}

/// The dictionary of one patch, whose '{' is read.
PatchEntry read_patch(const FoamFile& file, FoamTokens& tokens) {
  PatchEntry entry;
  for (std::string_view key = tokens.next(); key != "}"; key = tokens.next()) {
    std::string_view value = tokens.next();
    if (key.empty() || value.empty())
      fail_in(file, tokens, "the list of patches ends too early; the file is truncated");
    if (value == "{") {
      skip_to_closing(file, tokens, value);
      continue;
    }
    if (key == "type") entry.type = value;
    if (key == "nFaces") entry.n_faces = to_number(file, tokens, value);
    if (key == "startFace") entry.start = to_number(file, tokens, value);
    for (; value != ";"; value = tokens.next()) {
      if (value.empty() || value == "}") fail_in(file, tokens, "';' is missing behind an entry");
      if (value == "(") skip_to_closing(file, tokens, value);
    }
  }
  return entry;
}

/// \param taken  faces of the patches so far
BoundaryPatch to_patch(std::string name, const PatchEntry& entry, const PolyhedralMesh& mesh,
                       std::vector<bool>& taken) {
  const std::int64_t n = mesh.n_faces();
  if (entry.start < 0 || entry.n_faces < 0 || entry.n_faces > n || entry.start > n - entry.n_faces)
    throw IoError("patch " + in_quotes(name) + " has " + std::to_string(entry.n_faces) +
                  " faces from " + std::to_string(entry.start) + " on; the mesh has faces 0 to " +
                  std::to_string(n - 1));
  BoundaryPatch patch{std::move(name), entry.type, {}};
  for (auto f = static_cast<Index>(entry.start); f < entry.start + entry.n_faces; ++f) {
    const auto i = static_cast<std::size_t>(f);
    if (taken[i] || !mesh.face_cells()[i].boundary())
      throw IoError("patch " + in_quotes(patch.name) + " has face " + std::to_string(f) +
                    ", which is " + (taken[i] ? "in another patch" : "not on the boundary") +
                    "; correct nFaces and startFace");
    taken[i] = true;
    patch.faces.push_back(f);
  }
  return patch;
}

std::vector<BoundaryPatch> read_patches(const fs::path& folder, const PolyhedralMesh& mesh) {
  const FoamFile file(folder, "boundary");
  FoamTokens tokens(file.body());
  to_number(file, tokens, tokens.next());
  if (tokens.next() != "(") fail_in(file, tokens, "'(' is missing; the file is damaged");
  std::vector<BoundaryPatch> patches;
  std::vector<bool> taken(static_cast<std::size_t>(mesh.n_faces()));
  for (std::string_view name = tokens.next(); name != ")"; name = tokens.next()) {
    if (name.empty() || tokens.next() != "{")
      fail_in(file, tokens, "the list of patches ends too early; the file is truncated or damaged");
    std::string text(name);
    const PatchEntry entry = read_patch(file, tokens);
    patches.push_back(to_patch(std::move(text), entry, mesh, taken));
  }
  return patches;
}

MeshData read_openfoam(const FileContent& content) {
  const fs::path folder = find_mesh_folder(content.path);
  if (folder.empty())
    throw IoError(
        "is of an OpenFOAM case, but no folder polyMesh with faces and owner is beside it; name "
        "the "
        "case's folder");
  Points points = in_file("points", [&] { return FoamFile(folder, "points").read_vectors(); });
  Csr faces = in_file("faces", [&] { return FoamFile(folder, "faces").read_faces(); });
  const auto n_faces = static_cast<std::int64_t>(faces.offsets.size()) - 1;
  const auto read_cells = [&](const char* name) {
    return in_file(name, [&] { return FoamFile(folder, name).read_labels(n_faces); });
  };
  const Array<Index> owner = read_cells("owner");
  Array<Index> neighbour = read_cells("neighbour");
  // Old versions fill the list up for the boundary.
  while (!neighbour.empty() && neighbour.back() == -1) neighbour.pop_back();
  VolumeData data{
      PolyhedralMesh::from_owner_neighbour(std::move(points), std::move(faces), owner, neighbour),
      {}};
  if (has_file(folder, "boundary"))
    data.patches = in_file("boundary", [&] { return read_patches(folder, data.mesh); });
  return data;
}

}  // namespace

FormatEntry openfoam_format() {
  FileFormat format{"openfoam", "OpenFOAM polyMesh", {".foam"}, false, false, false, true, false,
                    false};
  return {.format = std::move(format),
          .recognises = recognises_openfoam,
          .read = read_openfoam,
          .takes_path = takes_path};
}

}  // namespace carat::detail
