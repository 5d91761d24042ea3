// carat partition: parts of a mesh for several processes.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "carat/base/error.h"
#include "carat/distributed/part_file.h"
#include "carat/io/parallel_vtk.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/mesh_kinds.h"
#if defined(CARAT_WITH_SCOTCH)
#include "carat/distributed/partition.h"
#endif

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
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

void write_part(const std::string& path, const PartData<PolygonMesh>& data,
                const MeshFields& fields) {
  write_surface(path, data.part.mesh, fields);
}
void write_part(const std::string& path, const PartData<PolyhedralMesh>& data,
                const MeshFields& fields) {
  write_volume(path, data.part.mesh, fields);
}
std::vector<Field>& element_fields(MeshFields& fields, const PolygonMesh&) { return fields.face; }
std::vector<Field>& element_fields(MeshFields& fields, const PolyhedralMesh&) {
  return fields.cell;
}
const char* extension(const PolygonMesh&) { return ".vtp"; }
const char* extension(const PolyhedralMesh&) { return ".vtu"; }

bool is_part_file(const std::string& path) {
  return std::filesystem::path(path).extension() == ".cparts";
}

/// Puts fields in front of others, of which those with their names go.
void prepend(std::vector<Field>& fields, std::vector<Field> first) {
  for (Field& field : fields) {
    const bool named = std::any_of(first.begin(), first.end(),
                                   [&](const Field& other) { return other.name == field.name; });
    if (!named) first.push_back(std::move(field));
  }
  fields = std::move(first);
}

std::vector<FieldShape> shapes_of(const std::vector<Field>& fields) {
  std::vector<FieldShape> shapes;
  for (const Field& field : fields) shapes.push_back({field.name, field.components});
  return shapes;
}

/// \throws IoError
void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directory(path, error);
  if (!std::filesystem::is_directory(path))
    throw IoError(path + ": the folder cannot be made" +
                  (error ? ": " + error.message() : std::string()) + "; name another");
}

/// The files of the parts, one after the other.
template <class Mesh>
class PartWriter {
 public:
  PartWriter(const std::string& folder, const Mesh& mesh)
      : folder_(folder), extension_(extension(mesh)), id_(words(mesh).element) {
    make_folder(folder);
  }

  /// \return  its path
  std::string write(PartData<Mesh> data, const MeshDivision& division) {
    const PartNumbers& numbers = data.part.numbers;
    MeshFields fields = std::move(data.fields);
    prepend(fields.vertex,
            {number_field("vertex_id", numbers.vertices), number_field("row", numbers.vertex_rows),
             number_field("component", numbers.vertex_components)});
    std::vector<Index> parts;
    for (const Index element : numbers.elements) parts.push_back(division.element_part[element]);
    std::vector<bool> ghosts = numbers.own_elements;
    ghosts.flip();
    std::vector<Field>& of_elements = element_fields(fields, data.part.mesh);
    prepend(of_elements, {number_field(id_ + "_id", numbers.elements), number_field("part", parts),
                          number_field(kGhostField, ghosts)});
    pieces_.push_back("part_" + std::to_string(pieces_.size()) + extension_);
    const std::string path = (std::filesystem::path(folder_) / pieces_.back()).string();
    write_part(path, data, fields);
    vertex_fields_ = shapes_of(fields.vertex);
    element_fields_ = shapes_of(of_elements);
    return path;
  }

  /// \return  the path of the index
  std::string write_index() const {
    const std::string name = "mesh.p" + extension_.substr(1);
    const auto path = std::filesystem::path(folder_) / name;
    write_parallel_index(path, pieces_, vertex_fields_, element_fields_, 1);
    return path.string();
  }

 private:
  std::string folder_, extension_, id_;
  std::vector<std::string> pieces_;
  std::vector<FieldShape> vertex_fields_, element_fields_;
};

void note_lost_patches(Session&, const Options&, const SurfaceData&) {}
void note_lost_patches(Session& session, const Options& options, const VolumeData& data) {
  std::string names;
  for (const BoundaryPatch& patch : data.patches) names += (names.empty() ? "" : ", ") + patch.name;
  if (!names.empty())
    session.note("dropped the boundary patches " + names + ": the files in " + options.output +
                 " are of a format without patches; a file .cparts keeps them");
}

template <class Data>
void divide_mesh(Session& session, const Options& options, const Data& data) {
  const auto& mesh = data.mesh;
  using Mesh = std::decay_t<decltype(mesh)>;
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
  const bool one_file = is_part_file(options.output);
  std::optional<PartWriter<Mesh>> writer;
  if (!options.output.empty() && !one_file) writer.emplace(options.output, mesh);
  for (Index p = 0; p < options.parts; ++p) {
    PartData<Mesh> part;
    if (writer) {
      part = part_data_of(data, division, p);
    } else {
      part.part = part_of(mesh, division, p);
    }
    const PartNumbers& numbers = part.part.numbers;
    const Index n_own = division.elements.size(p), n_vertices = numbers.end_row - numbers.first_row;
    const Index n_halo = n_elements(part.part.mesh) - n_own;
    Json entry = {{"own_" + std::string(kind.element) + "s", n_own},
                  {"halo_" + std::string(kind.element) + "s", n_halo},
                  {"own_vertices", n_vertices}};
    if (writer)
      session.phase("write", [&] { entry["output"] = writer->write(std::move(part), division); });
    session.say("part " + std::to_string(p) + ": " + count(n_own, kind.element) + ", halo of " +
                std::to_string(n_halo) + ", " + count(n_vertices, "vertex"));
    report["parts"].push_back(std::move(entry));
  }
  if (options.output.empty()) return;
  if (writer) note_lost_patches(session, options, data);
  report["output"] = session.phase("write", [&] {
    if (writer) return writer->write_index();
    write_part_file(options.output, data, division);
    return options.output;
  });
  session.say("written: " + options.output);
}

void run(Session& session, const Options& options) {
  if (is_part_file(options.output)) check_output_folder(options.output);
  const MeshData data = read_input(session, options.input);
  std::visit([&](const auto& held) { divide_mesh(session, options, held); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("-n,--parts", options->parts, "How many parts")
      ->required()
      ->check(CLI::Range(1, 1000000));
  app.add_option("-o,--output", options->output,
                 "FILE.cparts: all parts in one file, with fields and boundary patches.\n"
                 "Else a folder: part_0.vtp, part_1.vtp, ... with fields, of volumes .vtu,\n"
                 "and mesh.pvtp or mesh.pvtu, which names them all.\n"
                 "Without it nothing is written")
      ->type_name("PATH");
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command partition_command = {
    "partition",
    "Divide a mesh into parts for several processes",
    "Parts are about equally large, and few edges, of volumes faces, lie between them. A part "
    "holds\n"
    "its own faces or cells and a halo of those across from them (vtkGhostType). Fields, beside "
    "those\n"
    "of the mesh: vertex_id, face_id or cell_id, as in the mesh; part, whose own an element is; "
    "row,\n"
    "the number of a vertex by parts; component, of the whole mesh. Takes Scotch.",
    "  carat partition mesh.ply -n 4\n"
    "  carat partition ball.vtu -n 8 -o ball.cparts\n"
    "  carat partition ball.vtu -n 8 -o parts && carat view parts/mesh.pvtu\n",
    false,
    declare};

}  // namespace carat::cli
