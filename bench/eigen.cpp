// Eigenpairs of the diamond Laplacian on surfaces and in volumes: rounds of Spectra until no pair
// is missing, against its plain shift-invert mode, which may miss some, in the same run and with
// the same factorisation: processor seconds and peak memory. Threads of BLAS would be counted too,
// so leave it one.
//
//   OMP_NUM_THREADS=1 carat_bench_eigen [PAIRS [SURFACE_VERTICES [VOLUME_VERTICES]]]
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
  double seconds, factor_seconds, residual, first_value, solves;
};

Result run_ours(const Discretization& d, Index count) {
  const double start = cpu_seconds();
  const EigenPairs pairs = smallest_eigenpairs(d.stiffness, d.mass, count);
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

void compare(const std::string& name, const Discretization& d, Index count) {
  const double empty = peak_megabytes([] {});
  double our_peak = 0, their_peak = 0;
  const Result ours = run_apart([&] { return run_ours(d, count); }, our_peak);
  const Result theirs =
      run_apart([&] { return run_spectra(d, count, -0.1 * ours.first_value); }, their_peak);
  std::printf("%-16s %8d %8.2f | %8.2f %8.4f %6.0f %9.1e %6.0f | %8.2f %8.4f %6.0f %9.1e %6.0f\n",
              name.c_str(), d.n_vertices(), ours.factor_seconds, ours.seconds, ours.seconds / count,
              ours.solves, ours.residual, our_peak - empty, theirs.seconds, theirs.seconds / count,
              theirs.solves, theirs.residual, their_peak - empty);
  std::fflush(stdout);
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
  std::printf("%-16s %8s %8s | %8s %8s %6s %9s %6s | %8s (Spectra)\n", "mesh", "vertices",
              "factor s", "total s", "s/pair", "solves", "residual", "MB", "the same");
  std::fflush(stdout);
  for (const std::string kind : {"triangles", "hexagons"})
    compare(kind, discretize(grid(kind, argument(2, 100000)), "diamond", options), count);
  for (const std::string kind : {"tets", "hexahedra"})
    compare(kind, discretize(volume_grid(kind, argument(3, 50000)), "diamond", options), count);
}
