// carat generate: a mesh of a family.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

struct Options {
  std::string family, output;
  FamilyOptions shape;
};

template <class Mesh>
bool is_in(const std::vector<FamilyEntryOf<Mesh>>& families, const std::string& name) {
  return std::any_of(families.begin(), families.end(),
                     [&](const FamilyEntryOf<Mesh>& entry) { return name == entry.name; });
}

MeshData generate(Session& session, const Options& options) {
  const auto make = [&]() -> MeshData {
    if (is_in(volume_families(), options.family))
      return VolumeData{generate_volume(options.family, options.shape), {}};
    return SurfaceData{generate_mesh(options.family, options.shape), {}};
  };
  return session.phase("generate", make);
}

/// \throws InvalidOption  lists the families of both kinds
void check_family(const std::string& name) {
  if (is_in(mesh_families(), name) || is_in(volume_families(), name)) return;
  std::string known;
  const auto add = [&](const auto& families) {
    for (const auto& entry : families)
      known += (known.empty() ? "" : ", ") + std::string(entry.name);
  };
  add(mesh_families());
  add(volume_families());
  throw InvalidOption("unknown mesh family '" + name + "'; choose one of " + known);
}

void run(Session& session, const Options& options) {
  check_family(options.family);
  check_output(options.output, Content::Mesh);
  check_output_kind(options.output,
                    is_in(volume_families(), options.family) ? kVolumeWords : kSurfaceWords);
  session.report()["input"] = nullptr;
  session.report()["family"] = options.family;
  session.report()["options"] = {{"level", options.shape.level},
                                 {"jitter", options.shape.jitter},
                                 {"anisotropy", options.shape.anisotropy},
                                 {"seed", options.shape.seed}};
  const MeshData data = generate(session, options);
  std::visit(
      [&](const auto& held) {
        session.report()["kind"] = words(held.mesh).name;
        session.report()["sizes"] = sizes_to_json(held.mesh);
        session.say(options.family + ", level " + std::to_string(options.shape.level) + ": " +
                    describe_sizes(held.mesh));
      },
      data);
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
    "Surfaces: plane-..., sphere-..., torus-...; volumes: cube-..., ball-...; see carat list\n"
    "families. Boundaries of square, sphere, torus, cube and ball are met exactly.\n"
    "The same options give the same mesh on every machine.",
    "  carat generate sphere-hexagons --level 4 -o sphere.ply\n"
    "  carat generate plane-voronoi --level 3 --jitter 0.2 --seed 7 -o plane.vtp\n"
    "  carat generate plane-quads --level 5 --anisotropy 8 -o graded.obj\n"
    "  carat generate ball-voronoi --level 3 -o ball.vtu\n",
    false,
    declare};

}  // namespace carat::cli
