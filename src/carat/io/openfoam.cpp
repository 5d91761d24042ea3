// OpenFOAM: the folder polyMesh with its files points, faces, owner, neighbour and boundary, in
// text or binary, each perhaps packed with gzip.

#include "carat/io/openfoam.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/foam_file.h"
#include "carat/io/format.h"
#include "carat/io/with_path.h"

namespace carat {
namespace detail {
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
  return is_case_file(path) || !find_mesh_folder(path).empty() || !foam_processors(path).empty();
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

using PatchEntries = std::vector<std::pair<std::string, PatchEntry>>;

PatchEntries read_patch_entries(const fs::path& folder) {
  const FoamFile file(folder, "boundary");
  FoamTokens tokens(file.body());
  to_number(file, tokens, tokens.next());
  if (tokens.next() != "(") fail_in(file, tokens, "'(' is missing; the file is damaged");
  PatchEntries entries;
  for (std::string_view name = tokens.next(); name != ")"; name = tokens.next()) {
    if (name.empty() || tokens.next() != "{")
      fail_in(file, tokens, "the list of patches ends too early; the file is truncated or damaged");
    std::string text(name);
    entries.emplace_back(std::move(text), read_patch(file, tokens));
  }
  return entries;
}

/// Whether a patch is where two processors meet.
bool between_processors(const PatchEntry& entry) { return entry.type.starts_with("processor"); }

std::vector<BoundaryPatch> read_patches(const fs::path& folder, const PolyhedralMesh& mesh,
                                        bool of_piece) {
  std::vector<BoundaryPatch> patches;
  if (!has_file(folder, "boundary")) return patches;
  in_file("boundary", [&] {
    std::vector<bool> taken(static_cast<std::size_t>(mesh.n_faces()));
    for (auto& [name, entry] : read_patch_entries(folder)) {
      BoundaryPatch patch = to_patch(std::move(name), entry, mesh, taken);
      if (!of_piece || !between_processors(entry)) patches.push_back(std::move(patch));
    }
  });
  return patches;
}

/// The files of a folder polyMesh but for the patches.
struct FoamLists {
  Points points;
  Csr faces;
  Array<Index> owner, neighbour;
  Index n_faces() const { return static_cast<Index>(faces.offsets.size()) - 1; }
};

FoamLists read_lists(const fs::path& folder) {
  FoamLists lists;
  lists.points = in_file("points", [&] { return FoamFile(folder, "points").read_vectors(); });
  lists.faces = in_file("faces", [&] { return FoamFile(folder, "faces").read_faces(); });
  const auto read_cells = [&](const char* name) {
    return in_file(name, [&] { return FoamFile(folder, name).read_labels(lists.n_faces()); });
  };
  lists.owner = read_cells("owner");
  lists.neighbour = read_cells("neighbour");
  // Old versions fill the list up for the boundary.
  while (!lists.neighbour.empty() && lists.neighbour.back() == -1) lists.neighbour.pop_back();
  return lists;
}

PolyhedralMesh to_mesh(FoamLists lists) {
  return PolyhedralMesh::from_owner_neighbour(std::move(lists.points), std::move(lists.faces),
                                              lists.owner, lists.neighbour);
}

/// Numbers in the whole mesh of what a processor has.
struct Addressing {
  std::vector<std::int64_t> points, faces, cells;
  std::vector<bool> turned;  ///< face -> in the whole mesh it points the other way
  bool known = false;
};

Addressing read_addressing(const fs::path& folder, std::int64_t n_points, std::int64_t n_faces,
                           std::int64_t n_cells) {
  Addressing result;
  if (!has_file(folder, "cellProcAddressing")) return result;
  result.known = true;
  const auto read = [&](const char* name, std::int64_t n) {
    return in_file(name, [&] {
      std::vector<std::int64_t> ids = FoamFile(folder, name).read_ids(n);
      if (static_cast<std::int64_t>(ids.size()) != n)
        throw IoError("has " + std::to_string(ids.size()) + " numbers, the mesh needs " +
                      std::to_string(n) + "; divide the case anew");
      return ids;
    });
  };
  const auto check = [](const char* name, const std::vector<std::int64_t>& ids) {
    for (const std::int64_t id : ids)
      if (id < 0)
        throw IoError(std::string(name) + ": has the number " + std::to_string(id) +
                      ", which cannot be; the file is damaged");
  };
  result.points = read("pointProcAddressing", n_points);
  result.cells = read("cellProcAddressing", n_cells);
  result.faces = read("faceProcAddressing", n_faces);
  // Counted from 1, with the sign of the face's direction.
  for (std::int64_t& id : result.faces) {
    result.turned.push_back(id < 0);
    if (id != std::numeric_limits<std::int64_t>::min()) id = std::abs(id) - 1;
  }
  check("pointProcAddressing", result.points);
  check("cellProcAddressing", result.cells);
  check("faceProcAddressing", result.faces);
  return result;
}

fs::path polymesh(const fs::path& processor) { return processor / "constant" / "polyMesh"; }

/// A processor's files.
struct FoamPiece {
  FoamLists lists;
  Addressing ids;
  PolyhedralMesh mesh;
  std::vector<BoundaryPatch> patches;
};

/// Turns faces as they are in the whole mesh, and gives every cell its faces in the order that it
/// has there: those that it owns, then the others, by their numbers.
void order_as_whole(FoamPiece& piece) {
  FoamLists& lists = piece.lists;
  const auto id = [&](Index f) { return piece.ids.faces[static_cast<std::size_t>(f)]; };
  Array<FaceCells> face_cells = piece.mesh.face_cells();
  for (Index f = 0; f < lists.n_faces(); ++f) {
    if (!piece.ids.turned[static_cast<std::size_t>(f)]) continue;
    std::reverse(lists.faces.indices.begin() + lists.faces.begin(f) + 1,
                 lists.faces.indices.begin() + lists.faces.end(f));
    FaceCells& sides = face_cells[static_cast<std::size_t>(f)];
    std::swap(sides.below, sides.above);
  }
  Csr cells = piece.mesh.cells();
  for (Index c = 0; c < cells.n_rows(); ++c) {
    const auto of_neighbour = [&](Index f) {
      const auto i = static_cast<std::size_t>(f);
      return piece.ids.turned[i] || lists.owner[i] != c;
    };
    std::sort(cells.indices.begin() + cells.begin(c), cells.indices.begin() + cells.end(c),
              [&](Index a, Index b) {
                return std::pair(of_neighbour(a), id(a)) < std::pair(of_neighbour(b), id(b));
              });
  }
  piece.mesh = PolyhedralMesh::from_face_cells(piece.mesh.points(), lists.faces, std::move(cells),
                                               std::move(face_cells));
}

/// Faces and cells are as in the whole mesh where the numbers in that are known.
FoamPiece read_foam_files(const fs::path& folder) {
  FoamPiece piece;
  piece.lists = read_lists(folder);
  FoamLists& lists = piece.lists;
  // Faces, points and cells are checked as those of any mesh.
  piece.mesh = to_mesh(lists);
  piece.ids =
      read_addressing(folder, piece.mesh.n_vertices(), piece.mesh.n_faces(), piece.mesh.n_cells());
  piece.patches = read_patches(folder, piece.mesh, true);
  if (piece.ids.known) order_as_whole(piece);
  return piece;
}

/// The mesh of a case from those of all its processors, as OpenFOAM numbers it.
class CaseMerger {
 public:
  explicit CaseMerger(const std::vector<fs::path>& processors) {
    std::size_t n_points = 0, n_faces = 0;
    for (const fs::path& processor : processors) {
      pieces_.push_back(with_path(polymesh(processor), [&] { return read(polymesh(processor)); }));
      n_points += pieces_.back().ids.points.size();
      n_faces += pieces_.back().ids.faces.size();
    }
    // Every number is one of some processor, so there are not more.
    points_.resize(n_points);
    faces_.resize(n_faces);
    for (std::size_t p = 0; p < processors.size(); ++p)
      with_path(polymesh(processors[p]), [&] { add(pieces_[p]); });
    pieces_.clear();
    while (!points_.empty() && !points_.back().known) points_.pop_back();
    while (!faces_.empty() && faces_.back().owner < 0 && faces_.back().neighbour < 0)
      faces_.pop_back();
  }

  VolumeData merge() {
    FoamLists lists;
    lists.points.resize(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (!points_[v].known) fail_missing("point", v);
      for (int k = 0; k < 3; ++k)
        lists.points(static_cast<Eigen::Index>(v), k) = points_[v].at[static_cast<std::size_t>(k)];
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Face& face = faces_[f];
      if (face.owner < 0) fail_missing("face", f);
      lists.faces.indices.insert(lists.faces.indices.end(), face.vertices.begin(),
                                 face.vertices.end());
      lists.faces.offsets.push_back(static_cast<Index>(lists.faces.indices.size()));
      lists.owner.push_back(face.owner);
      if (face.neighbour < 0) continue;
      if (lists.neighbour.size() != f)
        throw IoError("face " + std::to_string(f) +
                      " of the whole mesh lies between cells, but comes behind one of the "
                      "boundary; divide the case anew");
      lists.neighbour.push_back(face.neighbour);
    }
    VolumeData data{to_mesh(std::move(lists)), {}, std::move(patches_)};
    for (BoundaryPatch& patch : data.patches) {
      std::sort(patch.faces.begin(), patch.faces.end());
      for (const Index f : patch.faces)
        if (!data.mesh.face_cells()[static_cast<std::size_t>(f)].boundary())
          throw IoError("patch " + in_quotes(patch.name) + " has face " + std::to_string(f) +
                        " of the whole mesh, which is not on the boundary; divide the case anew");
    }
    return data;
  }

 private:
  struct Point {
    std::array<double, 3> at{};
    bool known = false;
  };
  struct Face {
    std::vector<Index> vertices;
    Index owner = -1, neighbour = -1;
  };

  [[noreturn]] static void fail_missing(const char* what, std::size_t number) {
    throw IoError(std::string(what) + " " + std::to_string(number) +
                  " of the whole mesh is on no processor; a folder is missing, divide the case "
                  "anew");
  }

  template <class Element>
  static Element& at(std::vector<Element>& list, std::int64_t id) {
    if (static_cast<std::uint64_t>(id) >= list.size())
      throw IoError("has the number " + std::to_string(id) + " in the whole mesh, which all " +
                    "processors together cannot have; a folder is missing or damaged");
    return list[static_cast<std::size_t>(id)];
  }

  static FoamPiece read(const fs::path& folder) {
    FoamPiece piece = read_foam_files(folder);
    if (!piece.ids.known)
      throw IoError(
          "is of a divided case, but has no cellProcAddressing, so that one process cannot put it "
          "together; reconstruct the mesh (reconstructParMesh -constant), or read it by as many "
          "processes");
    return piece;
  }

  void add(const FoamPiece& piece) {
    const Addressing& ids = piece.ids;
    const auto numbers = [](const std::vector<std::int64_t>& list, Index i) {
      const std::int64_t id = list[static_cast<std::size_t>(i)];
      if (id >= std::numeric_limits<Index>::max())
        throw IoError("has the number " + std::to_string(id) +
                      " in the whole mesh; one process can read up to 2^31 - 1");
      return static_cast<Index>(id);
    };
    for (Index v = 0; v < piece.mesh.n_vertices(); ++v)
      at(points_, numbers(ids.points, v)) = {
          {piece.mesh.points()(v, 0), piece.mesh.points()(v, 1), piece.mesh.points()(v, 2)}, true};
    for (Index f = 0; f < piece.lists.n_faces(); ++f) {
      const auto i = static_cast<std::size_t>(f);
      Face& face = at(faces_, numbers(ids.faces, f));
      face.vertices.clear();
      for (const Index v : piece.lists.faces.row(f))
        face.vertices.push_back(numbers(ids.points, v));
      const Index owner = numbers(ids.cells, piece.lists.owner[i]);
      (ids.turned[i] ? face.neighbour : face.owner) = owner;
      if (i < piece.lists.neighbour.size())
        face.neighbour = numbers(ids.cells, piece.lists.neighbour[i]);
    }
    for (const BoundaryPatch& patch : piece.patches) {
      auto known = std::find_if(patches_.begin(), patches_.end(),
                                [&](const BoundaryPatch& p) { return p.name == patch.name; });
      if (known == patches_.end()) known = patches_.insert(known, {patch.name, patch.type, {}});
      for (const Index f : patch.faces) known->faces.push_back(numbers(ids.faces, f));
    }
  }

  std::vector<FoamPiece> pieces_;
  std::vector<Point> points_;
  std::vector<Face> faces_;
  std::vector<BoundaryPatch> patches_;
};

MeshData read_openfoam(const FileContent& content) {
  const fs::path folder = find_mesh_folder(content.path);
  if (folder.empty()) {
    const std::vector<fs::path> processors = foam_processors(content.path);
    if (!processors.empty()) return CaseMerger(processors).merge();
    throw IoError(
        "is of an OpenFOAM case, but no folder polyMesh with faces and owner is beside it; name "
        "the case's folder");
  }
  VolumeData data{to_mesh(read_lists(folder)), {}};
  data.patches = read_patches(folder, data.mesh, false);
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

}  // namespace detail

std::vector<std::filesystem::path> foam_processors(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (!is_folder && !detail::is_case_file(path)) return {};
  const std::filesystem::path folder =
      is_folder ? path : std::filesystem::absolute(path, ignored).parent_path();
  std::vector<std::filesystem::path> processors;
  for (;;) {
    const auto next = folder / ("processor" + std::to_string(processors.size()));
    // One without a mesh is missed when it is read.
    if (!std::filesystem::is_directory(processors.empty() ? detail::polymesh(next) : next, ignored))
      return processors;
    processors.push_back(next);
  }
}

MeshPiece<PolyhedralMesh> read_foam_piece(const std::filesystem::path& folder) {
  return detail::with_path(detail::polymesh(folder), [&] {
    detail::FoamPiece files = detail::read_foam_files(detail::polymesh(folder));
    MeshPiece<PolyhedralMesh> piece;
    piece.mesh = std::move(files.mesh);
    piece.patches = std::move(files.patches);
    piece.vertex_ids = std::move(files.ids.points);
    piece.element_ids = std::move(files.ids.cells);
    piece.interface_ids = std::move(files.ids.faces);
    return piece;
  });
}

}  // namespace carat
