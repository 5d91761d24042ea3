// Eigenpairs of the diamond Laplacian on surfaces and in volumes: block Lanczos by a factorisation,
// in volumes by conjugate gradients too, against Spectra's shift-invert mode with the same
// factorisation, which may miss members of clusters, in the same run. Every case runs in a process
// of its own, for its peak memory beyond the matrices. Seconds are the processor's; threads of BLAS
// would be counted too, so leave it one: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1.
//
//   carat_bench_eigen [--benchmark_filter=REGEX] [--benchmark_...]
//
// Names are METHOD/MESH/VERTICES/PAIRS. CARAT_BENCH_LARGEST leaves out larger meshes.

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "carat/base/memory.h"
#include "carat/operators/registry.h"
#include "carat/solve/eigen_solver.h"
#include "grids.h"
#include "measure.h"
#include "volume_grids.h"

namespace carat::bench {
namespace {

/// Processor time: other programs on the machine do not count.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// (S - shift M)^-1 for Spectra.
class ShiftedInverse {
 public:
  using Scalar = double;
  explicit ShiftedInverse(const Discretization& d) : d_(d) {}
  Eigen::Index rows() const { return d_.n_vertices(); }
  Eigen::Index cols() const { return d_.n_vertices(); }
  void set_shift(double shift) {
    std::vector<bool> unused(static_cast<std::size_t>(rows()));
    const Vector diagonal = d_.mass.diagonal();
    for (Eigen::Index i = 0; i < rows(); ++i) unused[i] = diagonal[i] == 0;
    solver_ = std::make_unique<Cholesky>(SparseMatrix(d_.stiffness - shift * d_.mass), unused);
  }
  void perform_op(const double* in, double* out) const {
    const Eigen::Index n = rows();
    Eigen::Map<Vector>(out, n) = solver_->solve(Eigen::Map<const Vector>(in, n));
  }

 private:
  const Discretization& d_;
  std::unique_ptr<Cholesky> solver_;
};

double worst_residual(const Discretization& d, const Vector& values, const Matrix& vectors) {
  double worst = 0;
  for (Index k = 0; k < values.size(); ++k) {
    const Vector m_x = d.mass * vectors.col(k);
    if (k > 0)
      worst = std::max(worst, (d.stiffness * vectors.col(k) - values[k] * m_x).norm() /
                                  (values[k] * m_x.norm()));
  }
  return worst;
}

struct Case {
  std::string method, mesh;
  Index size, pairs;
};

/// What a case's process sends back.
struct Outcome {
  double seconds = 0, factor_seconds = 0, residual = 0, solves = 0, megabytes = 0, vertices = 0;
};

Outcome run_ours(const Discretization& d, Index pairs, const EigenOptions& options) {
  Outcome outcome;
  const double start = cpu_seconds();
  const EigenPairs found = smallest_eigenpairs(d.stiffness, d.mass, pairs, {}, options);
  outcome.seconds = cpu_seconds() - start;
  outcome.factor_seconds = found.factor.analyse_seconds + found.factor.factor_seconds;
  outcome.residual = found.residuals.maxCoeff();
  outcome.solves = found.solves;
  return outcome;
}

/// Plain use of Spectra: a shift below zero that is small beside the first eigenvalue.
Outcome run_spectra(const Discretization& d, Index pairs, double shift) {
  Outcome outcome;
  const double start = cpu_seconds();
  using Product = Spectra::SparseSymMatProd<double, Eigen::Lower, Eigen::RowMajor>;
  ShiftedInverse inverse(d);
  const SparseMatrix::Plain& mass_matrix = d.mass;
  Product mass(mass_matrix);
  Spectra::SymGEigsShiftSolver<ShiftedInverse, Product, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, pairs, 2 * pairs, shift);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-10, Spectra::SortRule::SmallestAlge);
  outcome.seconds = cpu_seconds() - start;
  outcome.residual = worst_residual(d, solver.eigenvalues(), solver.eigenvectors());
  outcome.solves = static_cast<double>(solver.num_operations());
  return outcome;
}

template <class Mesh>
Outcome find(const Case& wanted, const Mesh& mesh, int dimension) {
  const Discretization d =
      discretize(mesh, "diamond", {.parts = DiscretizationParts::Matrices, .threads = 1});
  EigenOptions options{.method = EigenMethod::Cholesky, .dimension = dimension, .threads = 1};
  double shift = 0;
  if (wanted.method == "spectra")
    shift = -0.1 * smallest_eigenpairs(d.stiffness, d.mass, 2, {}, options).values[1];
  restart_peak_memory();
  const auto before = static_cast<double>(peak_memory());
  Outcome outcome;
  if (wanted.method == "spectra") {
    outcome = run_spectra(d, wanted.pairs, shift);
  } else {
    options.method = eigen_method(wanted.method);
    options.sparser = sparser_stiffness(mesh, d);
    outcome = run_ours(d, wanted.pairs, options);
  }
  outcome.megabytes = (static_cast<double>(peak_memory()) - before) / (1 << 20);
  outcome.vertices = mesh.n_vertices();
  return outcome;
}

/// Mesh, vertices, pairs -> method -> outcome.
std::map<std::tuple<std::string, Index, Index>, std::map<std::string, Outcome>> outcomes;

void measure(benchmark::State& state, const Case& wanted) {
  for (auto _ : state) {
    const Outcome outcome = in_process<Outcome>([&] {
      return wanted.mesh == "triangles" || wanted.mesh == "hexagons"
                 ? find(wanted, grid(wanted.mesh, wanted.size), 2)
                 : find(wanted, volume_grid(wanted.mesh, wanted.size), 3);
    });
    if (!(outcome.vertices > 0)) {
      state.SkipWithError("the process ended without a result");
      return;
    }
    state.SetIterationTime(outcome.seconds);
    state.counters["factor_s"] = outcome.factor_seconds;
    state.counters["residual"] = outcome.residual;
    state.counters["solves"] = outcome.solves;
    state.counters["peak_MB"] = outcome.megabytes;
    state.counters["vertices"] = outcome.vertices;
    outcomes[{wanted.mesh, wanted.size, wanted.pairs}][wanted.method] = outcome;
  }
}

void print_ratios() {
  std::printf("\n%-10s %9s %6s %-10s %8s %8s %7s %9s %8s %8s\n", "mesh", "vertices", "pairs",
              "method", "factor s", "total s", "solves", "residual", "peak MB", "Spectra/");
  for (const auto& [key, methods] : outcomes) {
    const auto baseline = methods.find("spectra");
    for (const auto& [method, o] : methods)
      std::printf("%-10s %9.0f %6d %-10s %8.2f %8.2f %7.0f %9.1e %8.0f %8.2f\n",
                  std::get<0>(key).c_str(), o.vertices, std::get<2>(key), method.c_str(),
                  o.factor_seconds, o.seconds, o.solves, o.residual, o.megabytes,
                  baseline == methods.end() ? 0.0 : baseline->second.seconds / o.seconds);
  }
}

void add(const Case& wanted) {
  const char* const largest = std::getenv("CARAT_BENCH_LARGEST");
  if (largest != nullptr && wanted.size > std::atoi(largest)) return;
  const std::string name = wanted.method + "/" + wanted.mesh + "/" + std::to_string(wanted.size) +
                           "/" + std::to_string(wanted.pairs);
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) { measure(state, wanted); })
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1);
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const carat::Index size : {20000, 100000})
    for (const char* const mesh : {"triangles", "hexagons"})
      for (const carat::Index pairs : {50, 200})
        for (const char* const method : {"cholesky", "spectra"}) add({method, mesh, size, pairs});
  for (const carat::Index size : {10000, 50000})
    for (const char* const mesh : {"tets", "hexahedra"})
      for (const char* const method : {"cholesky", "iterative", "spectra"})
        add({method, mesh, size, 50});
  add({"iterative", "hexahedra", 275000, 50});
  benchmark::RunSpecifiedBenchmarks();
  print_ratios();
}
