// carat convert: from one format to another, with the dual and triangulation on the way.

#include <CLI/CLI.hpp>
#include <memory>

#include "carat/mesh/transform.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
  bool dual = false, triangulate = false;
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

void run(Session& session, const Options& options) {
  check_output(options.output, Content::Mesh);
  SurfaceData data = read_input(session, options.input);
  if (options.dual) data = session.phase("dual", [&] { return to_dual(session, std::move(data)); });
  if (options.triangulate)
    data = session.phase("triangulate", [&] { return to_triangles(std::move(data)); });
  if (!carries_fields(options.output)) {
    const std::string reason = options.output + " is of a format without fields";
    drop(session, data.fields.vertex, reason);
    drop(session, data.fields.face, reason);
  }
  report_sizes(session, "output_sizes", data.mesh);
  if (options.dual || options.triangulate)
    session.say("now " + count(data.mesh.n_vertices(), "vertex") + ", " +
                count(data.mesh.n_edges(), "edge") + ", " + count(data.mesh.n_faces(), "face"));
  write_output(session, options.output, options.input, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "The mesh to read")->required();
  app.add_option("OUT", options->output, "The file to write; its extension names the format")
      ->required();
  app.add_flag("--dual", options->dual,
               "Write the dual: a vertex a face, a polygon a vertex; the\nboundary is kept");
  app.add_flag("--triangulate", options->triangulate,
               "Cut faces into triangles; with --dual, those of the dual");
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command convert_command = {
    "convert",
    "Convert a mesh to another format, its dual, or triangles",
    "Vertices and faces keep their order. Fields go along where the format has them: with\n"
    "--triangulate faces pass their values on to their triangles, with --dual those of the\n"
    "faces become those of the vertices if the mesh is closed.",
    "  carat convert bunny.obj bunny.ply\n"
    "  carat convert bunny.obj bunny-dual.vtp --dual\n"
    "  carat convert polygons.vtu triangles.stl --triangulate\n",
    false,
    declare};

}  // namespace carat::cli
