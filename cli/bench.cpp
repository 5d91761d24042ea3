// carat bench: what every operator and every way to solve with it costs on one mesh.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/base/memory.h"
#include "carat/mesh/statistics.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/mesh_kinds.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input;
  std::vector<std::string> operators, solvers;
  int repetitions = 3;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// -div grad u = 1 with u = 0 on the boundary, or at one vertex of a component without one.
template <class Mesh>
BoundaryConditions conditions_of(const Mesh& mesh, const Discretization& d) {
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  const std::vector<Index> component = matrix_components(d.stiffness);
  Index n = 0;
  for (const Index c : component) n = std::max(n, c + 1);
  std::vector<bool> anchored(static_cast<std::size_t>(n), false);
  BoundaryConditions conditions;
  const auto anchor = [&](Index v) {
    if (component[static_cast<std::size_t>(v)] < 0) return;
    anchored[static_cast<std::size_t>(component[static_cast<std::size_t>(v)])] = true;
    conditions.dirichlet_vertices.push_back(v);
  };
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[static_cast<std::size_t>(v)]) anchor(v);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (const Index c = component[static_cast<std::size_t>(v)];
        c >= 0 && !anchored[static_cast<std::size_t>(c)])
      anchor(v);
  conditions.dirichlet_values.assign(conditions.dirichlet_vertices.size(), 0.0);
  return conditions;
}

/// The fastest of several runs, and the memory that they took beyond what was there before.
struct Cost {
  double symbolic = std::numeric_limits<double>::infinity(), numeric = symbolic;
  double setup = symbolic, solve = symbolic;
  double memory = 0;
};

std::string number(double value, const char* format = "%.3g") {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

class Table {
 public:
  explicit Table(Session& session) : session_(session) {
    line("operator", "solver", "symbolic", "numeric", "GB/s", "set-up", "solve", "total", "iter.",
         "nnz", "peak MB");
  }
  template <class... Cells>
  void line(const std::string& op, const std::string& solver, const Cells&... cells) {
    std::string text = op;
    text.resize(std::max<std::size_t>(text.size() + 1, 20), ' ');
    text += solver;
    text.resize(std::max<std::size_t>(text.size() + 1, 41), ' ');
    for (std::string cell : {std::string(cells)...}) {
      cell.insert(0, cell.size() < 9 ? 9 - cell.size() : 1, ' ');
      text += cell;
    }
    session_.say(text);
  }
  void reason(const std::string& op, const std::string& solver, const std::string& why) {
    line(op, solver, "  - " + why);
  }

 private:
  Session& session_;
};

template <class Mesh>
class Bench {
 public:
  Bench(Session& session, const Options& options, const Mesh& mesh)
      : session_(session), options_(options), mesh_(mesh), table_(session) {}

  void run() {
    for (const OperatorEntry<Mesh>* const entry : operators_of(mesh_)) {
      if (!chosen(options_.operators, entry->name)) continue;
      try {
        for (const SolverKind kind : solver_kinds())
          if (chosen(options_.solvers, solver_kind_name(kind)) && serves(kind, *entry))
            rows_.push_back(measure(*entry, kind));
      } catch (const InvalidMesh& error) {
        // An operator of simplices, and others are here.
        rows_.push_back({{"operator", entry->name}, {"left_out", error.what()}});
        table_.reason(entry->name, "-", error.what());
      }
    }
    const auto count_of = [&](const char* key) {
      return std::count_if(rows_.begin(), rows_.end(),
                           [&](const Json& row) { return row.contains(key); });
    };
    const std::int64_t measured = count_of("seconds"), left_out = count_of("left_out"),
                       failed = count_of("failure");
    session_.say(count(measured, "case") + " measured, " + std::to_string(failed) + " failed, " +
                 count(left_out, "operator") + " not for this mesh");
    session_.report()["results"] = std::move(rows_);
    session_.report()["counts"] = {
        {"measured", measured}, {"failed", failed}, {"left_out", left_out}};
  }

 private:
  static bool chosen(const std::vector<std::string>& names, const std::string& name) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
  }
  /// Unknowns beyond the vertices are for a factorisation alone; what couples the vertices of one
  /// element only has nothing sparser.
  static bool serves(SolverKind kind, const OperatorEntry<Mesh>& entry) {
    if (!entry.claims.vertex_unknowns) return kind == SolverKind::Cholesky;
    return kind != SolverKind::SparserCholesky || !entry.claims.face_local;
  }

  Json measure(const OperatorEntry<Mesh>& entry, SolverKind kind) {
    const std::string solver = solver_kind_name(kind);
    const ProgressLine progress(std::string(entry.name) + ", " + solver);
    Json row{{"operator", entry.name}, {"solver", solver}};
    try {
      row.update(cost(entry, kind));
    } catch (const SolverFailure& error) {
      row["failure"] = error.what();
      table_.reason(entry.name, solver, error.what());
    }
    return row;
  }

  Json cost(const OperatorEntry<Mesh>& entry, SolverKind kind) {
    Cost best;
    Json row;
    DiscretizationOptions wanted;
    wanted.parts = DiscretizationParts::Matrices;
    wanted.threads = session_.threads();
    for (int repetition = 0; repetition < options_.repetitions; ++repetition) {
      restart_peak_memory();
      const auto before = static_cast<double>(peak_memory());
      // Copies share the connectivity that they have derived; a fresh mesh has to derive it.
      const Mesh mesh = underived(mesh_);
      std::unique_ptr<Assembly> assembly;
      const double symbolic = seconds_of([&] { assembly = entry.prepare(mesh, wanted); });
      const double numeric = seconds_of([&] { assembly->reassemble(mesh.points()); });
      const Discretization d = assembly->release();
      assembly.reset();
      const BoundaryConditions conditions = conditions_of(mesh, d);
      std::optional<Poisson> poisson;
      const double setup = seconds_of([&] {
        poisson.emplace(mesh, d, conditions,
                        SolverOptions{.kind = kind, .threads = session_.threads()});
      });
      PoissonSolution solution;
      const double solve =
          seconds_of([&] { solution = poisson->solve(Vector::Ones(d.n_unknowns())); });
      best.symbolic = std::min(best.symbolic, symbolic);
      best.numeric = std::min(best.numeric, numeric);
      best.setup = std::min(best.setup, setup);
      best.solve = std::min(best.solve, solve);
      best.memory = std::max(best.memory, static_cast<double>(peak_memory()) - before);
      if (repetition == 0)
        row = {{"method", solution.solve.method},
               {"reason", poisson->solver().reason},
               {"iterations", solution.solve.iterations},
               {"residual", solution.solve.residual},
               {"unknowns", d.n_unknowns()},
               {"nnz", {{"stiffness", d.stiffness.nonZeros()}, {"mass", d.mass.nonZeros()}}},
               {"solver_nnz", poisson->solver().nonzeros},
               {"assembly_bytes", assembly_bytes(mesh, d)}};
    }
    const double rate = 1e-9 * row["assembly_bytes"].template get<double>() / best.numeric;
    const double total = best.symbolic + best.numeric + best.setup + best.solve;
    row["seconds"] = {{"symbolic", best.symbolic},
                      {"numeric", best.numeric},
                      {"set_up", best.setup},
                      {"solve", best.solve},
                      {"total", total}};
    row["numeric_GB_per_s"] = rate;
    row["peak_memory"] = best.memory;
    table_.line(entry.name, solver_kind_name(kind), number(best.symbolic), number(best.numeric),
                number(rate), number(best.setup), number(best.solve), number(total),
                std::to_string(row["iterations"].template get<Index>()),
                std::to_string(row["nnz"]["stiffness"].template get<std::int64_t>()),
                number(best.memory / 1e6, "%.0f"));
    return row;
  }

  Session& session_;
  const Options& options_;
  const Mesh& mesh_;
  Table table_;
  Json rows_ = Json::array();
};

void run(Session& session, const Options& options) {
  const MeshData data = read_input(session, options.input);
  session.report()["options"] = {{"repetitions", options.repetitions}};
  session.say("-div grad u = 1 from the mesh in memory to the solution; seconds, the fastest of " +
              count(options.repetitions, "run"));
  std::visit([&](const auto& held) { Bench(session, options, held.mesh).run(); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  std::vector<std::string> operators, solvers;
  const auto add_names = [&](const auto& entries) {
    for (const auto* entry : entries)
      if (std::find(operators.begin(), operators.end(), entry->name) == operators.end())
        operators.emplace_back(entry->name);
  };
  add_names(surface_operators());
  add_names(volume_operators());
  for (const SolverKind kind : solver_kinds()) solvers.emplace_back(solver_kind_name(kind));
  app.add_option("MESH", options->input, "The mesh")->required();
  app.add_option("--operator", options->operators, "Only these; see carat list operators")
      ->check(CLI::IsMember(operators))
      ->option_text("NAME ...");
  app.add_option("--solver", options->solvers, "Only these; see carat poisson --help")
      ->check(CLI::IsMember(solvers))
      ->option_text("NAME ...");
  app.add_option("--repetitions", options->repetitions, "Runs of every case; the fastest counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command bench_command = {
    "bench",
    "Measure what operators and solvers cost on a mesh",
    "Solves -div grad u = 1 with every operator by every solver, u = 0 on the boundary, or at one\n"
    "vertex of a component that has none. Columns: seconds of the symbolic and the numeric phase,\n"
    "the rate of the latter by the bytes that it has to move at least, seconds to set the solver\n"
    "up and to solve, iterations, entries of the stiffness, and the peak of memory beyond the\n"
    "mesh. What fails is said, and counted; so are operators that are not for the mesh.",
    "  carat bench bunny.obj\n"
    "  carat bench ball.vtu --operator diamond bunge --threads 1\n"
    "  carat bench case --solver auto --json > costs.json\n",
    false,
    declare};

}  // namespace carat::cli
