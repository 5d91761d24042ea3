#include "carat/distributed/eigenmodes.h"

#include <slepceps.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "carat/base/text.h"
#include "carat/distributed/eigen_checkpoint.h"
#include "carat/distributed/processes.h"
#include "carat/distributed/spd_iteration.h"
#include "carat/operators/common.h"

namespace carat {
namespace {

using SlepcSolver = PetscOwner<EPS, EPSDestroy>;

/// Of the eigenvalues of (S + shift M)^-1 M, beside which those of S lose no accuracy.
constexpr double kTolerance = 1e-11;
/// Values that differ by less are the same.
constexpr double kCluster = 1e-8;
/// Pairs from one checkpoint to the next.
constexpr Index kBatch = 24;
/// Pairs of a checkpoint with a larger residual belong to another problem.
constexpr double kSameProblem = 1e-6;

constexpr int dimension(const PolygonMesh&) { return 2; }
constexpr int dimension(const PolyhedralMesh&) { return 3; }

/// Weyl's estimate of the first eigenvalue of a domain.
double first_eigenvalue(double measure, int dimension) {
  constexpr double pi = std::numbers::pi;
  return dimension == 2 ? 4 * pi / measure : std::pow(6 * pi * pi / measure, 2.0 / 3);
}

using Pair = DistributedPair;

/// How eigenpairs were found, over all solvers that took part.
struct Work {
  std::string method = "eigenpairs of the checkpoint";
  Index iterations = 0;  // of the inner solver
  Index found = 0;       // pairs before this solver's
  std::function<void(Index)> progress{};
};

PetscErrorCode show_progress(EPS, PetscInt, PetscInt converged, PetscScalar*, PetscScalar*,
                             PetscReal*, PetscInt, void* work) {
  const Work& it = *static_cast<const Work*>(work);
  it.progress(it.found + static_cast<Index>(converged));
  return 0;
}

/// S x = lambda M x with rows that take no part far above all eigenvalues.
class Problem {
 public:
  template <class Mesh>
  Problem(const MeshPart<Mesh>& part, const Discretization& d,
          const std::vector<Index>& dirichlet_vertices);

  /// The smallest pairs orthogonal to the given vectors by mass.
  std::vector<Pair> smallest(Index count, const std::vector<Vec>& complement, Work& work) const;
  /// Constants of components that no fixed row touches, normalised.
  std::vector<PetscVector> constants() const;
  void normalise(Vec x) const;
  double residual(const Pair& pair) const;

  PartExchange exchange;
  Index n_free = 0;  // of all processes
  Vector free;       // own row -> 1, or 0: takes no part

 private:
  PetscMatrix stiffness_, mass_, like_;
  double shift_ = 0;
  int dimension_;
  std::vector<Index> components_;  // of the own rows
  std::size_t n_components_;
};

template <class Mesh>
Problem::Problem(const MeshPart<Mesh>& part, const Discretization& d,
                 const std::vector<Index>& dirichlet_vertices)
    : exchange(part.numbers),
      dimension_(dimension(part.mesh)),
      n_components_(static_cast<std::size_t>(part.numbers.n_components)) {
  const PartNumbers& numbers = part.numbers;
  Vector is_free = Vector::Zero(exchange.n_own());
  Vector row_sums;
  SparseMatrix sparser;
  components_.resize(static_cast<std::size_t>(exchange.n_own()));
  together([&] {
    require_vertex_unknowns(d, "eigenmodes");
    const Index n = part.mesh.n_vertices();
    for (Index v = 0; v < n; ++v)
      if (numbers.own_vertex(v)) {
        const Index row = numbers.vertex_rows[v] - numbers.first_row;
        components_[static_cast<std::size_t>(row)] = numbers.vertex_components[v];
        is_free[row] = 1;
      }
    for (const Index v : dirichlet_vertices) {
      if (v < 0 || v >= n)
        throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) +
                            " does not exist; the part has " + std::to_string(n));
      if (numbers.own_vertex(v)) is_free[numbers.vertex_rows[v] - numbers.first_row] = 0;
    }
    row_sums = d.lumped_mass();
    sparser = sparser_part_stiffness(part, d);
  });
  stiffness_ = exchange.sum(d.stiffness);
  mass_ = exchange.sum(d.mass);
  const PetscVector diagonal = exchange.vector();
  PetscReal largest = 0;
  check(MatGetDiagonal(stiffness_, diagonal));
  check(VecMax(diagonal, nullptr, &largest));
  std::vector<PetscInt> held;
  {
    const OwnRows own(diagonal);
    for (Index row = 0; row < is_free.size(); ++row) {
      if (!(own.values()[row] > 0)) {
        is_free[row] = 0;
        components_[static_cast<std::size_t>(row)] = -1;
      }
      if (is_free[row] == 0) held.push_back(numbers.first_row + row);
    }
  }
  free = is_free;
  n_free = static_cast<Index>(sum_of_all(static_cast<std::int64_t>(is_free.sum())));
  double lightest = std::numeric_limits<double>::max();
  check(MatGetDiagonal(mass_, diagonal));
  {
    const OwnRows own(diagonal);
    for (Index row = 0; row < is_free.size(); ++row)
      if (is_free[row] > 0) lightest = std::min(lightest, own.values()[row]);
  }
  lightest = -largest_of_all(-lightest);
  if (n_free > 0 && !(lightest > 0))
    throw Shared<SolverFailure>("the mass is not positive definite: a diagonal entry is " +
                                std::to_string(lightest));
  const double total = sum_of_all(row_sums.sum());
  shift_ = first_eigenvalue(total, dimension_);
  const PetscInt n_held = static_cast<PetscInt>(held.size());
  // Rows that take no part: a value above all others.
  check(MatZeroRowsColumns(stiffness_, n_held, held.data(), largest, nullptr, nullptr));
  check(MatZeroRowsColumns(mass_, n_held, held.data(), 1e-3 * lightest, nullptr, nullptr));
  if (largest_of_all(static_cast<double>(sparser.rows())) > 0) {
    for (Index v = 0; v < sparser.rows(); ++v)
      if (row_sums[v] != 0) sparser.coeffRef(v, v) += shift_ * row_sums[v];
    like_ = exchange.sum(sparser);
    check(MatZeroRowsColumns(like_, n_held, held.data(), largest, nullptr, nullptr));
  }
}

void Problem::normalise(Vec x) const {
  {
    const OwnRows own(x);
    own.values() = own.values().cwiseProduct(free);
  }
  PetscVector product;
  double square = 0;
  check(VecDuplicate(x, product.out()));
  check(MatMult(mass_, x, product));
  check(VecDot(x, product, &square));
  check(VecScale(x, 1 / std::sqrt(square)));
}

std::vector<PetscVector> Problem::constants() const {
  std::vector<double> touched(n_components_, 0), present(n_components_, 0);
  for (std::size_t row = 0; row < components_.size(); ++row)
    if (components_[row] >= 0)
      (free[static_cast<Index>(row)] > 0 ? present
                                         : touched)[static_cast<std::size_t>(components_[row])] = 1;
  touched = sum_of_all(std::move(touched));
  present = sum_of_all(std::move(present));
  std::vector<PetscVector> vectors;
  for (std::size_t c = 0; c < n_components_; ++c) {
    if (touched[c] > 0 || present[c] == 0) continue;
    vectors.push_back(exchange.vector());
    {
      const OwnRows own(vectors.back());
      for (std::size_t row = 0; row < components_.size(); ++row)
        if (components_[row] == static_cast<Index>(c)) own.values()[static_cast<Index>(row)] = 1;
    }
    normalise(vectors.back());
  }
  return vectors;
}

std::vector<Pair> Problem::smallest(Index count, const std::vector<Vec>& complement,
                                    Work& work) const {
  SlepcSolver solver;
  ST transform = nullptr;
  KSP inner = nullptr;
  check(EPSCreate(PETSC_COMM_WORLD, solver.out()));
  check(EPSSetOperators(solver, stiffness_, mass_));
  check(EPSSetProblemType(solver, EPS_GHEP));
  check(EPSSetType(solver, EPSKRYLOVSCHUR));
  check(EPSSetDimensions(solver, count, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSetTarget(solver, -shift_));
  check(EPSSetWhichEigenpairs(solver, EPS_TARGET_MAGNITUDE));
  check(EPSSetTolerances(solver, kTolerance, 1000));
  check(EPSGetST(solver, &transform));
  check(STSetType(transform, STSINVERT));
  check(STSetMatStructure(transform, SUBSET_NONZERO_PATTERN));
  if (like_) check(STSetPreconditionerMat(transform, like_));
  check(STGetKSP(transform, &inner));
  set_spd_defaults(inner, dimension_);
  if (!complement.empty())
    check(EPSSetDeflationSpace(solver, static_cast<PetscInt>(complement.size()),
                               const_cast<Vec*>(complement.data())));  // as in C
  // The same first vector whatever the number of processes.
  const PetscVector start = exchange.vector();
  {
    const OwnRows own(start);
    PetscInt first = 0;
    check(VecGetOwnershipRange(start, &first, nullptr));
    for (Index row = 0; row < own.values().size(); ++row)
      own.values()[row] = free[row] * (1 + std::sin(1.0 + static_cast<double>(first + row)));
  }
  Vec starts[1] = {start};
  check(EPSSetInitialSpace(solver, 1, starts));
  if (work.progress) check(EPSMonitorSet(solver, show_progress, &work, nullptr));
  check(EPSSetFromOptions(solver));
  check(EPSSolve(solver));
  EPSType type = nullptr;
  PetscInt iterations = 0;
  check(EPSGetType(solver, &type));
  check(KSPGetTotalIterations(inner, &iterations));
  work.method = std::string("SLEPc ") + type;
  work.iterations += static_cast<Index>(iterations);
  PetscInt converged = 0;
  check(EPSGetConverged(solver, &converged));
  if (converged < count)
    throw Shared<SolverFailure>("SLEPc found " + std::to_string(converged) + " of " +
                                std::to_string(count) +
                                " eigenpairs; change its options, e.g. -eps_max_it, -eps_ncv");
  std::vector<Pair> pairs;
  for (PetscInt k = 0; k < count; ++k) {
    Pair pair{0, exchange.vector()};
    check(EPSGetEigenpair(solver, k, &pair.value, nullptr, pair.vector, nullptr));
    normalise(pair.vector);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

double Problem::residual(const Pair& pair) const {
  PetscVector left, right;
  double size = 0, difference = 0;
  check(VecDuplicate(pair.vector, left.out()));
  check(VecDuplicate(pair.vector, right.out()));
  check(MatMult(stiffness_, pair.vector, left));
  check(MatMult(mass_, pair.vector, right));
  check(VecNorm(right, NORM_2, &size));
  check(VecAXPY(left, -pair.value, right));
  check(VecNorm(left, NORM_2, &difference));
  return pair.value > 0 ? difference / (pair.value * size) : 0;
}

/// Turns a vector so that the first entry of at least 0.6 of the largest is positive.
void turn(Vec vector, const PartNumbers& numbers, Vector& of_part) {
  double largest = 0;
  check(VecNorm(vector, NORM_INFINITY, &largest));
  double first = 2.0 * numbers.n_vertices, sign = 0;
  for (Index v = 0; v < of_part.size(); ++v)
    if (std::abs(of_part[v]) >= 0.6 * largest) {
      first = numbers.vertices[v];
      sign = of_part[v] < 0 ? -1 : 1;
      break;
    }
  const double lowest = -largest_of_all(-first);
  if (largest_of_all(lowest == first && sign < 0 ? 1.0 : 0.0) > 0) of_part = -of_part;
}

/// The pairs of a checkpoint, which have to be some of this problem's.
std::vector<Pair> saved_pairs(const std::filesystem::path& path, const Problem& problem,
                              const PartNumbers& numbers) {
  if (path.empty()) return {};
  std::vector<Pair> pairs = load_pairs(path, numbers, problem.exchange);
  for (const Pair& pair : pairs) {
    problem.normalise(pair.vector);
    const double residual = problem.residual(pair);
    if (!(pair.value > 0) || !(residual <= kSameProblem))
      throw Shared<InvalidOption>(path.string() + ": its eigenvalue " + scientific(pair.value) +
                                  " leaves a residual of " + scientific(residual) +
                                  ": the checkpoint of another mesh, operator or boundary; name "
                                  "another file or remove it");
  }
  return pairs;
}

template <class Mesh>
EigenPairs solve(const MeshPart<Mesh>& part, const Discretization& discretization, Index count,
                 const std::vector<Index>& dirichlet_vertices,
                 const std::filesystem::path& checkpoint,
                 const std::function<void(Index)>& progress) {
  const Problem problem(part, discretization, dirichlet_vertices);
  if (count < 1 || count > problem.n_free)
    throw Shared<InvalidOption>(std::to_string(count) + " eigenpairs of " +
                                std::to_string(problem.n_free) +
                                " free vertices; ask for at least 1 and at most as many");
  std::vector<PetscVector> constants = problem.constants();
  std::vector<Pair> pairs;
  std::vector<Vec> complement(constants.begin(), constants.end());
  EigenPairs result;
  Work work;
  // A solver may find more than it was asked for.
  if (progress) work.progress = [&](Index found) { progress(std::min(found, count)); };
  result.zero_modes = static_cast<Index>(constants.size());
  const Index wanted = count - std::min(count, result.zero_modes);
  if (wanted > 0) {
    pairs = saved_pairs(checkpoint, problem, part.numbers);
    for (const Pair& pair : pairs) complement.push_back(pair.vector);
    while (static_cast<Index>(pairs.size()) < wanted) {
      work.found = result.zero_modes + static_cast<Index>(pairs.size());
      const Index missing = wanted - static_cast<Index>(pairs.size());
      for (Pair& pair : problem.smallest(checkpoint.empty() ? missing : std::min(kBatch, missing),
                                         complement, work)) {
        complement.push_back(pair.vector);
        pairs.push_back(std::move(pair));
      }
      if (!checkpoint.empty()) save_pairs(checkpoint, part.numbers, pairs);
    }
    const auto ascending = [](const Pair& a, const Pair& b) { return a.value < b.value; };
    std::sort(pairs.begin(), pairs.end(), ascending);
    // The Krylov space of one vector may miss members of a cluster.
    work.progress = {};
    while (static_cast<Index>(complement.size()) < problem.n_free) {
      std::vector<Pair> next = problem.smallest(1, complement, work);
      if (!(next[0].value < pairs[static_cast<std::size_t>(wanted) - 1].value * (1 - kCluster)))
        break;
      complement.push_back(next[0].vector);
      pairs.push_back(std::move(next[0]));
      std::sort(pairs.begin(), pairs.end(), ascending);
    }
  }
  for (Index k = std::min(count, result.zero_modes); k-- > 0;)
    pairs.insert(pairs.begin(), Pair{0, std::move(constants[static_cast<std::size_t>(k)])});
  result.method = EigenMethod::Iterative;
  result.factor.method = work.method;
  result.iterations = work.iterations;
  result.values.resize(count);
  result.residuals.resize(count);
  result.vectors.resize(problem.exchange.n_here(), count);
  for (Index k = 0; k < count; ++k) {
    const Pair& pair = pairs[static_cast<std::size_t>(k)];
    result.values[k] = pair.value;
    result.residuals[k] = problem.residual(pair);
    Vector of_part = problem.exchange.to_part(pair.vector);
    turn(pair.vector, part.numbers, of_part);
    result.vectors.col(k) = of_part;
  }
  return result;
}

}  // namespace

EigenPairs distributed_eigenmodes(const MeshPart<PolygonMesh>& part,
                                  const Discretization& discretization, Index count,
                                  const std::vector<Index>& dirichlet_vertices,
                                  const std::filesystem::path& checkpoint,
                                  const std::function<void(Index)>& progress) {
  return solve(part, discretization, count, dirichlet_vertices, checkpoint, progress);
}

EigenPairs distributed_eigenmodes(const MeshPart<PolyhedralMesh>& part,
                                  const Discretization& discretization, Index count,
                                  const std::vector<Index>& dirichlet_vertices,
                                  const std::filesystem::path& checkpoint,
                                  const std::function<void(Index)>& progress) {
  return solve(part, discretization, count, dirichlet_vertices, checkpoint, progress);
}

}  // namespace carat
