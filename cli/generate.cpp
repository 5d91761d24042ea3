// carat generate: a mesh of a family.

#include <CLI/CLI.hpp>
#include <memory>

#include "carat/generators/families.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

struct Options {
  std::string family, output;
  FamilyOptions shape;
};

void run(Session& session, const Options& options) {
  check_output(options.output, Content::Mesh);
  session.report()["input"] = nullptr;
  session.report()["family"] = options.family;
  session.report()["options"] = {{"level", options.shape.level},
                                 {"jitter", options.shape.jitter},
                                 {"anisotropy", options.shape.anisotropy},
                                 {"seed", options.shape.seed}};
  SurfaceData data;
  data.mesh =
      session.phase("generate", [&] { return generate_mesh(options.family, options.shape); });
  report_sizes(session, "sizes", data.mesh);
  session.say(options.family + ", level " + std::to_string(options.shape.level) + ": " +
              count(data.mesh.n_vertices(), "vertex") + ", " + count(data.mesh.n_edges(), "edge") +
              ", " + count(data.mesh.n_faces(), "face"));
  write_output(session, options.output, options.family, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("FAMILY", options->family, "The mesh family; see carat list families")->required();
  app.add_option("--level", options->shape.level, "Each level halves the edge length; 0, 1, 2, ...")
      ->required();
  app.add_option("--jitter", options->shape.jitter,
                 "Random displacement of inner vertices, 0 to 0.5 of the\nshortest edge at each")
      ->capture_default_str();
  app.add_option("--anisotropy", options->shape.anisotropy,
                 "1 or more: vertices are drawn together along one\ndirection")
      ->capture_default_str();
  app.add_option("--seed", options->shape.seed, "Of everything random")->capture_default_str();
  app.add_option("-o,--output", options->output, "File to write, or a view where it ends in .html")
      ->required();
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command generate_command = {
    "generate",
    "Make a mesh of a family with known geometry",
    "Boundaries of the unit square, the unit sphere and the torus are met exactly.\n"
    "The same options give the same mesh on every machine.",
    "  carat generate sphere-hexagons --level 4 -o sphere.ply\n"
    "  carat generate plane-voronoi --level 3 --jitter 0.2 --seed 7 -o plane.vtp\n"
    "  carat generate plane-quads --level 5 --anisotropy 8 -o graded.obj\n",
    false,
    declare};

}  // namespace carat::cli
