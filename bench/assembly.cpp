// Assembly of stiffness and mass of the diamond Laplacian: symbolic and numeric phase against the
// textbook way in the same run, one thread, with peak memory and the bandwidth reached.
//
//   carat_bench [--benchmark_...]     Google Benchmark's options; CARAT_BENCH_VERTICES sets the
//   size

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "carat/operators/registry.h"
#include "grids.h"
#include "measure.h"
#include "triplet_baseline.h"

namespace carat::bench {
namespace {

const char* const kKinds[] = {"triangles", "quads", "hexagons"};

Index n_vertices() {
  const char* const text = std::getenv("CARAT_BENCH_VERTICES");
  return text != nullptr ? std::atoi(text) : 1000000;
}

DiscretizationOptions matrices_only(int threads) {
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  options.threads = threads;
  return options;
}

const PolygonMesh& mesh_of(const std::string& kind) {
  static std::string held;
  static PolygonMesh mesh;
  if (held != kind) {
    mesh = PolygonMesh();
    mesh = grid(kind, n_vertices());
    held = kind;
  }
  return mesh;
}

/// The same mesh without its derived connectivity, so that the symbolic phase pays for that too.
PolygonMesh bare_copy(const PolygonMesh& mesh) { return PolygonMesh(mesh.points(), mesh.faces()); }

void baseline(benchmark::State& state, const std::string& kind) {
  const PolygonMesh& mesh = mesh_of(kind);
  mesh.edges();
  for (auto _ : state) {
    const Baseline result = triplet_baseline(mesh);
    state.SetIterationTime(result.weights_seconds + result.assembly_seconds);
    state.counters["weights_s"] = result.weights_seconds;
    state.counters["nnz"] = static_cast<double>(result.stiffness.nonZeros());
  }
}

void symbolic(benchmark::State& state, const std::string& kind) {
  const PolygonMesh& mesh = mesh_of(kind);
  for (auto _ : state) {
    const PolygonMesh bare = bare_copy(mesh);
    const double start = now();
    const auto assembly =
        surface_operator("diamond").prepare(bare, matrices_only(static_cast<int>(state.range(0))));
    state.SetIterationTime(now() - start);
  }
}

/// The bytes that the numeric phase cannot avoid: points, connectivity and weights once, and both
/// matrices' columns read and values written.
double least_bytes(const PolygonMesh& mesh, const Discretization& d) {
  return 24.0 * mesh.n_vertices() + 12.0 * mesh.n_corners() +
         12.0 * static_cast<double>(d.stiffness.nonZeros() + d.mass.nonZeros());
}

void numeric(benchmark::State& state, const std::string& kind) {
  const PolygonMesh& mesh = mesh_of(kind);
  const auto assembly =
      surface_operator("diamond").prepare(mesh, matrices_only(static_cast<int>(state.range(0))));
  assembly->reassemble(mesh.points());
  for (auto _ : state) {
    const double start = now();
    assembly->reassemble(mesh.points());
    state.SetIterationTime(now() - start);
  }
  state.counters["GB/s"] = benchmark::Counter(1e-9 * least_bytes(mesh, assembly->discretization()),
                                              benchmark::Counter::kIsIterationInvariantRate);
}

void one_shot(benchmark::State& state, const std::string& kind) {
  const PolygonMesh& mesh = mesh_of(kind);
  for (auto _ : state) {
    const PolygonMesh bare = bare_copy(mesh);
    const double start = now();
    const Discretization d =
        discretize(bare, "diamond", matrices_only(static_cast<int>(state.range(0))));
    benchmark::DoNotOptimize(d.stiffness.valuePtr());
    state.SetIterationTime(now() - start);
  }
}

void print_ratios(const std::map<std::string, double>& best) {
  std::printf("\n%-10s %10s %10s %10s %10s %12s %16s %16s %9s\n", "mesh", "baseline s",
              "symbolic s", "numeric s", "one-shot s", "base/numeric", "base/(sym+num)",
              "base/one-shot", "memory");
  for (const std::string kind : kKinds) {
    const auto seconds = [&](const std::string& name) {
      const auto found = best.find(name);
      return found == best.end() ? 0.0 : found->second;
    };
    const double base = seconds("baseline_" + kind + "/");
    const double sym = seconds("symbolic_" + kind + "/1"), num = seconds("numeric_" + kind + "/1");
    const double shot = seconds("one_shot_" + kind + "/1");
    if (base == 0 || sym == 0 || num == 0 || shot == 0) continue;
    // A mesh without derived connectivity: both ways pay for it.
    const PolygonMesh mesh = grid(kind, n_vertices());
    const double empty = peak_megabytes([] {});
    const double theirs = peak_megabytes([&] { triplet_baseline(mesh); }) - empty;
    const double ours =
        peak_megabytes([&] { discretize(mesh, "diamond", matrices_only(1)); }) - empty;
    std::printf("%-10s %10.2f %10.3f %10.3f %10.3f %12.1f %16.1f %16.1f %4.0f/%.0f MB\n",
                kind.c_str(), base, sym, num, shot, base / num, base / (sym + num), base / shot,
                theirs, ours);
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
          ->UseManualTime();
    };
    add("baseline", baseline)->Iterations(1)->Repetitions(2);
    for (const int threads : {1, 2}) {
      add("symbolic", symbolic)->Arg(threads)->Iterations(1)->Repetitions(5);
      add("numeric", numeric)->Arg(threads)->Iterations(1)->Repetitions(5);
      add("one_shot", one_shot)->Arg(threads)->Iterations(1)->Repetitions(5);
    }
  }
  BestTimes reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  print_ratios(reporter.best);
}
