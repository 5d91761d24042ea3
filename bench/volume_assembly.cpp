// Assembly of stiffness and mass of the diamond Laplacian in volumes: symbolic and numeric phase
// against the textbook way in the same run, one thread, with peak memory; then the time of a
// diamond from ten thousand cells to a million.
//
//   carat_bench_volume [--benchmark_...]   Google Benchmark's options; CARAT_BENCH_VERTICES sets
//   the size

#include <cstdio>

#include "carat/operators/registry.h"
#include "measure.h"
#include "volume_baseline.h"
#include "volume_grids.h"

namespace carat::bench {
namespace {

const char* const kKinds[] = {"tets", "hexahedra", "truncated"};

Index n_vertices() {
  const char* const text = std::getenv("CARAT_BENCH_VERTICES");
  return text != nullptr ? std::atoi(text) : 110000;
}

DiscretizationOptions matrices_only(int threads) {
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  options.threads = threads;
  return options;
}

const PolyhedralMesh& mesh_of(const std::string& kind, Index size) {
  static std::string held;
  static PolyhedralMesh mesh;
  const std::string wanted = kind + std::to_string(size);
  if (held != wanted) {
    mesh = PolyhedralMesh();
    mesh = volume_grid(kind, size);
    held = wanted;
  }
  return mesh;
}

/// The same mesh without its derived connectivity, so that the symbolic phase pays for that too.
PolyhedralMesh bare_copy(const PolyhedralMesh& mesh) {
  return PolyhedralMesh(mesh.points(), mesh.face_mesh().faces(), mesh.cells());
}

void baseline(benchmark::State& state, const std::string& kind) {
  const PolyhedralMesh& mesh = mesh_of(kind, n_vertices());
  mesh.cell_vertices();
  for (auto _ : state) {
    const Baseline result = triplet_baseline(mesh);
    state.SetIterationTime(result.weights_seconds + result.assembly_seconds);
    state.counters["weights_s"] = result.weights_seconds;
    state.counters["nnz"] = static_cast<double>(result.stiffness.nonZeros());
    state.counters["vertices"] = mesh.n_vertices();
  }
}

void symbolic(benchmark::State& state, const std::string& kind) {
  const PolyhedralMesh& mesh = mesh_of(kind, n_vertices());
  for (auto _ : state) {
    const PolyhedralMesh bare = bare_copy(mesh);
    const double start = now();
    const auto assembly =
        volume_operator("diamond").prepare(bare, matrices_only(static_cast<int>(state.range(0))));
    state.SetIterationTime(now() - start);
  }
}

void time_reassembly(benchmark::State& state, const PolyhedralMesh& mesh, int threads) {
  const auto assembly = volume_operator("diamond").prepare(mesh, matrices_only(threads));
  assembly->reassemble(mesh.points());
  for (auto _ : state) {
    const double start = now();
    assembly->reassemble(mesh.points());
    state.SetIterationTime(now() - start);
  }
  state.counters["a diamond"] = benchmark::Counter(
      mesh.face_mesh().n_corners(),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void numeric(benchmark::State& state, const std::string& kind) {
  time_reassembly(state, mesh_of(kind, n_vertices()), static_cast<int>(state.range(0)));
}

/// The range is the number of vertices.
void numeric_of_size(benchmark::State& state, const std::string& kind) {
  time_reassembly(state, mesh_of(kind, static_cast<Index>(state.range(0))), 1);
}

/// The peak of a whole process that reads nothing but `kind`: with derived connectivity and all.
double peak_of(const std::string& kind, bool ours) {
  return peak_megabytes([&] {
    const PolyhedralMesh mesh = volume_grid(kind, n_vertices());
    if (ours)
      discretize(mesh, "diamond", matrices_only(1));
    else
      triplet_baseline(mesh);
  });
}

void print_ratios(const std::map<std::string, double>& best) {
  std::printf("\n%-10s %10s %10s %10s %14s %12s %16s\n", "mesh", "baseline s", "symbolic s",
              "numeric s", "base/(sym+num)", "base/numeric", "peak memory");
  for (const std::string kind : kKinds) {
    const auto seconds = [&](const std::string& name) {
      const auto found = best.find(name);
      return found == best.end() ? 0.0 : found->second;
    };
    const double base = seconds("baseline_" + kind + "/");
    const double sym = seconds("symbolic_" + kind + "/1"), num = seconds("numeric_" + kind + "/1");
    if (base == 0 || sym == 0 || num == 0) continue;
    std::printf("%-10s %10.2f %10.3f %10.3f %14.1f %12.1f %6.0f/%.0f MB\n", kind.c_str(), base, sym,
                num, base / (sym + num), base / num, peak_of(kind, false), peak_of(kind, true));
  }
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RegisterBenchmark("stream_triad", stream_triad)->Unit(benchmark::kMillisecond);
  for (const std::string kind : kKinds) {
    const auto add = [&](const std::string& name, auto function) {
      return benchmark::RegisterBenchmark((name + "_" + kind).c_str(),
                                          [=](benchmark::State& state) { function(state, kind); })
          ->Unit(benchmark::kMillisecond)
          ->UseManualTime()
          ->Iterations(1);
    };
    add("baseline", baseline);
    for (const int threads : {1, 2}) {
      add("symbolic", symbolic)->Arg(threads)->Repetitions(3);
      add("numeric", numeric)->Arg(threads)->Repetitions(5);
    }
    // Vertices of about 10^4, 10^5 and 10^6 cells.
    const double vertices_a_cell = kind == "tets" ? 1 / 6.0 : kind == "truncated" ? 6 : 1;
    for (const double n_cells : {1e4, 1e5, 1e6})
      if (kind != "truncated" || n_cells < 1e6)  // 6 million vertices of 300 entries each
        add("numeric_of_size", numeric_of_size)
            ->Arg(static_cast<int>(n_cells * vertices_a_cell))
            ->Repetitions(3);
  }
  BestTimes reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  print_ratios(reporter.best);
}
