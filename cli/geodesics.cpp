// carat geodesics: distance along a surface or through a volume.

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "carat/apps/heat_geodesics.h"
#include "carat/base/error.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
  std::vector<Index> sources;
  double t_coef = 1;
  std::string edge_length = "max", directions = "samples";
  OperatorOptions discretization;
};

/// Before any work: the library says the same, but after the factorisations.
void check_sources(const std::vector<Index>& sources, Index n_vertices) {
  for (const Index v : sources)
    if (v < 0 || v >= n_vertices)
      throw InvalidOption("--source " + std::to_string(v) +
                              ": this vertex does not exist; the mesh has vertices 0 to " +
                              std::to_string(n_vertices - 1),
                          {v});
}

/// Unit vectors along which the distance grows, one an element; zero where it is infinite or flat.
Field direction_field(const Discretization& discretization, Vector distance, Index n_elements) {
  for (double& value : distance)
    if (!std::isfinite(value)) value = 0;
  Points directions =
      discretization.element_vectors(discretization.gradient * distance, n_elements);
  directions.rowwise().normalize();
  return vector_field("direction", directions);
}

void report_distance(Session& session, const GeodesicDistance& distance) {
  Diagnostics diagnostics;
  diagnostics.add("unreachable_vertices",
                  "vertices that no source reaches: their distance is infinite",
                  distance.unreachable_vertices);
  session.add_diagnostics(diagnostics);
  session.report()["unresolved_samples"] = distance.unresolved_samples;
  session.report()["distance"] = extremes(distance.values);
  if (distance.unresolved_samples > 0)
    session.say("! " + std::to_string(distance.unresolved_samples) +
                " gradient samples that the heat does not reach in double precision: distances "
                "are too small behind them; a larger --t-coef helps");
  session.say("distance: " + describe_extremes(distance.values));
}

template <class Data>
void measure(Session& session, const Options& options, Data& data) {
  check_output_kind(options.output, words(data.mesh));
  check_sources(options.sources, data.mesh.n_vertices());
  const bool writes = !options.output.empty(), of_elements = options.directions == "elements";
  Discretization discretization = discretize(
      session, data.mesh, options.discretization,
      writes || of_elements ? DiscretizationParts::Frames : DiscretizationParts::Gradient);
  const TimeStepLength length =
      options.edge_length == "mean" ? TimeStepLength::MeanEdge : TimeStepLength::MaxEdge;
  const HeatDirections directions =
      of_elements ? HeatDirections::Elements : HeatDirections::Samples;
  const HeatGeodesics geodesics = session.phase("factor", [&] {
    return HeatGeodesics(data.mesh, std::move(discretization),
                         {options.t_coef, length, directions});
  });
  std::vector<GeodesicSource> sources;
  for (const Index v : options.sources) sources.push_back({v});
  const GeodesicDistance distance =
      session.phase("solve", [&] { return geodesics.distance(sources); });

  Json& report = session.report();
  report["options"]["sources"] = options.sources;
  report["options"]["t_coef"] = options.t_coef;
  report["options"]["edge_length"] = options.edge_length;
  report["options"]["directions"] = options.directions;
  report["time_step"] = geodesics.time_step();
  report["solver"] = {{"method", geodesics.poisson_info().method},
                      {"ordering", geodesics.poisson_info().ordering},
                      {"factor_nnz", geodesics.poisson_info().nonzeros}};
  report_distance(session, distance);
  if (!writes) return;
  data.fields.vertex = {scalar_field("distance", distance.values)};
  element_fields(data) = {
      direction_field(geodesics.discretization(), distance.values, n_elements(data.mesh))};
  write_output(session, options.output, "Geodesic distance", std::move(data));
}

void run(Session& session, const Options& options) {
  check_output(options.output, Content::MeshFields);
  MeshData data = read_input(session, options.input);
  std::visit([&](auto& held) { measure(session, options, held); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("--source", options->sources,
                 "Vertex to measure from, counted from 0; repeat it for\n"
                 "the nearest of several")
      ->required()
      ->allow_extra_args(false);
  app.add_option("--t-coef", options->t_coef,
                 "Time step t = t_coef h^2 of the heat; a smaller one is\n"
                 "sharper, a larger one smoother")
      ->capture_default_str();
  app.add_option("--edge-length", options->edge_length, "The h of the time step")
      ->check(CLI::IsMember({"max", "mean"}))
      ->capture_default_str();
  app.add_option("--directions", options->directions,
                 "Bring the heat's gradient to unit length in every sample\n"
                 "(diamond), or its mean in every face or cell: smoother\n"
                 "on concave faces, with stabilized_diamond")
      ->check(CLI::IsMember({"samples", "elements"}))
      ->capture_default_str();
  app.add_option("-o,--output", options->output,
                 "File for the mesh with the fields distance (vertices)\n"
                 "and direction (faces or cells), or a view (.html);\n"
                 "without it nothing is written");
  declare_operator_options(app, options->discretization, Application::Geodesics);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command geodesics_command = {
    "geodesics",
    "Distance along a surface or through a volume from one or several vertices",
    "The heat method. Distances have the mesh's unit of length. Vertices that no source reaches\n"
    "get an infinite distance: inf in VTP, VTU and PLY files, null in JSON.",
    "  carat geodesics bunny.obj --source 0 -o distance.html\n"
    "  carat geodesics ball.vtu --source 0 -o distance.vtu\n"
    "  carat geodesics mesh.ply --source 12 --source 340 -o distance.vtp\n"
    "  carat geodesics mesh.ply --source 0 --t-coef 4 --edge-length mean --json\n",
    true,
    declare};

}  // namespace carat::cli
