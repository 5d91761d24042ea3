// Reading and writing meshes with one scalar field, in every format that does both, beside
// Poisson's equation on the same mesh in the same run: from the mesh in memory to u, with one
// thread.
//
//   carat_bench_io [--benchmark_filter=REGEX] [--benchmark_...]
//
// Names are read/FORMAT/MESH, write/FORMAT/MESH, poisson/MESH. CARAT_BENCH_VERTICES: about how many
// vertices a surface has, and a volume at most. Files go to
// the folder for temporary files.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "carat/apps/poisson.h"
#include "carat/io/mesh_file.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "grids.h"
#include "measure.h"
#include "volume_grids.h"

namespace carat::bench {
namespace {

namespace fs = std::filesystem;

/// Benchmark -> best seconds, megabytes of the file.
struct Best {
  double seconds = 0, megabytes = 0;
};
std::map<std::string, Best> best;

template <class Mesh>
void solve_poisson(const Mesh& mesh) {
  BoundaryConditions conditions;
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[static_cast<std::size_t>(v)]) conditions.dirichlet_vertices.push_back(v);
  conditions.dirichlet_values.assign(conditions.dirichlet_vertices.size(), 0);
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  options.threads = 1;
  const Poisson poisson(mesh, discretize(mesh, "diamond", options), conditions, {.threads = 1});
  poisson.solve(Vector::Ones(mesh.n_vertices()));
}

void write(const fs::path& path, const SurfaceData& data) {
  write_surface(path, data.mesh, data.fields);
}
void write(const fs::path& path, const VolumeData& data) {
  write_volume(path, data.mesh, data.fields);
}

/// \param prepare    done before, not measured
/// \param megabytes  of the file, asked for after the work; empty: there is none
void add(const std::string& name, const std::function<void()>& prepare,
         const std::function<void()>& work, const std::function<double()>& megabytes) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) {
                                 prepare();
                                 for (auto _ : state) {
                                   const double start = now();
                                   work();
                                   const double seconds = now() - start;
                                   state.SetIterationTime(seconds);
                                   Best& known = best[name];
                                   if (known.seconds == 0 || seconds < known.seconds)
                                     known.seconds = seconds;
                                   if (!megabytes) continue;
                                   known.megabytes = megabytes();
                                   state.counters["MB"] = known.megabytes;
                                   state.counters["MB/s"] = known.megabytes / seconds;
                                 }
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1)
      ->Repetitions(3);
}

/// \param make  the mesh and its field; made when it is first needed
template <class Data>
void add_mesh(const std::string& mesh, const fs::path& folder,
              const std::function<decltype(Data::mesh)()>& make) {
  const auto data = std::make_shared<std::unique_ptr<Data>>();
  const auto get = [=]() -> const Data& {
    if (!*data) {
      *data = std::make_unique<Data>(Data{make(), {}});
      const Vector u = (*data)->mesh.points().col(0).array().sin();
      (*data)->fields.vertex = {{"u", 1, {u.data(), u.data() + u.size()}}};
    }
    return **data;
  };
  const auto make_data = [=] { get(); };
  const auto solve = [=] { solve_poisson(get().mesh); };
  add("poisson/" + mesh, make_data, solve, nullptr);
  constexpr bool volume = std::is_same_v<Data, VolumeData>;
  for (const FileFormat& format : file_formats()) {
    if (!(volume ? format.reads_volumes && format.writes_volumes : format.reads && format.writes))
      continue;
    const fs::path path = folder / (mesh + format.extensions[0]);
    const auto megabytes = [=] { return 1e-6 * static_cast<double>(fs::file_size(path)); };
    const std::string suffix = "/" + format.name + "/" + mesh;
    const auto make_file = [=] {
      if (!fs::exists(path)) write(path, get());
    };
    const auto write_file = [=] { write(path, get()); };
    const auto read_file = [=] { read_mesh(path); };
    add("write" + suffix, make_data, write_file, megabytes);
    add("read" + suffix, make_file, read_file, megabytes);
  }
}

void print_table() {
  std::printf("\n%-24s %9s %8s %8s | %11s\n", "file", "MB", "s", "MB/s", "s / Poisson");
  for (const auto& [name, result] : best) {
    const auto poisson = best.find("poisson/" + name.substr(name.rfind('/') + 1));
    if (poisson == best.end() || poisson->first == name) continue;
    std::printf("%-24s %9.1f %8.3f %8.0f | %11.2f\n", name.c_str(), result.megabytes,
                result.seconds, result.megabytes / result.seconds,
                result.seconds / poisson->second.seconds);
  }
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat;
  using namespace carat::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const char* const given = std::getenv("CARAT_BENCH_VERTICES");
  const Index size = given != nullptr ? std::atoi(given) : 1000000;
  const fs::path folder =
      fs::temp_directory_path() / ("carat_bench_io." + std::to_string(::getpid()));
  fs::create_directory(folder);
  for (const std::string mesh : {"triangles", "quads", "hexagons"})
    add_mesh<SurfaceData>(mesh, folder, [=] { return grid(mesh, size); });
  for (const std::string mesh : {"tets", "hexahedra"})
    add_mesh<VolumeData>(mesh, folder,
                         [=] { return volume_grid(mesh, std::min<Index>(size, 275000)); });
  benchmark::RunSpecifiedBenchmarks();
  fs::remove_all(folder);
  print_table();
}
