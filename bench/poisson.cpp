// Poisson's equation, -div grad u = 1 with u = 0 on the boundary, from the mesh in memory to the
// solution: the diamonds beside the sparser operator, each as Poisson solves it, and a Cholesky
// factorisation of the diamond's stiffness, in the same run. Every case runs in a process of its
// own, for its peak memory above that of the mesh.
//
//   carat_bench_poisson [--benchmark_filter=REGEX] [--benchmark_...]
//
// Names are OPERATOR/SOLVER/MESH/VERTICES/threads:N. The solver auto takes products where
// poisson_form() does, the solver assembled always has the matrix, the solver triangle keeps little
// more than one triangle of it. CARAT_BENCH_LARGEST leaves out larger meshes.

#include "carat/apps/poisson.h"

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "carat/base/memory.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "grids.h"
#include "measure.h"
#include "volume_grids.h"

namespace carat::bench {
namespace {

struct Case {
  std::string op, solver, mesh;
  Index size;
  int threads;
};

/// What a case's process sends back.
struct Outcome {
  double assembly = 0, setup = 0, solution = 0;  ///< [s]
  double residual = 0, megabytes = 0, iterations = 0, entries = 0, vertices = 0;
  double operator_megabytes = 0;
  double total() const { return assembly + setup + solution; }
};

template <class Mesh>
BoundaryConditions zero_on_boundary(const Mesh& mesh) {
  BoundaryConditions conditions;
  const std::vector<bool> flags = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (flags[static_cast<std::size_t>(v)]) conditions.dirichlet_vertices.push_back(v);
  conditions.dirichlet_values.assign(conditions.dirichlet_vertices.size(), 0.0);
  return conditions;
}

/// The same mesh without its derived connectivity, so that the assembly pays for that too.
PolygonMesh bare_copy(const PolygonMesh& mesh) { return PolygonMesh(mesh.points(), mesh.faces()); }
PolyhedralMesh bare_copy(const PolyhedralMesh& mesh) {
  return PolyhedralMesh(mesh.points(), mesh.face_mesh().faces(), mesh.cells());
}

template <class Mesh>
Outcome solve(const Case& wanted, const Mesh& whole) {
  const BoundaryConditions conditions = zero_on_boundary(whole);
  const Mesh mesh = bare_copy(whole);
  Outcome outcome;
  restart_peak_memory();
  const auto before = static_cast<double>(peak_memory());
  double start = now();
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  options.threads = wanted.threads;
  const bool triangle = wanted.solver == "triangle";
  const bool assembled = triangle || wanted.solver == "assembled";
  const SolverOptions solver{.kind = assembled ? SolverKind::Auto : solver_kind(wanted.solver),
                             .threads = wanted.threads,
                             .storage = triangle ? MatrixStorage::Triangle : MatrixStorage::Full};
  if (!assembled) options.form = poisson_form(mesh, wanted.op, solver);
  Discretization d = discretize(mesh, wanted.op, options);
  outcome.assembly = now() - start;
  outcome.entries = static_cast<double>(d.stiffness.nonZeros());
  start = now();
  const Poisson poisson(mesh, std::move(d), conditions, solver);
  outcome.setup = now() - start;
  start = now();
  const PoissonSolution solution = poisson.solve(Vector::Ones(mesh.n_vertices()));
  outcome.solution = now() - start;
  outcome.megabytes = (static_cast<double>(peak_memory()) - before) / (1 << 20);
  outcome.residual = solution.solve.residual;
  outcome.iterations = solution.solve.iterations;
  outcome.operator_megabytes = 1e-6 * static_cast<double>(poisson.solver().operator_bytes);
  outcome.vertices = mesh.n_vertices();
  return outcome;
}

bool is_surface(const std::string& mesh) {
  return mesh == "triangles" || mesh == "quads" || mesh == "hexagons";
}

Outcome run(const Case& wanted) {
  return in_process<Outcome>([&] {
    return is_surface(wanted.mesh) ? solve(wanted, grid(wanted.mesh, wanted.size))
                                   : solve(wanted, volume_grid(wanted.mesh, wanted.size));
  });
}

/// Operator, solver, mesh, size -> the fastest outcome with one thread.
std::map<std::tuple<std::string, std::string, std::string, Index>, Outcome> best;

void measure(benchmark::State& state, const Case& wanted) {
  for (auto _ : state) {
    const Outcome outcome = run(wanted);
    if (!(outcome.vertices > 0)) {
      state.SkipWithError("the process ended without a result");
      return;
    }
    state.SetIterationTime(outcome.total());
    state.counters["assembly_s"] = outcome.assembly;
    state.counters["setup_s"] = outcome.setup;
    state.counters["solve_s"] = outcome.solution;
    state.counters["cg_iterations"] = outcome.iterations;
    state.counters["residual"] = outcome.residual;
    state.counters["peak_MB"] = outcome.megabytes;
    state.counters["nnz"] = outcome.entries;
    state.counters["operator_MB"] = outcome.operator_megabytes;
    state.counters["vertices"] = outcome.vertices;
    if (wanted.threads != 1) continue;
    Outcome& known = best[{wanted.op, wanted.solver, wanted.mesh, wanted.size}];
    if (known.vertices == 0 || outcome.total() < known.total()) known = outcome;
  }
}

void print_ratios() {
  std::printf("\nOne thread. Seconds and memory of diamond; others relative to it.\n");
  std::printf("%-10s %9s %9s %6s %9s | %8s %10s | %9s %7s | %11s %7s\n", "mesh", "vertices",
              "seconds", "iter.", "peak MB", "/bunge", "stabilized", "assembled", "memory",
              "CHOLMOD(S)/", "memory");
  for (const auto& [key, diamond] : best) {
    const auto& [op, solver, mesh, size] = key;
    if (op != "diamond" || solver != "auto") continue;
    const auto ratio = [&, mesh = mesh, size = size](const char* other, const char* its_solver,
                                                     auto value) {
      const auto found = best.find({other, its_solver, mesh, size});
      return found == best.end() ? std::string("-") : [&] {
        char text[32];
        std::snprintf(text, sizeof text, "%.2f", value(found->second));
        return std::string(text);
      }();
    };
    std::printf(
        "%-10s %9.0f %9.3f %6.0f %9.0f | %8s %10s | %9s %7s | %11s %7s\n", mesh.c_str(),
        diamond.vertices, diamond.total(), diamond.iterations, diamond.megabytes,
        ratio("bunge", "auto", [&](const Outcome& o) { return diamond.total() / o.total(); })
            .c_str(),
        ratio("stabilized_diamond", "auto",
              [&](const Outcome& o) { return o.total() / diamond.total(); })
            .c_str(),
        ratio("diamond", "assembled", [&](const Outcome& o) { return o.total() / diamond.total(); })
            .c_str(),
        ratio("diamond", "assembled",
              [&](const Outcome& o) { return o.megabytes / diamond.megabytes; })
            .c_str(),
        ratio("diamond", "cholesky", [&](const Outcome& o) { return o.total() / diamond.total(); })
            .c_str(),
        ratio("diamond", "cholesky", [&](const Outcome& o) {
          return o.megabytes / diamond.megabytes;
        }).c_str());
  }
}

void add(const Case& wanted) {
  const char* const largest = std::getenv("CARAT_BENCH_LARGEST");
  if (largest != nullptr && wanted.size > std::atoi(largest)) return;
  const std::string name = wanted.op + "/" + wanted.solver + "/" + wanted.mesh + "/" +
                           std::to_string(wanted.size) +
                           "/threads:" + std::to_string(wanted.threads);
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { measure(state, wanted); })
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1)
      ->Repetitions(wanted.solver == "cholesky" || wanted.size > 1000000 ? 1 : 3);
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const auto add_all = [](const std::string& mesh, const std::vector<carat::Index>& sizes,
                          carat::Index largest_factor) {
    for (const carat::Index size : sizes) {
      for (const char* const op : {"diamond", "stabilized_diamond", "bunge"})
        for (const int threads : {1, 2}) add({op, "auto", mesh, size, threads});
      for (const char* const solver : {"assembled", "triangle"})
        for (const int threads : {1, 2}) add({"diamond", solver, mesh, size, threads});
      if (size <= largest_factor) add({"diamond", "cholesky", mesh, size, 1});
    }
  };
  for (const char* const mesh : {"triangles", "quads", "hexagons"})
    add_all(mesh, {10000, 30000, 100000, 300000, 1000000, 4000000}, 1000000);
  for (const char* const mesh : {"tets", "hexahedra"})
    add_all(mesh, {10000, 30000, 100000, 275000, 1000000, 4000000}, 275000);
  add_all("truncated", {10000, 30000, 100000, 300000, 1000000}, 100000);
  benchmark::RunSpecifiedBenchmarks();
  print_ratios();
}
