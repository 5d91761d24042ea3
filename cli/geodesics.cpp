// carat geodesics: distance along a surface or through a volume.

#include "cli/geodesics.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/npy.h"
#include "cli/command.h"
#include "cli/mesh_kinds.h"
#include "cli/source_file.h"

namespace carat::cli {
namespace {

/// More distances than this, one field each, are better kept in a matrix.
constexpr std::size_t kMostFields = 64;

/// Distances from every source by itself, into the rows of a matrix or fields of the mesh.
template <class Data>
void measure_each(Session& session, const GeodesicsArguments& options, Data& data,
                  const HeatGeodesics& geodesics, const SourceSets& sets) {
  DistanceSummary summary;
  const auto start = std::chrono::steady_clock::now();
  const auto for_each = [&](const auto& use) {
    session.phase("solve", [&](ProgressLine& line) {
      geodesics.distances(sets, [&](Index set, GeodesicDistance&& distance) {
        double largest = 0;
        for (const double value : distance.values)
          if (std::isfinite(value)) largest = std::max(largest, value);
        summary.add(distance.unreachable_vertices.empty(), distance.unresolved_samples, largest);
        session.moved("solve", distance.traffic);
        use(set, std::move(distance.values));
        line.show("solve " + std::to_string(set + 1) + " of " + std::to_string(sets.size()));
        return true;
      });
    });
    report_each(session, summary,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  };
  const Index rows = static_cast<Index>(sets.size()), columns = data.mesh.n_vertices();
  if (options.writes_matrix()) {
    write_npy(options.output, rows, columns,
              [&](const PutRow& put) { for_each([&](Index, Vector&& values) { put(values); }); });
    report_matrix(session, options.output, rows, columns);
    return;
  }
  data.fields.vertex.clear();
  element_fields(data).clear();
  for_each([&](Index set, Vector&& values) {
    if (!options.output.empty())
      data.fields.vertex.push_back(scalar_field("distance_" + std::to_string(set), values));
  });
  write_output(session, options.output, "Geodesic distances", std::move(data));
}

template <class Data>
void measure(Session& session, const GeodesicsArguments& options, Data& data) {
  if (!options.writes_matrix()) check_output_kind(options.output, words(data.mesh));
  const SourceSets sets = source_sets(options, data.mesh.n_vertices());
  Discretization discretization =
      discretize(session, data.mesh, options.discretization, options.parts());
  HeatGeodesicsOptions heat = options.heat();
  heat.solver = {.kind = solver_kind(options.solver),
                 .right_hand_sides = static_cast<Index>(sets.size()),
                 .threads = session.threads()};
  const HeatGeodesics geodesics = session.phase(
      "factor", [&] { return HeatGeodesics(data.mesh, std::move(discretization), heat); });

  // Of the heat also the matrix.
  session.moved("factor", setup_bytes(geodesics.poisson_info()) +
                              setup_bytes(geodesics.heat_info()) +
                              static_cast<double>(geodesics.heat_info().operator_bytes));
  report_options(session, options, geodesics.time_step());
  const SolverInfo& poisson = geodesics.poisson_info();
  session.report()["solver"] = {{"kind", solver_kind_name(poisson.kind)},
                                {"method", poisson.method},
                                {"reason", poisson.reason},
                                {"ordering", poisson.ordering},
                                {"factor_nnz", poisson.nonzeros},
                                {"heat_method", geodesics.heat_info().method},
                                {"heat_reason", geodesics.heat_info().reason}};
  session.say("solver: heat " + geodesics.heat_info().method + ", distance " + poisson.method +
              (poisson.reason.empty() ? "" : " (" + poisson.reason + ")"));
  if (options.each) {
    measure_each(session, options, data, geodesics, sets);
    return;
  }
  const GeodesicDistance distance =
      session.phase("solve", [&] { return geodesics.distance(sets.front()); });
  session.moved("solve", distance.traffic);
  report_distance(session, distance.unreachable_vertices, distance.unresolved_samples,
                  extremes(distance.values));
  if (options.output.empty()) return;
  data.fields.vertex = {scalar_field("distance", distance.values)};
  const Discretization& d = geodesics.discretization();
  element_fields(data) = {direction_field(
      d.element_vectors(d.gradient * finite(distance.values), n_elements(data.mesh)))};
  write_output(session, options.output, "Geodesic distance", std::move(data));
}

void run(Session& session, const GeodesicsArguments& options) {
  if (session.engine() != nullptr) {
    session.engine()->geodesics(session, options);
    return;
  }
  check_sources(options);
  if (options.writes_matrix())
    check_output_folder(options.output);
  else
    check_output(options.output, Content::MeshFields);
  MeshData data = read_input(session, options.input);
  std::visit([&](auto& held) { measure(session, options, held); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<GeodesicsArguments>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("--source", options->sources,
                 "Vertex to measure from, counted from 0; repeat it for\n"
                 "the nearest of several")
      ->allow_extra_args(false);
  app.add_option("--sources-file", options->sources_file,
                 "Text file of such vertices, one or several a line");
  app.add_flag("--each", options->each,
               "Distances from every --source and every line of the file\n"
               "by itself, instead of the nearest of all");
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
                 "with --each the fields distance_0, distance_1, ..., or a\n"
                 "matrix (.npy, sources x vertices, float64), of which only\n"
                 "a few rows are in memory at a time;\n"
                 "without it nothing is written");
  app.add_option("--solver", options->solver,
                 "Of the distance: auto, cholesky, multigrid,\n"
                 "incomplete-cholesky, sparser-cholesky")
      ->type_name("NAME");
  declare_engine_option(app);
  declare_operator_options(app, options->discretization, Application::Geodesics);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

bool GeodesicsArguments::writes_matrix() const {
  return std::filesystem::path(output).extension() == ".npy";
}

HeatGeodesicsOptions GeodesicsArguments::heat() const {
  return {t_coef, edge_length == "mean" ? TimeStepLength::MeanEdge : TimeStepLength::MaxEdge,
          directions == "elements" ? HeatDirections::Elements : HeatDirections::Samples};
}

DiscretizationParts GeodesicsArguments::parts() const {
  return writes_directions() || directions == "elements" ? DiscretizationParts::Frames
                                                         : DiscretizationParts::Gradient;
}

void check_sources(const GeodesicsArguments& options) {
  if (options.sources.empty() && options.sources_file.empty())
    throw InvalidOption("--source is required, or --sources-file with vertices to measure from");
  if (options.writes_matrix() && !options.each)
    throw InvalidOption(options.output +
                        ": a matrix of distances has one row a source; add --each, or name a mesh "
                        "file for the one distance from all sources");
}

SourceSets source_sets(const GeodesicsArguments& options, Index n_vertices) {
  SourceSets sets;
  for (const Index v : options.sources) {
    if (v < 0 || v >= n_vertices)
      throw InvalidOption("--source " + std::to_string(v) +
                              ": this vertex does not exist; the mesh has vertices 0 to " +
                              std::to_string(n_vertices - 1),
                          {v});
    sets.push_back({{v}});
  }
  if (!options.sources_file.empty())
    for (auto& set : read_source_sets(options.sources_file, n_vertices))
      sets.push_back(std::move(set));
  if (options.each) {
    if (!options.writes_matrix() && !options.output.empty() && sets.size() > kMostFields)
      throw InvalidOption(options.output + ": " + std::to_string(sets.size()) +
                          " distances are too many for fields of a mesh, at most " +
                          std::to_string(kMostFields) + "; name a matrix file, .npy");
    return sets;
  }
  std::vector<GeodesicSource> all;
  for (const auto& set : sets) all.insert(all.end(), set.begin(), set.end());
  return {std::move(all)};
}

Vector finite(Vector distance) {
  for (double& value : distance)
    if (!std::isfinite(value)) value = 0;
  return distance;
}

Field direction_field(Points means) {
  means.rowwise().normalize();
  return vector_field("direction", means);
}

void report_options(Session& session, const GeodesicsArguments& options, double time_step) {
  Json& report = session.report();
  if (!options.sources.empty()) report["options"]["sources"] = options.sources;
  if (!options.sources_file.empty()) report["options"]["sources_file"] = options.sources_file;
  report["options"]["each"] = options.each;
  report["options"]["t_coef"] = options.t_coef;
  report["options"]["edge_length"] = options.edge_length;
  report["options"]["directions"] = options.directions;
  report["time_step"] = time_step;
}

void report_distance(Session& session, const std::vector<Index>& unreachable, Index unresolved,
                     const Extremes& distance) {
  Diagnostics diagnostics;
  diagnostics.add("unreachable_vertices",
                  "vertices that no source reaches: their distance is infinite", unreachable);
  session.add_diagnostics(diagnostics);
  session.report()["unresolved_samples"] = unresolved;
  session.report()["distance"] = to_json(distance);
  if (unresolved > 0)
    session.say("! " + std::to_string(unresolved) +
                " gradient samples that the heat does not reach in double precision: distances "
                "are too small behind them; a larger --t-coef helps");
  session.say("distance: " + in_words(distance));
}

void DistanceSummary::add(bool complete, Index unresolved, double largest_distance) {
  if (!complete) ++incomplete_sets;
  unresolved_samples += unresolved;
  if (largest_distance > largest) {
    largest = largest_distance;
    largest_set = sets;
  }
  ++sets;
}

void report_each(Session& session, const DistanceSummary& summary, double seconds) {
  Json& report = session.report();
  report["source_sets"] = summary.sets;
  report["seconds_per_source_set"] = seconds / std::max(1, summary.sets);
  report["unresolved_samples"] = summary.unresolved_samples;
  report["incomplete_source_sets"] = summary.incomplete_sets;
  report["largest_distance"] = {{"value", summary.largest}, {"source_set", summary.largest_set}};
  if (summary.unresolved_samples > 0)
    session.say("! " + std::to_string(summary.unresolved_samples) +
                " gradient samples that the heat does not reach in double precision: distances "
                "are too small behind them; a larger --t-coef helps");
  if (summary.incomplete_sets > 0)
    session.say("! " + count(summary.incomplete_sets, "source") +
                " that do not reach all vertices: these have infinite distances");
  session.say(count(summary.sets, "source") + ", " + text(seconds / std::max(1, summary.sets)) +
              " s each; largest distance " + text(summary.largest) + " (source " +
              std::to_string(summary.largest_set) + ")");
}

void report_matrix(Session& session, const std::string& path, Index rows, Index columns) {
  session.report()["output"] = path;
  session.report()["matrix"] = {{"shape", {rows, columns}},
                                {"bytes", std::filesystem::file_size(path)}};
  session.say("written: " + path + ", " + std::to_string(rows) + " x " + std::to_string(columns));
}

const Command geodesics_command = {
    "geodesics",
    "Distance along a surface or through a volume from one or several vertices",
    "The heat method. Distances have the mesh's unit of length. Vertices that no source reaches\n"
    "get an infinite distance: inf in VTP, VTU and PLY files, null in JSON.",
    "  carat geodesics bunny.obj --source 0 -o distance.html\n"
    "  carat geodesics ball.vtu --source 0 -o distance.vtu\n"
    "  carat geodesics mesh.ply --source 12 --source 340 -o distance.vtp\n"
    "  carat geodesics mesh.ply --source 0 --t-coef 4 --edge-length mean --json\n"
    "  carat geodesics mesh.ply --sources-file landmarks.txt --each -o distances.npy\n",
    true,
    declare};

}  // namespace carat::cli
