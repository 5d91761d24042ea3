// carat view: an HTML page of meshes and their fields.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "carat/report/html_view.h"
#include "cli/command.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string output;
};

void run(Session& session, const Options& options) {
  check_output(options.output, Content::Page);
  std::vector<ViewItem> items;
  Json sizes = Json::array();
  for (const std::string& file : options.files) {
    items.push_back({std::filesystem::path(file).stem().string(), read_input(session, file)});
    sizes.push_back(session.report()["sizes"]);
  }
  session.report()["input"] = options.files;
  session.report()["sizes"] = std::move(sizes);
  session.phase("write", [&] { write_html_view(options.output, items); });
  session.report()["output"] = options.output;
  session.say("written: " + options.output + " (open it in a browser)");
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("FILE", options->files, "Meshes to show, with the fields that they hold")
      ->required();
  app.add_option("-o,--output", options->output, "The page to write, ends in .html")->required();
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command view_command = {
    "view",
    "Write one interactive HTML page of meshes and their fields",
    "The page holds everything it needs: no server, no network. Volumes are shown with\n"
    "cuts, whole cells behind a plane, shrunk and pulled apart.",
    "  carat view mesh.ply -o mesh.html\n"
    "  carat view geodesics.vtp curvature.vtp modes.vtu -o results.html\n",
    false,
    declare};

}  // namespace carat::cli
