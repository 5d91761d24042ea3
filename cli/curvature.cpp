// carat curvature: mean curvature at the vertices.

#include <CLI/CLI.hpp>
#include <limits>
#include <memory>

#include "carat/apps/mean_curvature.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
  bool with_sign = false;
  OperatorOptions discretization;
};

void run(Session& session, const Options& options) {
  check_output(options.output, Content::MeshFields);
  SurfaceData data = read_surface_input(session, options.input, "mean curvature");
  check_output_kind(options.output, words(data.mesh));
  const Discretization discretization =
      discretize(session, data.mesh, options.discretization, DiscretizationParts::Matrices);
  const MeanCurvature curvature = session.phase(
      "solve", [&] { return mean_curvature(data.mesh, discretization, options.with_sign); });

  Diagnostics diagnostics;
  diagnostics.add("undefined_vertices",
                  "vertices where mean curvature is not defined (on the boundary, or without "
                  "area): their value is 0",
                  curvature.undefined_vertices);
  session.add_diagnostics(diagnostics);
  Vector defined = curvature.values;
  for (const Index v : curvature.undefined_vertices)
    defined[v] = std::numeric_limits<double>::quiet_NaN();
  session.report()["signed"] = options.with_sign;
  session.report()["mean_curvature"] = to_json(extremes(defined));
  session.say(std::string("mean curvature") +
              (options.with_sign ? " (signed): " : " (unsigned): ") + in_words(extremes(defined)));
  data.fields.vertex = {scalar_field("mean_curvature", curvature.values)};
  data.fields.face.clear();
  write_output(session, options.output, "Mean curvature", std::move(data));
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_flag("--signed", options->with_sign,
               "Positive where the surface bends away from its normals:\n"
               "+1/R on a sphere of radius R with outward normals");
  app.add_option("-o,--output", options->output,
                 "File for the mesh with the field mean_curvature, or a\n"
                 "view (.html); without it nothing is written");
  declare_operator_options(app, options->discretization, Application::MeanCurvature);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command curvature_command = {
    "curvature",
    "Mean curvature at the vertices",
    "H = |M^-1 L x| / 2, in 1/length. At the boundary it is not defined; there it is 0.",
    "  carat curvature bunny.obj --signed -o curvature.html\n"
    "  carat curvature mesh.ply -o curvature.vtp\n"
    "  carat curvature mesh.ply --operator bunge --lumped --json\n",
    true,
    declare};

}  // namespace carat::cli
