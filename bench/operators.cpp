// Every operator of the registry on families of meshes: assembly in both phases, entries of the
// stiffness beside those of the sparsest polygon operator (bunge), and Poisson's equation with
// Franke's function: error at the vertices and seconds of factorisation and solution.
//
//   carat_bench_operators [--benchmark_filter=cube-hexahedra] [--benchmark_list_tests]
//
// CARAT_BENCH_LEVEL=3 makes the meshes smaller (surfaces two levels finer).

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

#include "carat/apps/poisson.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "carat/report/franke.h"

namespace carat::bench {
namespace {

int level() {
  const char* const text = std::getenv("CARAT_BENCH_LEVEL");
  return text != nullptr ? std::atoi(text) : 3;
}

bool defined_on(const std::string& family, bool simplices_only) {
  return !simplices_only || family.find("-tri") != std::string::npos ||
         family.find("-tets") != std::string::npos;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Root mean square error at the vertices.
template <class Mesh>
double solve(const Mesh& mesh, const Discretization& d) {
  const bool volume = std::is_same_v<Mesh, PolyhedralMesh>;
  const auto exact = volume ? measures::franke_3d : measures::franke;
  const auto laplacian = volume ? measures::franke_3d_laplacian : measures::franke_laplacian;
  const Index n = mesh.n_vertices();
  const std::vector<bool> boundary = boundary_vertices(mesh);
  BoundaryConditions conditions;
  conditions.dirichlet_function = exact;
  Vector u(n), f(d.n_unknowns());
  for (Index v = 0; v < n; ++v) {
    u[v] = exact(mesh.point(v));
    f[v] = -laplacian(mesh.point(v));
    if (!boundary[static_cast<std::size_t>(v)]) continue;
    conditions.dirichlet_vertices.push_back(v);
    conditions.dirichlet_values.push_back(u[v]);
  }
  for (Index k = 0; k < d.extra.size(); ++k)
    f[n + k] = -laplacian(Vec3(d.extra.positions.row(k).transpose()));
  return (Poisson(mesh, d, conditions).solve(f).values.head(n) - u).norm() / std::sqrt(n);
}

template <class Entry, class Mesh>
void measure(benchmark::State& state, const Entry& entry, const Mesh& mesh) {
  DiscretizationOptions options{.parts = DiscretizationParts::Matrices, .threads = 1};
  const auto start = std::chrono::steady_clock::now();
  const auto assembly = entry.prepare(mesh, options);
  const double symbolic = seconds_since(start);
  for ([[maybe_unused]] auto unused : state) assembly->reassemble(mesh.points());
  const Discretization d = assembly->release();
  const auto before = std::chrono::steady_clock::now();
  const double error = solve(mesh, d);
  state.counters["solve_s"] = seconds_since(before);
  state.counters["symbolic_s"] = symbolic;
  state.counters["unknowns"] = d.n_unknowns();
  state.counters["nnz"] = static_cast<double>(d.stiffness.nonZeros());
  // On regular meshes many couplings cancel.
  const auto entries = Eigen::Map<const Vector>(d.stiffness.valuePtr(), d.stiffness.nonZeros());
  state.counters["nnz_not_0"] =
      static_cast<double>((entries.array().abs() > 1e-12 * entries.cwiseAbs().maxCoeff()).count());
  options.threads = 0;
  state.counters["nnz/bunge"] =
      static_cast<double>(d.stiffness.nonZeros()) /
      static_cast<double>(discretize(mesh, "bunge", options).stiffness.nonZeros());
  state.counters["rmse"] = error;
}

template <class Operators, class Families>
void register_all(const Operators& operators, const Families& families, const char* domain,
                  int level) {
  for (const auto& family : families) {
    if (std::string(family.domain) != domain) continue;
    // Polyhedra with many vertices fill factors; one level less has as many entries.
    const bool voronoi = std::string(family.name) == "cube-voronoi";
    for (const auto* entry : operators)
      if (defined_on(family.name, entry->claims.simplices_only))
        benchmark::RegisterBenchmark(
            (std::string(family.name) + "/" + entry->name).c_str(),
            [entry, &family, level = level - voronoi](benchmark::State& state) {
              measure(state, *entry, family.generate({.level = level}));
            })
            ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  bench::register_all(surface_operators(), mesh_families(), "unit square", bench::level() + 2);
  bench::register_all(volume_operators(), volume_families(), "unit cube", bench::level());
  benchmark::RunSpecifiedBenchmarks();
}
