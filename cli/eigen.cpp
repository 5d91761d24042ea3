// carat eigen: eigenvalues and modes of the Laplacian.

#include "cli/eigen.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <utility>

#include "carat/base/error.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/mesh_kinds.h"

namespace carat::cli {
namespace {

/// Vertices where the modes vanish.
template <class Mesh>
std::vector<Index> dirichlet_vertices(const Mesh& mesh, const EigenArguments& options) {
  std::vector<Index> vertices;
  if (!options.dirichlet) return vertices;
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[static_cast<std::size_t>(v)]) vertices.push_back(v);
  check_boundary(options, !vertices.empty());
  return vertices;
}

Json to_json(const EigenPairs& pairs) {
  const FactorInfo& factor = pairs.factor;
  return {{"kind", eigen_method_name(pairs.method)},
          {"method", factor.method},
          {"reason", pairs.reason},
          {"ordering", factor.ordering},
          {"factor_nnz", factor.nonzeros},
          {"factor_seconds", factor.analyse_seconds + factor.factor_seconds},
          {"iterations", pairs.iterations},
          {"solves", pairs.solves},
          {"bytes", pairs.bytes}};
}

template <class Data>
void find_modes(Session& session, const EigenArguments& options, Data& data) {
  check_output_kind(options.output, words(data.mesh));
  const std::vector<Index> fixed = dirichlet_vertices(data.mesh, options);
  const Discretization discretization =
      discretize(session, data.mesh, options.discretization, DiscretizationParts::Matrices);
  EigenOptions solver{.method = eigen_method(options.solver),
                      .dimension = dimension(data.mesh),
                      .sparser = sparser_stiffness(data.mesh, discretization),
                      .threads = session.threads(),
                      .progress = {}};
  const EigenPairs pairs = session.phase("solve", [&](ProgressLine& line) {
    solver.progress = [&](Index converged) {
      line.show("solve: " + std::to_string(converged) + " of " + count(options.count, "pair"));
    };
    return eigenmodes(discretization, options.count, fixed, solver);
  });
  session.moved("solve", pairs.traffic);
  report_pairs(session, options, pairs, to_json(pairs));
  if (options.output.empty()) return;
  data.fields.vertex = mode_fields(pairs.vectors);
  element_fields(data).clear();
  write_output(session, options.output, "Eigenmodes", std::move(data));
}

void run(Session& session, const EigenArguments& options) {
  if (session.engine() != nullptr) {
    session.engine()->eigen(session, options);
    return;
  }
  if (!options.checkpoint.empty())
    throw InvalidOption("--checkpoint is for runs over several processes; add --engine petsc");
  check_output(options.output, Content::MeshFields);
  MeshData data = read_input(session, options.input);
  std::visit([&](auto& held) { find_modes(session, options, held); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<EigenArguments>();
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("-k,--count", options->count, "How many, from the lowest")->capture_default_str();
  app.add_flag("--dirichlet", options->dirichlet,
               "Modes that vanish on the boundary; without it the\n"
               "derivative across the boundary vanishes");
  app.add_option("-o,--output", options->output,
                 "File for the mesh with the fields mode_1, mode_2, ...\n"
                 "(vertices), or a view (.html); without it nothing is\n"
                 "written");
  app.add_option("--solver", options->solver,
                 "auto: Lanczos with a Cholesky factorisation on surfaces and\n"
                 "in small volumes, with conjugate gradients in large ones.\n"
                 "Others: cholesky, iterative")
      ->type_name("NAME");
  app.add_option("--checkpoint", options->checkpoint,
                 "With --engine petsc: keep the pairs found so far in this\n"
                 "file. The same command goes on from there after it ended\n"
                 "early, also with another number of processes; the file is\n"
                 "removed in the end")
      ->type_name("FILE");
  declare_engine_option(app);
  declare_operator_options(app, options->discretization, Application::Eigenmodes);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

void check_boundary(const EigenArguments& arguments, bool has_boundary) {
  if (arguments.dirichlet && !has_boundary)
    throw InvalidOption("--dirichlet: the mesh is closed, it has no boundary; leave it out");
}

void report_pairs(Session& session, const EigenArguments& arguments, const EigenPairs& pairs,
                  Json solver) {
  Json& report = session.report();
  report["options"]["count"] = arguments.count;
  report["options"]["dirichlet"] = arguments.dirichlet;
  report["eigenvalues"] = Json::array();
  report["residuals"] = Json::array();
  session.say("mode        lambda          residual");
  for (Index k = 0; k < pairs.values.size(); ++k) {
    report["eigenvalues"].push_back(pairs.values[k]);
    report["residuals"].push_back(pairs.residuals[k]);
    char line[64];
    std::snprintf(line, sizeof line, "%-11d %-15.10g %.1e", k + 1, pairs.values[k],
                  pairs.residuals[k]);
    session.say(line);
  }
  report["zero_modes"] = pairs.zero_modes;
  report["solver"] = std::move(solver);
  session.say("solver: " + pairs.factor.method +
              (pairs.iterations > 0 ? ", " + count(pairs.iterations, "iteration") : "") +
              (pairs.solves > 0 ? ", " + count(pairs.solves, "solve") + ", " +
                                      text(1e-6 * static_cast<double>(pairs.bytes)) + " MB"
                                : "") +
              (pairs.reason.empty() ? "" : " (" + pairs.reason + ")"));
}

std::vector<Field> mode_fields(const Matrix& vectors) {
  std::vector<Field> fields;
  for (Index k = 0; k < vectors.cols(); ++k)
    fields.push_back(scalar_field("mode_" + std::to_string(k + 1), vectors.col(k)));
  return fields;
}

const Command eigen_command = {
    "eigen",
    "Lowest eigenvalues and modes of the Laplacian",
    "S x = lambda M x, on surfaces and in volumes. Modes are M-orthonormal; of multiple\n"
    "eigenvalues all members are found. The residual is |S x - lambda M x| / (lambda |M x|).\n"
    "Without --dirichlet every component of the mesh has lambda = 0 once.",
    "  carat eigen bunny.obj -k 20 -o modes.html\n"
    "  carat eigen ball.vtu -k 34 --dirichlet -o modes.vtu\n"
    "  carat eigen case -k 5 --operator bunge --lumped --json\n"
    "  mpirun -np 8 carat --engine petsc eigen parts/mesh.pvtu -k 500 --checkpoint pairs -o "
    "modes.pvtu\n",
    true,
    declare};

}  // namespace carat::cli
