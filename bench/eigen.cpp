// Eigenpairs of the diamond Laplacian on surfaces and in volumes: block Lanczos by a factorisation,
// in volumes the iteration with multigrid too, against Spectra's shift-invert mode, which may miss
// members of clusters, with the same factorisation, in the same run: processor seconds and peak
// memory. Threads of BLAS would be counted too, so leave it one.
//
//   OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 carat_bench_eigen [PAIRS [SURFACE_VERTICES
//                                                              [VOLUME_VERTICES]]]
//
// Default: 50 100000 50000

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <sys/mman.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

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

struct Result {
  double seconds = 0, factor_seconds = 0, residual = 0, first_value = 0, solves = 0;
};

Result run_ours(const Discretization& d, Index count, const EigenOptions& options) {
  const double start = cpu_seconds();
  const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, count, {}, options);
  return {cpu_seconds() - start, pairs.factor.analyse_seconds + pairs.factor.factor_seconds,
          pairs.residuals.maxCoeff(), pairs.values[pairs.zero_modes],
          static_cast<double>(pairs.solves)};
}

/// Plain use of Spectra: a shift below zero that is small beside the first eigenvalue.
Result run_spectra(const Discretization& d, Index count, double shift) {
  const double start = cpu_seconds();
  using Product = Spectra::SparseSymMatProd<double, Eigen::Lower, Eigen::RowMajor>;
  ShiftedInverse inverse(d);
  const SparseMatrix::Plain& mass_matrix = d.mass;
  Product mass(mass_matrix);
  Spectra::SymGEigsShiftSolver<ShiftedInverse, Product, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, 2 * count, shift);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-10, Spectra::SortRule::SmallestAlge);
  const double seconds = cpu_seconds() - start;
  return {seconds, 0, worst_residual(d, solver.eigenvalues(), solver.eigenvectors()), 0,
          static_cast<double>(solver.num_operations())};
}

/// Runs in a process of its own: its peak memory can be told, and threads of the libraries would
/// not outlive a fork.
template <class Work>
Result run_apart(const Work& work, double& megabytes) {
  void* const shared =
      mmap(nullptr, sizeof(Result), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  megabytes = peak_megabytes([&] { *static_cast<Result*>(shared) = work(); });
  const Result result = *static_cast<Result*>(shared);
  munmap(shared, sizeof(Result));
  return result;
}

void print(const std::string& mesh, const char* method, const Result& result, double megabytes,
           double baseline) {
  std::printf("%-12s %-12s %8.2f %8.2f %8.0f %10.1e %8.0f %8.2f\n", mesh.c_str(), method,
              result.factor_seconds, result.seconds, result.solves, result.residual, megabytes,
              baseline / result.seconds);
  std::fflush(stdout);
}

void compare(const std::string& mesh, const Discretization& d, Index count,
             const std::vector<EigenOptions>& ways) {
  const double empty = peak_megabytes([] {});
  std::vector<Result> results;
  std::vector<double> peaks(ways.size());
  for (std::size_t i = 0; i < ways.size(); ++i)
    results.push_back(run_apart([&] { return run_ours(d, count, ways[i]); }, peaks[i]));
  double peak = 0;
  const Result spectra =
      run_apart([&] { return run_spectra(d, count, -0.1 * results[0].first_value); }, peak);
  for (std::size_t i = 0; i < ways.size(); ++i)
    print(mesh, eigen_method_name(ways[i].method), results[i], peaks[i] - empty, spectra.seconds);
  print(mesh, "spectra", spectra, peak - empty, spectra.seconds);
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat;
  using namespace carat::bench;
  const auto argument = [&](int i, int otherwise) {
    return argc > i ? std::atoi(argv[i]) : otherwise;
  };
  const Index count = argument(1, 50);
  const DiscretizationOptions options{.parts = DiscretizationParts::Matrices};
  std::printf("%-12s %-12s %8s %8s %8s %10s %8s %8s\n", "mesh", "method", "factor s", "total s",
              "solves", "residual", "MB", "ratio");
  std::fflush(stdout);
  const EigenOptions cholesky{.method = EigenMethod::Cholesky, .threads = 1};
  for (const std::string kind : {"triangles", "hexagons"})
    compare(kind, discretize(grid(kind, argument(2, 100000)), "diamond", options), count,
            {cholesky});
  for (const std::string kind : {"tets", "hexahedra"}) {
    const PolyhedralMesh mesh = volume_grid(kind, argument(3, 50000));
    const Discretization d = discretize(mesh, "diamond", options);
    compare(kind, d, count,
            {cholesky,
             {.method = EigenMethod::Iterative,
              .dimension = 3,
              .sparser = sparser_stiffness(mesh, d),
              .threads = 1}});
  }
}
