// carat convert: from one format to another, with the dual, triangulation or the boundary on the
// way.

#include <CLI/CLI.hpp>
#include <memory>

#include "carat/base/error.h"
#include "carat/mesh/transform.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
  bool dual = false, triangulate = false, surface = false;
};

void drop(Session& session, std::vector<Field>& fields, const std::string& reason) {
  std::string names;
  for (const Field& field : fields) names += (names.empty() ? "" : ", ") + field.name;
  if (!fields.empty()) session.note("dropped " + names + ": " + reason);
  fields.clear();
}

SurfaceData to_dual(Session& session, SurfaceData data) {
  SurfaceData dual{dual_mesh(data.mesh), {}};
  drop(session, data.fields.vertex, "the dual has other faces than the mesh has vertices");
  if (dual.mesh.n_vertices() != data.mesh.n_faces())
    drop(session, data.fields.face, "the dual has vertices on the boundary beside the faces");
  dual.fields.vertex = std::move(data.fields.face);
  return dual;
}

Field select_rows(const Field& field, const std::vector<Index>& rows) {
  const auto width = static_cast<std::size_t>(field.components);
  Field selected{field.name, field.components, {}};
  selected.values.reserve(rows.size() * width);
  for (const Index row : rows) {
    const auto first = field.values.begin() + static_cast<std::ptrdiff_t>(row) * field.components;
    selected.values.insert(selected.values.end(), first, first + field.components);
  }
  return selected;
}

SurfaceData to_triangles(SurfaceData data) {
  std::vector<Index> source_faces;
  data.mesh = triangulate(data.mesh, &source_faces);
  for (Field& field : data.fields.face) field = select_rows(field, source_faces);
  return data;
}

Field id_field(const std::string& name, const std::vector<Index>& ids) {
  return {name, 1, {ids.begin(), ids.end()}};
}

/// Boundary face -> number of its patch, -1 without one.
std::vector<Index> patch_numbers(const VolumeData& data, const std::vector<Index>& faces) {
  std::vector<Index> of_face(static_cast<std::size_t>(data.mesh.n_faces()), -1);
  for (std::size_t p = 0; p < data.patches.size(); ++p)
    for (const Index f : data.patches[p].faces)
      of_face[static_cast<std::size_t>(f)] = static_cast<Index>(p);
  std::vector<Index> numbers;
  for (const Index f : faces) numbers.push_back(of_face[static_cast<std::size_t>(f)]);
  return numbers;
}

/// The boundary with the values of its vertices and of the cells behind its faces.
SurfaceData to_boundary(Session& session, const VolumeData& data) {
  BoundarySurface boundary = boundary_surface(data.mesh);
  SurfaceData surface{std::move(boundary.mesh), {}};
  std::vector<Index> cells;
  for (const Index f : boundary.face_ids)
    cells.push_back(data.mesh.face_cells()[static_cast<std::size_t>(f)].other(-1));
  for (const Field& field : data.fields.vertex)
    surface.fields.vertex.push_back(select_rows(field, boundary.vertex_ids));
  for (const Field& field : data.fields.cell)
    surface.fields.face.push_back(select_rows(field, cells));
  const auto add = [](std::vector<Field>& fields, Field ids) {
    std::erase_if(fields, [&](const Field& field) { return field.name == ids.name; });
    fields.push_back(std::move(ids));
  };
  add(surface.fields.vertex, id_field("vertex_id", boundary.vertex_ids));
  add(surface.fields.face, id_field("face_id", boundary.face_ids));
  add(surface.fields.face, id_field("cell_id", cells));
  if (!data.patches.empty()) {
    add(surface.fields.face, id_field("patch", patch_numbers(data, boundary.face_ids)));
    Json& names = session.report()["patches"] = Json::array();
    for (const BoundaryPatch& patch : data.patches) names.push_back(patch.name);
    for (std::size_t p = 0; p < data.patches.size(); ++p)
      session.say("patch " + std::to_string(p) + ": " + data.patches[p].name);
  }
  return surface;
}

/// The dual and the triangles of a surface.
SurfaceData transform(Session& session, const Options& options, SurfaceData data) {
  if (options.surface)
    session.note(options.input + " is a surface already; --surface changes nothing");
  if (options.dual) data = session.phase("dual", [&] { return to_dual(session, std::move(data)); });
  if (options.triangulate)
    data = session.phase("triangulate", [&] { return to_triangles(std::move(data)); });
  return data;
}

/// The boundary of a volume, with what can be done to surfaces after it, or the volume itself.
MeshData transform(Session& session, Options options, VolumeData data) {
  if (options.surface) {
    options.surface = false;
    SurfaceData boundary = session.phase("boundary", [&] { return to_boundary(session, data); });
    return transform(session, options, std::move(boundary));
  }
  if (options.dual || options.triangulate)
    throw InvalidOption(std::string(options.dual ? "--dual" : "--triangulate") +
                        " is for surfaces and " + options.input +
                        " is a volume mesh; add --surface for its boundary");
  return data;
}

/// Says what the format of the output cannot hold.
template <class Data>
void drop_what_is_lost(Session& session, const Options& options, Data& data) {
  if (!carries_fields(options.output)) {
    const std::string reason = options.output + " is of a format without fields";
    drop(session, data.fields.vertex, reason);
    drop(session, element_fields(data), reason);
  }
  std::string names;
  for (const BoundaryPatch& patch : patches(data))
    names += (names.empty() ? "" : ", ") + patch.name;
  if (!names.empty() && !carries_patches(options.output))
    session.note("dropped the boundary patches " + names + ": " + options.output +
                 " is of a format without patches");
}

void run(Session& session, const Options& options) {
  check_output(options.output, Content::Mesh);
  MeshData data = std::visit(
      [&](auto&& held) -> MeshData { return transform(session, options, std::move(held)); },
      read_input(session, options.input));
  std::visit(
      [&](auto& held) {
        check_output_kind(options.output, words(held.mesh));
        drop_what_is_lost(session, options, held);
        session.report()["output_kind"] = words(held.mesh).name;
        session.report()["output_sizes"] = sizes_to_json(held.mesh);
        if (options.dual || options.triangulate || options.surface)
          session.say("now " + describe_sizes(held.mesh));
      },
      data);
  write_output(session, options.output, options.input, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "The mesh to read")->required();
  app.add_option("OUT", options->output, "The file to write; its extension names the format")
      ->required();
  app.add_flag("--surface", options->surface,
               "Write the boundary of a volume mesh as a surface, with its\n"
               "fields and the fields vertex_id, face_id, cell_id (numbers\n"
               "in the volume) and, where it has patches, patch");
  app.add_flag("--dual", options->dual,
               "Write the dual: a vertex a face, a polygon a vertex; the\nboundary is kept");
  app.add_flag("--triangulate", options->triangulate,
               "Cut faces into triangles; with --dual, those of the dual");
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command convert_command = {
    "convert",
    "Convert a mesh to another format, its boundary, its dual, or triangles",
    "Vertices, faces and cells keep their order. Fields go along where the format has them: with\n"
    "--triangulate faces pass their values on to their triangles, with --dual those of the\n"
    "faces become those of the vertices if the mesh is closed. OVM keeps boundary patches.",
    "  carat convert bunny.obj bunny.ply\n"
    "  carat convert bunny.obj bunny-dual.vtp --dual\n"
    "  carat convert polygons.vtu triangles.ply --triangulate\n"
    "  carat convert ball.ovm ball.vtu\n"
    "  carat convert case/constant/polyMesh boundary.vtp --surface\n",
    false,
    declare};

}  // namespace carat::cli
