// Preconditioners made from the sparser stiffness, for conjugate gradients on that of diamonds: our
// own multigrid and incomplete factor against the algebraic multigrid of dune-istl, PETSc (GAMG)
// and hypre (BoomerAMG), as far as they are found. All solve the same systems in one run, to 1e-12
// of the right-hand side, with one thread; each in a process of its own, so that its peak memory
// can be told. Processor seconds.
//
//   OMP_NUM_THREADS=1 carat_bench_multigrid [PART_OF_A_MESH'S_NAME [METHOD...]]

#include "carat/solve/multigrid.h"

#include <malloc.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/conjugate_gradients.h"
#include "carat/solve/incomplete_cholesky.h"
#include "grids.h"
#include "measure.h"
#include "volume_grids.h"

#ifdef CARAT_BENCH_PETSC
#include <petscksp.h>
#endif
#ifdef CARAT_BENCH_DUNE
#include <dune/istl/bcrsmatrix.hh>
#include <dune/istl/bvector.hh>
#include <dune/istl/operators.hh>
#include <dune/istl/paamg/amg.hh>
#include <dune/istl/paamg/fastamg.hh>
#include <dune/istl/paamg/kamg.hh>
#include <dune/istl/preconditioners.hh>
#include <dune/istl/solvers.hh>
#endif

namespace carat::bench {
namespace {

/// Processor time: other programs on the machine do not count.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Free rows only.
struct System {
  SparseMatrix stiffness, sparser;
  Vector b;
  int dimension = 2;
  double seconds = 0, sparser_seconds = 0;  ///< to assemble the two
};

/// A factorisation: of the stiffness an exact inverse, of the sparser one the best that can be made
/// of it.
class Factor final : public Preconditioner {
 public:
  explicit Factor(const SparseMatrix& matrix) : factor_(matrix) {}
  void apply(const Vector& r, Vector& z) const override { z = factor_.solve(r); }
  std::int64_t nonzeros() const override { return factor_.info().nonzeros; }

 private:
  Cholesky factor_;
};

struct Method {
  std::string name;
  std::function<std::unique_ptr<Preconditioner>(const System&)> make;
};

class Jacobi final : public Preconditioner {
 public:
  explicit Jacobi(const System& system) : inverse_(system.sparser.diagonal().cwiseInverse()) {}
  void apply(const Vector& r, Vector& z) const override { z = inverse_.cwiseProduct(r); }
  std::int64_t nonzeros() const override { return inverse_.size(); }

 private:
  Vector inverse_;
};

#ifdef CARAT_BENCH_PETSC
class PetscPreconditioner final : public Preconditioner {
 public:
  PetscPreconditioner(const System& system, const std::string& options) {
    PetscInitializeNoArguments();
    PetscOptionsInsertString(nullptr, options.c_str());
    const SparseMatrix& a = system.sparser;
    const Index n = static_cast<Index>(a.rows());
    // PETSc writes into none of these.
    MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, const_cast<Index*>(a.outerIndexPtr()),
                              const_cast<Index*>(a.innerIndexPtr()),
                              const_cast<double*>(a.valuePtr()), &matrix_);
    MatSetOption(matrix_, MAT_SPD, PETSC_TRUE);
    VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, &r_);
    VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, &z_);
    PCCreate(PETSC_COMM_SELF, &pc_);
    PCSetOperators(pc_, matrix_, matrix_);
    PCSetFromOptions(pc_);
    PCSetUp(pc_);
    PCSetUpOnBlocks(pc_);
    PetscReal grid = 0, entries = 0;
    PCType type;
    PCGetType(pc_, &type);
    if (std::string(type) == PCGAMG) PCMGGetGridComplexity(pc_, &grid, &entries);
    nonzeros_ = static_cast<std::int64_t>(entries * static_cast<double>(a.nonZeros()));
  }
  void apply(const Vector& r, Vector& z) const override {
    z.resize(r.size());
    VecPlaceArray(r_, r.data());
    VecPlaceArray(z_, z.data());
    PCApply(pc_, r_, z_);
    VecResetArray(r_);
    VecResetArray(z_);
  }
  std::int64_t nonzeros() const override { return nonzeros_; }

 private:
  Mat matrix_ = nullptr;
  Vec r_ = nullptr, z_ = nullptr;
  PC pc_ = nullptr;
  std::int64_t nonzeros_ = 0;
};

Method petsc(const char* name, const std::string& options, const std::string& in_volumes = "") {
  return {name, [=](const System& system) {
            return std::make_unique<PetscPreconditioner>(
                system, options + (system.dimension == 3 ? " " + in_volumes : ""));
          }};
}
#endif

#ifdef CARAT_BENCH_DUNE
using DuneMatrix = Dune::BCRSMatrix<Dune::FieldMatrix<double, 1, 1>>;
using DuneVector = Dune::BlockVector<Dune::FieldVector<double, 1>>;
using DuneOperator = Dune::MatrixAdapter<DuneMatrix, DuneVector, DuneVector>;
using DuneCriterion = Dune::Amg::CoarsenCriterion<
    Dune::Amg::SymmetricCriterion<DuneMatrix, Dune::Amg::FirstDiagonal>>;
using Ssor = Dune::SeqSSOR<DuneMatrix, DuneVector, DuneVector>;
using DuneJacobi = Dune::SeqJac<DuneMatrix, DuneVector, DuneVector>;
using DuneIlu = Dune::SeqILU<DuneMatrix, DuneVector, DuneVector>;

struct DuneOptions {
  std::size_t gamma = 1;     // 2: W cycle
  std::size_t steps = 1;     // of smoothing, before and after
  double damping = 1.6;      // of the coarse correction
  double relaxation = 1;     // of the smoother
  std::size_t diameter = 2;  // of aggregates
};

DuneMatrix dune_matrix(const SparseMatrix& a) {
  const auto n = static_cast<std::size_t>(a.rows());
  DuneMatrix result(n, n, static_cast<std::size_t>(a.nonZeros()), DuneMatrix::row_wise);
  for (auto row = result.createbegin(); row != result.createend(); ++row)
    for (SparseMatrix::InnerIterator entry(a, static_cast<Index>(row.index())); entry; ++entry)
      row.insert(static_cast<std::size_t>(entry.col()));
  for (Index i = 0; i < a.rows(); ++i)
    for (SparseMatrix::InnerIterator entry(a, i); entry; ++entry)
      result[static_cast<std::size_t>(i)][static_cast<std::size_t>(entry.col())] = entry.value();
  return result;
}

DuneCriterion criterion(const System& system, const DuneOptions& options) {
  DuneCriterion result(20, 1000);
  result.setDefaultValuesIsotropic(static_cast<std::size_t>(system.dimension), options.diameter);
  result.setGamma(options.gamma);
  result.setNoPreSmoothSteps(options.steps);
  result.setNoPostSmoothSteps(options.steps);
  result.setProlongationDampingFactor(options.damping);
  result.setDebugLevel(std::getenv("CARAT_BENCH_VERBOSE") ? 2 : 0);
  return result;
}

template <class Amg>
class DunePreconditioner final : public Preconditioner {
 public:
  template <class Make>
  DunePreconditioner(const System& system, const Make& make)
      : matrix_(dune_matrix(system.sparser)), operator_(matrix_), r_(matrix_.N()), z_(matrix_.N()) {
    amg_ = make(operator_);
    r_ = 0;
    z_ = 0;
    amg_->pre(z_, r_);
  }
  void apply(const Vector& r, Vector& z) const override {
    const auto n = static_cast<std::size_t>(r.size());
    for (std::size_t i = 0; i < n; ++i) r_[i] = r[static_cast<Index>(i)];
    z_ = 0;
    amg_->apply(z_, r_);
    z.resize(r.size());
    for (std::size_t i = 0; i < n; ++i) z[static_cast<Index>(i)] = z_[i];
  }
  std::int64_t nonzeros() const override { return 0; }

 private:
  DuneMatrix matrix_;
  DuneOperator operator_;
  mutable DuneVector r_, z_;
  std::unique_ptr<Amg> amg_;
};

template <class Smoother>
Method dune(const char* name, const DuneOptions& options) {
  using Amg = Dune::Amg::AMG<DuneOperator, DuneVector, Smoother>;
  return {name, [=](const System& system) {
            return std::make_unique<DunePreconditioner<Amg>>(system, [&](const DuneOperator& op) {
              typename Dune::Amg::SmootherTraits<Smoother>::Arguments smoother;
              smoother.relaxationFactor = options.relaxation;
              return std::make_unique<Amg>(op, criterion(system, options), smoother);
            });
          }};
}

Method dune_fast(const char* name, const DuneOptions& options) {
  using Amg = Dune::Amg::FastAMG<DuneOperator, DuneVector>;
  return {name, [=](const System& system) {
            return std::make_unique<DunePreconditioner<Amg>>(system, [&](const DuneOperator& op) {
              const DuneCriterion c = criterion(system, options);
              return std::make_unique<Amg>(op, c, c, true);
            });
          }};
}

Method dune_krylov(const char* name, const DuneOptions& options) {
  using Amg = Dune::Amg::KAMG<DuneOperator, DuneVector, Ssor>;
  return {name, [=](const System& system) {
            return std::make_unique<DunePreconditioner<Amg>>(system, [&](const DuneOperator& op) {
              Dune::Amg::SmootherTraits<Ssor>::Arguments smoother;
              return std::make_unique<Amg>(op, criterion(system, options), smoother, 2, 0.1);
            });
          }};
}
#endif

std::vector<Method> methods() {
  std::vector<Method> result{
      {"own multigrid",
       [](const System& system) {
         return std::make_unique<Multigrid>(system.sparser, std::vector<bool>{}, 1);
       }},
      {"own IC(0)",
       [](const System& system) {
         return std::make_unique<IncompleteCholesky>(system.sparser, std::vector<bool>{});
       }},
      {"own multigrid of S",
       [](const System& system) {
         return std::make_unique<Multigrid>(system.stiffness, std::vector<bool>{}, 1);
       }},
      {"cholesky", [](const System& system) { return std::make_unique<Factor>(system.stiffness); }},
      {"sparser cholesky",
       [](const System& system) { return std::make_unique<Factor>(system.sparser); }},
      {"jacobi", [](const System& system) { return std::make_unique<Jacobi>(system); }}};
#ifdef CARAT_BENCH_DUNE
  result.push_back(dune<Ssor>("dune ssor V", {}));
  result.push_back(dune<Ssor>("dune ssor V2", {.steps = 2}));
  result.push_back(dune<Ssor>("dune ssor W", {.gamma = 2, .damping = 1}));
  result.push_back(dune<Ssor>("dune ssor V d3", {.diameter = 3}));
  result.push_back(dune<DuneJacobi>("dune jacobi V2", {.steps = 2, .relaxation = 0.6}));
  result.push_back(dune<DuneIlu>("dune ilu V", {}));
  result.push_back(dune_fast("dune fast V", {}));
  result.push_back(dune_fast("dune fast W", {.gamma = 2, .damping = 1}));
  result.push_back(dune_krylov("dune krylov", {.damping = 1}));
#endif
#ifdef CARAT_BENCH_PETSC
  const std::string gamg = "-pc_type gamg";
  const std::string sor =
      " -mg_levels_ksp_type richardson -mg_levels_pc_type sor -mg_levels_ksp_max_it 1";
  result.push_back(petsc("petsc gamg", gamg));
  result.push_back(petsc("petsc gamg sor", gamg + sor));
  result.push_back(petsc("petsc gamg sor .05", gamg + sor + " -pc_gamg_threshold 0.05"));
  const std::string hypre = "-pc_type hypre -pc_hypre_type boomeramg";
  result.push_back(petsc("hypre", hypre));
  result.push_back(petsc("hypre pmis",
                         hypre + " -pc_hypre_boomeramg_coarsen_type PMIS"
                                 " -pc_hypre_boomeramg_interp_type ext+i"
                                 " -pc_hypre_boomeramg_P_max 4",
                         "-pc_hypre_boomeramg_strong_threshold 0.5"));
#endif
  return result;
}

SparseMatrix of_rows(const SparseMatrix& a, const std::vector<Index>& reduced, Index size) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(static_cast<std::size_t>(a.nonZeros()));
  for (Index i = 0; i < a.rows(); ++i) {
    if (reduced[static_cast<std::size_t>(i)] < 0) continue;
    for (SparseMatrix::InnerIterator entry(a, i); entry; ++entry) {
      const Index j = reduced[static_cast<std::size_t>(entry.col())];
      if (j >= 0) entries.emplace_back(reduced[static_cast<std::size_t>(i)], j, entry.value());
    }
  }
  SparseMatrix::Plain result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return SparseMatrix(std::move(result));
}

/// Poisson's equation with a rough right-hand side and u = 0 at the boundary or, where there is
/// none, at the first vertex.
template <class Mesh>
System poisson(const Mesh& mesh, int dimension, const DiscretizationOptions& more = {}) {
  DiscretizationOptions options = more;
  options.parts = DiscretizationParts::Matrices;
  options.threads = 1;
  double start = cpu_seconds();
  const Discretization d = discretize(mesh, "diamond", options);
  System system;
  system.dimension = dimension;
  system.seconds = cpu_seconds() - start;
  start = cpu_seconds();
  const SparseMatrix sparser = sparser_stiffness(mesh, d)();
  system.sparser_seconds = cpu_seconds() - start;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  std::vector<Index> reduced(static_cast<std::size_t>(d.n_unknowns()), -1);
  Index size = 0;
  const bool closed = std::find(boundary.begin(), boundary.end(), true) == boundary.end();
  const Vector diagonal = d.stiffness.diagonal();  // 0: a vertex without faces
  for (std::size_t v = 0; v < reduced.size(); ++v)
    if (!boundary[v] && !(closed && v == 0) && diagonal[static_cast<Index>(v)] > 0)
      reduced[v] = size++;
  system.stiffness = of_rows(d.stiffness, reduced, size);
  system.sparser = of_rows(sparser, reduced, size);
  Vector f(d.n_unknowns());
  for (Index v = 0; v < f.size(); ++v) f[v] = 1 + std::sin(1e4 * std::sin(static_cast<double>(v)));
  const Vector b = d.mass * f;
  system.b.resize(size);
  for (std::size_t v = 0; v < reduced.size(); ++v)
    if (reduced[v] >= 0) system.b[reduced[v]] = b[static_cast<Index>(v)];
  return system;
}

double maximum_norm(const SparseMatrix& a) {
  return (a.cwiseAbs() * Vector::Ones(a.cols())).maxCoeff();
}

struct Result {
  double setup = 0, solve = 0, solve_sparser = 0, complexity = 0;
  int iterations = -1, iterations_sparser = -1;
  char failure[200] = "";
};

Result run(const System& system, const Method& method) {
  Result result;
  try {
    double start = cpu_seconds();
    const std::unique_ptr<Preconditioner> preconditioner = method.make(system);
    result.setup = cpu_seconds() - start;
    result.complexity = static_cast<double>(preconditioner->nonzeros()) /
                        static_cast<double>(system.sparser.nonZeros());
    const auto solve = [&](const SparseMatrix& a, double& seconds, int& iterations) {
      const double norm = maximum_norm(a);
      const SparseMatrix::Plain& plain = a;
      start = cpu_seconds();
      SolveReport report;
      conjugate_gradients([&](const Vector& x, Vector& y) { y.noalias() = plain * x; },
                          *preconditioner, system.b, norm, {.iterations = 2000}, report);
      seconds = cpu_seconds() - start;
      iterations = report.iterations;
    };
    solve(system.stiffness, result.solve, result.iterations);
    solve(system.sparser, result.solve_sparser, result.iterations_sparser);
  } catch (const std::exception& failure) {
    std::snprintf(result.failure, sizeof result.failure, "%s", failure.what());
  }
  return result;
}

using Words = std::vector<std::string>;

void compare(const std::string& mesh, const System& system, const Words& wanted) {
  std::printf("\n%s: %d unknowns; assembled in %.3f s, %lld entries; the sparser in %.3f s, %lld\n",
              mesh.c_str(), static_cast<int>(system.b.size()), system.seconds,
              static_cast<long long>(system.stiffness.nonZeros()), system.sparser_seconds,
              static_cast<long long>(system.sparser.nonZeros()));
  std::printf("%-20s %8s %8s %8s %7s %6s %6s %6s | %8s %6s\n", "", "setup s", "solve s", "total s",
              "ratio", "iter.", "compl.", "MB", "sparser:", "iter.");
  malloc_trim(0);  // what is free already would be used and not be counted
  const double empty = peak_megabytes([] {});
  double first = 0;
  for (const Method& method : methods()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), method.name) == wanted.end())
      continue;
    void* const shared =
        mmap(nullptr, sizeof(Result), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    new (shared) Result{.failure = "it crashed"};
    std::fflush(stdout);
    const double peak =
        peak_megabytes([&] { *static_cast<Result*>(shared) = run(system, method); });
    const Result result = *static_cast<Result*>(shared);
    munmap(shared, sizeof(Result));
    if (result.iterations < 0) {
      std::printf("%-20s failed: %s\n", method.name.c_str(), result.failure);
      continue;
    }
    const double total = result.setup + result.solve;
    if (first == 0) first = total;
    std::printf("%-20s %8.3f %8.3f %8.3f %7.2f %6d %6.2f %6.0f | %8.3f %6d %s\n",
                method.name.c_str(), result.setup, result.solve, total, total / first,
                result.iterations, result.complexity, peak - empty, result.solve_sparser,
                result.iterations_sparser, result.failure);
  }
  std::fflush(stdout);
}

/// A mesh with its system; made when its turn comes.
struct Case {
  std::string name;
  std::function<System()> make;
};

std::vector<Case> cases() {
  const auto surface = [](const char* kind, Index n) {
    return [=] { return poisson(grid(kind, n), 2); };
  };
  const auto volume = [](const char* kind, Index n) {
    return [=] { return poisson(volume_grid(kind, n), 3); };
  };
  const auto family = [](const char* name, int level, double jitter, double anisotropy) {
    return [=] {
      return poisson(
          generate_mesh(name, {.level = level, .jitter = jitter, .anisotropy = anisotropy}), 2);
    };
  };
  const auto volume_family = [](const char* name, int level, double jitter, double anisotropy) {
    return [=] {
      return poisson(
          generate_volume(name, {.level = level, .jitter = jitter, .anisotropy = anisotropy}), 3);
    };
  };
  // Stripes and blocks, in which the coefficient is `jump` times as large.
  const auto jumps = [](double jump) {
    return [=](const Vec3& x) {
      const Vec3 at = x / 20;
      const bool odd =
          (static_cast<int>(std::floor(at.x())) + static_cast<int>(std::floor(at.y())) +
           static_cast<int>(std::floor(at.z()))) %
              2 !=
          0;
      return odd ? jump : 1;
    };
  };
  return {
      {"triangles 100k", surface("triangles", 100000)},
      {"hexagons 100k", surface("hexagons", 100000)},
      {"anisotropic triangles", family("plane-triangles", 5, 0.2, 10)},
      {"voronoi", family("plane-voronoi", 5, 0.2, 1)},
      {"concave", family("plane-concave", 6, 0.2, 1)},
      {"jump triangles 1e4",
       [=] { return poisson(grid("triangles", 100000), 2, {.coefficient = jumps(1e4)}); }},
      {"jump hexagons 1e4",
       [=] { return poisson(grid("hexagons", 100000), 2, {.coefficient = jumps(1e4)}); }},
      {"jump tets 1e4",
       [=] { return poisson(volume_grid("tets", 30000), 3, {.coefficient = jumps(1e4)}); }},
      {"tets 30k", volume("tets", 30000)},
      {"tets 228k", volume("tets", 228000)},
      {"hexahedra 36k", volume("hexahedra", 36000)},
      {"hexahedra 275k", volume("hexahedra", 275000)},
      {"truncated 27k", volume("truncated", 27000)},
      {"truncated 94k", volume("truncated", 94000)},
      {"adaptive tets", volume_family("cube-tets-adaptive", 4, 0.2, 1)},
      {"cells of voronoi", volume_family("cube-voronoi", 2, 0.2, 1)},
      {"slivers", family("plane-triangles", 6, 0.5, 100)},
      {"flat hexahedra", volume_family("cube-hexahedra", 4, 0.2, 100)},
      {"closed sphere", family("sphere-hexagons", 6, 0.2, 1)},
      {"triangles 1M", surface("triangles", 1000000)},
      {"hexagons 1M", surface("hexagons", 1000000)},
  };
}

}  // namespace
}  // namespace carat::bench

int main(int argc, char** argv) {
  using namespace carat::bench;
  const std::string wanted = argc > 1 ? argv[1] : "";
  for (const Case& one : cases())
    if (one.name.find(wanted) != std::string::npos)
      compare(one.name, one.make(), Words(argv + std::min(argc, 2), argv + argc));
}
