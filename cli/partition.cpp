// carat partition: parts of a mesh for several processes.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "carat/base/error.h"
#include "carat/mesh/mesh_part.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/mesh_kinds.h"
#if defined(CARAT_WITH_SCOTCH)
#include "carat/distributed/partition.h"
#endif

namespace carat::cli {
namespace {

struct Options {
  std::string input, folder;
  Index parts = 0;
};

template <class Mesh>
std::vector<Index> parts_of(const Mesh& mesh, Index n_parts) {
#if defined(CARAT_WITH_SCOTCH)
  return carat::partition(mesh, n_parts);
#else
  static_cast<void>(mesh);
  static_cast<void>(n_parts);
  throw InvalidOption(
      "this program was built without Scotch, which chooses the parts; install it (Debian: "
      "libscotch-dev) and build again");
#endif
}

template <class Numbers>
Field number_field(const std::string& name, const Numbers& numbers) {
  return {name, 1, {numbers.begin(), numbers.end()}};
}

void write_part(const std::string& path, const PolygonMesh& mesh, const MeshFields& fields) {
  write_surface(path, mesh, fields);
}
void write_part(const std::string& path, const PolyhedralMesh& mesh, const MeshFields& fields) {
  write_volume(path, mesh, fields);
}
std::vector<Field>& element_fields(MeshFields& fields, const PolygonMesh&) { return fields.face; }
std::vector<Field>& element_fields(MeshFields& fields, const PolyhedralMesh&) {
  return fields.cell;
}
const char* extension(const PolygonMesh&) { return ".vtp"; }
const char* extension(const PolyhedralMesh&) { return ".vtu"; }

/// \throws IoError
void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directory(path, error);
  if (!std::filesystem::is_directory(path))
    throw IoError(path + ": the folder cannot be made" +
                  (error ? ": " + error.message() : std::string()) + "; name another");
}

template <class Mesh>
void divide_mesh(Session& session, const Options& options, const Mesh& mesh) {
  const KindWords& kind = words(mesh);
  const MeshDivision division = session.phase(
      "partition", [&] { return divide(mesh, options.parts, parts_of(mesh, options.parts)); });
  Json& report = session.report();
  const std::string sides = std::string(kind.side) + "s";
  report["imbalance"] = division.imbalance();
  report["cut_" + sides] = division.n_cut_interfaces;
  report["parts"] = Json::array();
  session.say(count(options.parts, "part") + ": " + count(division.n_cut_interfaces, kind.side) +
              " cut, the largest part " + text(division.imbalance()) + " of the mean");
  for (Index p = 0; p < options.parts; ++p) {
    const MeshPart<Mesh> part = part_of(mesh, division, p);
    const PartNumbers& numbers = part.numbers;
    const Index n_own = division.elements.size(p);
    Json entry = {{"own_" + std::string(kind.element) + "s", n_own},
                  {"halo_" + std::string(kind.element) + "s", n_elements(part.mesh) - n_own},
                  {"own_vertices", numbers.end_row - numbers.first_row}};
    if (!options.folder.empty()) {
      MeshFields fields;
      fields.vertex = {number_field("vertex_id", numbers.vertices),
                       number_field("row", numbers.vertex_rows),
                       number_field("component", numbers.vertex_components)};
      std::vector<Index> parts;
      for (const Index element : numbers.elements) parts.push_back(division.element_part[element]);
      element_fields(fields, part.mesh) = {
          number_field(std::string(kind.element) + "_id", numbers.elements),
          number_field("part", parts)};
      const std::string path =
          (std::filesystem::path(options.folder) / ("part_" + std::to_string(p))).string() +
          extension(mesh);
      session.phase("write", [&] { write_part(path, part.mesh, fields); });
      entry["output"] = path;
    }
    session.say("part " + std::to_string(p) + ": " + count(n_own, kind.element) + ", halo of " +
                std::to_string(n_elements(part.mesh) - n_own) + ", " +
                count(numbers.end_row - numbers.first_row, "vertex"));
    report["parts"].push_back(std::move(entry));
  }
  if (!options.folder.empty()) session.say("written: " + options.folder);
}

void run(Session& session, const Options& options) {
  if (!options.folder.empty()) make_folder(options.folder);
  const MeshData data = read_input(session, options.input);
  std::visit([&](const auto& held) { divide_mesh(session, options, held.mesh); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("-n,--parts", options->parts, "How many parts")
      ->required()
      ->check(CLI::Range(1, 1000000));
  app.add_option("-o,--output", options->folder,
                 "Folder for the parts, part_0.vtp, part_1.vtp, ..., of\n"
                 "volumes .vtu; without it nothing is written")
      ->type_name("DIR");
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command partition_command = {
    "partition",
    "Divide a mesh into parts for several processes",
    "Parts are about equally large, and few edges, of volumes faces, lie between them. A part "
    "holds\n"
    "its own faces or cells and a halo of those across from them. Fields: vertex_id, face_id or\n"
    "cell_id, as in the mesh; part, whose own an element is; row, the number of a vertex by "
    "parts;\n"
    "component, of the whole mesh. Takes Scotch.",
    "  carat partition mesh.ply -n 4\n"
    "  carat partition ball.vtu -n 8 -o parts\n",
    false,
    declare};

}  // namespace carat::cli
