// Products with the diamond's stiffness: the matrix beside its triangle and the factors, 1 and 8
// vectors, on meshes of all kinds, in one run.
//
//   carat_bench_products [--benchmark_filter=hexagons] [--benchmark_...]
//
// Names are FORM/MESH/VECTORS/threads:N. CARAT_BENCH_VERTICES makes the surfaces smaller, volumes
// have a ninth as many vertices.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "carat/operators/registry.h"
#include "carat/solve/matrix_operator.h"
#include "carat/solve/symmetric_matrix.h"
#include "grids.h"
#include "measure.h"
#include "volume_grids.h"

namespace carat::bench {
namespace {

constexpr const char* kMeshes[] = {"triangles", "quads",     "hexagons",
                                   "tets",      "hexahedra", "truncated"};

Index surface_size() {
  const char* const text = std::getenv("CARAT_BENCH_VERTICES");
  return text != nullptr ? std::atoi(text) : 1000000;
}

std::shared_ptr<const SymmetricOperator> make(const std::string& form, const std::string& kind,
                                              int threads) {
  DiscretizationOptions options{.parts = DiscretizationParts::Matrices, .threads = threads};
  const bool surface = kind == "triangles" || kind == "quads" || kind == "hexagons";
  if (form == "product") options.form = OperatorForm::Products;
  Discretization d = surface
                         ? discretize(grid(kind, surface_size()), "diamond", options)
                         : discretize(volume_grid(kind, surface_size() / 9), "diamond", options);
  if (d.stiffness_product) return d.stiffness_product;
  if (form == "triangle") return std::make_shared<SymmetricMatrix>(std::move(d.stiffness), threads);
  return std::make_shared<MatrixOperator>(std::make_shared<SparseMatrix>(std::move(d.stiffness)),
                                          threads);
}

void multiply(benchmark::State& state, const std::string& form, const std::string& kind, Index k,
              int threads) {
  const auto a = make(form, kind, threads);
  const Matrix x = Matrix::Random(k, a->rows());
  Matrix y(k, a->rows());
  for (auto _ : state) {
    a->multiply(x.data(), y.data(), k);
    benchmark::DoNotOptimize(y.data());
    benchmark::ClobberMemory();
  }
  state.counters["MB"] = static_cast<double>(a->bytes()) * 1e-6;
  state.counters["rows"] = a->rows();
}

void print_ratios(const BestTimes& times) {
  std::printf("\n%-10s %8s %8s | %12s %12s %12s\n", "mesh", "vectors", "threads", "matrix ms",
              "triangle ms", "product ms");
  for (const char* const kind : kMeshes)
    for (const int k : {1, 8})
      for (const int threads : {1, 2}) {
        std::printf("%-10s %8d %8d |", kind, k, threads);
        for (const char* const form : {"matrix", "triangle", "product"}) {
          const auto found =
              times.best.find(std::string(form) + "/" + kind + "/" + std::to_string(k) +
                              "/threads:" + std::to_string(threads) + "/");
          if (found == times.best.end())
            std::printf(" %12s", "-");
          else
            std::printf(" %12.2f", 1e3 * found->second);
        }
        std::printf("\n");
      }
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const std::string kind : kMeshes)
    for (const int k : {1, 8})
      for (const int threads : {1, 2})
        for (const std::string form : {"matrix", "triangle", "product"})
          benchmark::RegisterBenchmark(
              (form + "/" + kind + "/" + std::to_string(k) + "/threads:" + std::to_string(threads))
                  .c_str(),
              [=](benchmark::State& state) { multiply(state, form, kind, k, threads); })
              ->Unit(benchmark::kMillisecond)
              ->UseRealTime();
  BestTimes times;
  benchmark::RunSpecifiedBenchmarks(&times);
  print_ratios(times);
}
