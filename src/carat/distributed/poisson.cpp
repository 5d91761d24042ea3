#include "carat/distributed/poisson.h"

#include <cmath>
#include <string>
#include <type_traits>

#include "carat/distributed/part_product.h"
#include "carat/distributed/processes.h"
#include "carat/distributed/spd_iteration.h"
#include "carat/operators/common.h"
#include "carat/solve/matrix_operator.h"

namespace carat {
namespace {

// A right-hand side that misses balance by more than this is a mistake, not discretisation error.
constexpr double kImbalanceLimit = 0.1;

template <class Mesh>
constexpr int kDimension = std::is_same_v<Mesh, PolygonMesh> ? 2 : 3;

std::shared_ptr<const SymmetricOperator> as_operator(
    const std::shared_ptr<const SymmetricOperator>& product,
    std::shared_ptr<const SparseMatrix> matrix) {
  if (product) return product;
  return std::make_shared<MatrixOperator>(std::move(matrix), 1);
}

/// The conditions that are this part's to give.
BoundaryConditions own_conditions(const BoundaryConditions& all, const PartNumbers& numbers) {
  const Index n_vertices = static_cast<Index>(numbers.vertices.size()),
              n_sides = static_cast<Index>(numbers.interfaces.size());
  const auto check_lengths = [](const char* what, std::size_t a, std::size_t b) {
    if (a != b)
      throw InvalidOption(std::string(what) + " data: lists of " + std::to_string(a) + " and " +
                          std::to_string(b) + " entries; they must be equally long");
  };
  check_lengths("Dirichlet", all.dirichlet_vertices.size(), all.dirichlet_values.size());
  check_lengths("Neumann", all.neumann_sides.size(), all.neumann_flux.size());
  check_lengths("Robin", all.robin_sides.size(), all.robin_alpha.size());
  check_lengths("Robin", all.robin_sides.size(), all.robin_g.size());
  BoundaryConditions own;
  for (std::size_t k = 0; k < all.dirichlet_vertices.size(); ++k) {
    const Index v = all.dirichlet_vertices[k];
    if (v < 0 || v >= n_vertices)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) +
                          " does not exist; the part has " + std::to_string(n_vertices));
    const double value = all.dirichlet_values[k];
    if (!std::isfinite(value))
      throw InvalidOption("Dirichlet value at vertex " + std::to_string(numbers.vertices[v]) +
                          " is " + std::to_string(value) + "; it must be a finite number");
    if (!numbers.own_vertex(v)) continue;
    own.dirichlet_vertices.push_back(v);
    own.dirichlet_values.push_back(value);
  }
  const auto is_own_side = [&](Index side) {
    return side < 0 || side >= n_sides || numbers.own_interfaces[side];
  };
  for (std::size_t k = 0; k < all.neumann_sides.size(); ++k) {
    if (!is_own_side(all.neumann_sides[k])) continue;
    own.neumann_sides.push_back(all.neumann_sides[k]);
    own.neumann_flux.push_back(all.neumann_flux[k]);
  }
  for (std::size_t k = 0; k < all.robin_sides.size(); ++k) {
    if (!is_own_side(all.robin_sides[k])) continue;
    own.robin_sides.push_back(all.robin_sides[k]);
    own.robin_alpha.push_back(all.robin_alpha[k]);
    own.robin_g.push_back(all.robin_g[k]);
  }
  return own;
}

}  // namespace

struct DistributedPoisson::Impl {
  explicit Impl(const PartNumbers& numbers)
      : exchange(numbers),
        first_row(numbers.first_row),
        n_vertices(numbers.n_vertices),
        n_components(static_cast<std::size_t>(numbers.n_components)) {}

  PartExchange exchange;
  Index first_row, n_vertices;
  std::size_t n_components;
  std::shared_ptr<const SymmetricOperator> mass;  // the part's
  PartShare share;
  std::vector<Index> part_components;
  // Of the own rows:
  std::vector<Index> components;
  std::vector<bool> fixed;  // by data, or without an element
  Vector fixed_values, boundary_load, vertex_mass;
  PetscVector lift;             // what fixed values bring to the right-hand side of the others
  std::vector<bool> held;       // fixed, and one of each floating component
  std::vector<double> measure;  // of each component
  std::vector<bool> floating;
  double norm = 0;
  std::unique_ptr<SpdIteration> solver;

  /// Sums of own rows by component over all processes.
  template <class Value>
  std::vector<double> by_component(const Value& value) const {
    std::vector<double> sums(n_components, 0);
    for (std::size_t row = 0; row < components.size(); ++row)
      if (components[row] >= 0)
        sums[static_cast<std::size_t>(components[row])] += value(static_cast<Index>(row));
    return sum_of_all(std::move(sums));
  }
  /// Place of a vertex of the part among the own rows; -1: another process's.
  Index own_row(Index v) const {
    const Index row = exchange.rows()[static_cast<std::size_t>(v)] - first_row;
    return row >= 0 && row < exchange.n_own() ? row : -1;
  }
  bool floats(std::size_t row) const {
    return components[row] >= 0 && floating[static_cast<std::size_t>(components[row])];
  }
};

template <class Mesh>
void DistributedPoisson::set_up(const MeshPart<Mesh>& part, const Discretization& d,
                                const BoundaryConditions& conditions) {
  const PartNumbers& numbers = part.numbers;
  BoundaryConditions own;
  BoundaryIntegrals boundary;
  SparseMatrix sparser;
  std::shared_ptr<const SymmetricOperator> operator_of_part, mass;
  together([&] {
    require_vertex_unknowns(d, "Poisson");
    if (d.n_vertices() != part.mesh.n_vertices())
      throw InvalidOption("the discretization has " + std::to_string(d.n_vertices()) +
                          " vertices, the part " + std::to_string(part.mesh.n_vertices()));
    own = own_conditions(conditions, numbers);
    boundary = integrate_boundary(part.mesh, own);
    sparser = sparser_part_stiffness(part, d);
    if (sparser.rows() > 0) sparser = sparser + boundary.robin;
    operator_of_part = as_operator(d.stiffness_product, std::shared_ptr<const SparseMatrix>(
                                                            std::shared_ptr<void>(), &d.stiffness));
    mass = as_operator(d.mass_product, std::make_shared<SparseMatrix>(d.mass));
    if (boundary.robin.nonZeros() > 0) operator_of_part = operator_of_part->plus(boundary.robin);
  });
  impl_ = std::make_unique<Impl>(numbers);
  Impl& it = *impl_;
  it.mass = std::move(mass);
  const Index first = numbers.first_row, n_own = it.exchange.n_own();
  const bool assembled = operator_of_part->assembled();
  if (assembled) it.share += share_of(*operator_of_part->matrix(), numbers);
  it.share += share_of(sparser, numbers);
  PetscMatrix system = assembled ? it.exchange.sum(*operator_of_part->matrix())
                                 : product_of_all(it.exchange, operator_of_part);
  PetscMatrix like;
  if (largest_of_all(static_cast<double>(sparser.rows())) > 0) like = it.exchange.sum(sparser);
  PetscVector diagonal = it.exchange.vector();
  if (assembled) {
    check(MatNorm(system, NORM_INFINITY, &it.norm));
    check(MatGetDiagonal(system, diagonal));
  } else {
    check(VecNorm(it.exchange.sum(operator_of_part->row_norms()), NORM_INFINITY, &it.norm));
    it.exchange.sum(operator_of_part->diagonal(), diagonal);
  }
  const Vector at_part = it.exchange.to_part(diagonal);
  it.components.assign(static_cast<std::size_t>(n_own), -1);
  for (Index v = 0; v < part.mesh.n_vertices(); ++v) {
    const Index component = at_part[v] > 0 ? numbers.vertex_components[v] : -1;
    it.part_components.push_back(component);
    if (numbers.own_vertex(v)) it.components[numbers.vertex_rows[v] - first] = component;
  }
  it.fixed.assign(it.components.size(), false);
  it.fixed_values = Vector::Zero(n_own);
  for (std::size_t row = 0; row < it.fixed.size(); ++row) it.fixed[row] = it.components[row] < 0;
  std::vector<double> grounded(it.n_components, 0);
  together([&] {
    std::vector<bool> given(it.fixed.size(), false);
    for (std::size_t k = 0; k < own.dirichlet_vertices.size(); ++k) {
      const Index v = own.dirichlet_vertices[k];
      const std::size_t row = static_cast<std::size_t>(numbers.vertex_rows[v] - first);
      double& value = it.fixed_values[static_cast<Index>(row)];
      if (given[row] && value != own.dirichlet_values[k])
        throw InvalidOption("Dirichlet data: vertex " + std::to_string(numbers.vertices[v]) +
                            " has two values: " + std::to_string(value) + " and " +
                            std::to_string(own.dirichlet_values[k]));
      given[row] = it.fixed[row] = true;
      value = own.dirichlet_values[k];
      if (it.components[row] >= 0) grounded[static_cast<std::size_t>(it.components[row])] = 1;
    }
    for (Index v = 0; v < part.mesh.n_vertices(); ++v)
      if (it.part_components[v] >= 0 && SparseMatrix::InnerIterator(boundary.robin, v))
        grounded[static_cast<std::size_t>(it.part_components[v])] = 1;
  });
  grounded = sum_of_all(std::move(grounded));
  for (const double data : grounded) it.floating.push_back(data == 0);

  it.boundary_load = OwnRows(it.exchange.sum(boundary.load)).values();
  it.vertex_mass = OwnRows(it.exchange.sum(d.apply_mass(Vector::Ones(d.n_vertices())))).values();
  it.measure = it.by_component([&](Index row) { return it.vertex_mass[row]; });

  // A floating component is held at zero at one vertex, and shifted afterwards.
  it.held = it.fixed;
  std::vector<Index> lowest(it.n_components, std::numeric_limits<Index>::max());
  for (Index row = n_own; row-- > 0;)
    if (it.floats(static_cast<std::size_t>(row)))
      lowest[static_cast<std::size_t>(it.components[row])] = first + row;
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_INT32_T, MPI_MIN,
                PETSC_COMM_WORLD);
  for (const Index row : lowest)
    if (row >= first && row < numbers.end_row)
      it.held[static_cast<std::size_t>(row - first)] = true;

  std::vector<PetscInt> held_rows;
  for (Index row = 0; row < n_own; ++row)
    if (it.held[static_cast<std::size_t>(row)]) held_rows.push_back(first + row);
  const PetscVector values = it.exchange.vector();
  OwnRows(values).values() = it.fixed_values;
  it.lift = it.exchange.vector();
  PetscReal scale = 0;
  check(VecMax(diagonal, nullptr, &scale));
  const PetscInt n_held = static_cast<PetscInt>(held_rows.size());
  const auto hold = [held_rows, n_held, scale](Mat matrix, Vec x, Vec b) {
    check(MatZeroRowsColumns(matrix, n_held, held_rows.data(), scale, x, b));
  };
  if (assembled) {
    hold(system, values, it.lift);
  } else {
    check(MatMult(system, values, it.lift));
    check(VecScale(it.lift, -1));
    hold_rows(system, it.held, scale);
  }
  if (like) hold(like, nullptr, nullptr);
  {
    const OwnRows lift(it.lift);
    for (Index row = 0; row < n_own; ++row)
      if (it.held[static_cast<std::size_t>(row)]) lift.values()[row] = 0;
  }
  std::function<PetscMatrix()> assemble;
  if (!assembled)
    assemble = [&it, hold, stiffness = operator_of_part] {
      std::shared_ptr<const SparseMatrix> of_part;
      together([&] { of_part = stiffness->matrix(); });
      PetscMatrix matrix = it.exchange.sum(*of_part);
      hold(matrix, nullptr, nullptr);
      return matrix;
    };
  it.solver = std::make_unique<SpdIteration>(std::move(system), std::move(like), kDimension<Mesh>,
                                             std::move(assemble));
}

namespace {

/// That of all processes whose parts are like most.
template <class Mesh>
OperatorForm form_of_all(const MeshPart<Mesh>& part, const std::string& name) {
  OperatorForm own{};
  // As on a mesh that is large enough for an iteration.
  together([&] { own = poisson_form(part.mesh, name, {.kind = SolverKind::Multigrid}); });
  const auto vote =
      own == OperatorForm::Products ? part.mesh.n_vertices() : -part.mesh.n_vertices();
  return sum_of_all(std::int64_t{vote}) > 0 ? OperatorForm::Products : OperatorForm::Matrices;
}

}  // namespace

OperatorForm distributed_poisson_form(const MeshPart<PolygonMesh>& part, const std::string& name) {
  return form_of_all(part, name);
}

OperatorForm distributed_poisson_form(const MeshPart<PolyhedralMesh>& part,
                                      const std::string& name) {
  return form_of_all(part, name);
}

DistributedPoisson::DistributedPoisson(const MeshPart<PolygonMesh>& part,
                                       const Discretization& discretization,
                                       const BoundaryConditions& conditions) {
  set_up(part, discretization, conditions);
}

DistributedPoisson::DistributedPoisson(const MeshPart<PolyhedralMesh>& part,
                                       const Discretization& discretization,
                                       const BoundaryConditions& conditions) {
  set_up(part, discretization, conditions);
}

DistributedPoisson::~DistributedPoisson() = default;
DistributedPoisson::DistributedPoisson(DistributedPoisson&&) noexcept = default;

const PartShare& DistributedPoisson::share() const { return impl_->share; }

const std::vector<Index>& DistributedPoisson::components() const { return impl_->part_components; }

void DistributedPoisson::remove_floating_means(Vector& function) const {
  const Impl& it = *impl_;
  Vector own(it.exchange.n_own());
  for (Index v = 0; v < function.size(); ++v)
    if (const Index row = it.own_row(v); row >= 0) own[row] = function[v];
  const std::vector<double> mean =
      it.by_component([&](Index row) { return it.vertex_mass[row] * own[row]; });
  for (Index v = 0; v < function.size(); ++v)
    if (const Index c = it.part_components[static_cast<std::size_t>(v)];
        c >= 0 && it.floating[static_cast<std::size_t>(c)])
      function[v] -= mean[static_cast<std::size_t>(c)] / it.measure[static_cast<std::size_t>(c)];
}

ErrorNorms DistributedPoisson::norms(const Vector& error) const {
  const Impl& it = *impl_;
  double squares = 0, largest = 0;
  for (Index v = 0; v < error.size(); ++v) {
    if (it.own_row(v) < 0) continue;
    squares += error[v] * error[v];
    largest = std::max(largest, std::abs(error[v]));
  }
  const double energy = error.size() > 0 ? error.dot(*it.mass * error) : 0.0;
  const std::vector<double> sums = sum_of_all(std::vector<double>{squares, energy});
  ErrorNorms norms;
  if (it.n_vertices > 0) norms.rmse = std::sqrt(sums[0] / it.n_vertices);
  norms.l2 = std::sqrt(std::max(0.0, sums[1]));
  norms.max = largest_of_all(largest);
  return norms;
}

PoissonSolution DistributedPoisson::solve(const Vector& f) const {
  Vector load;
  together([&] {
    if (f.size() != impl_->exchange.n_here())
      throw InvalidOption(std::to_string(f.size()) + " values for " +
                          std::to_string(impl_->exchange.n_here()) + " vertices");
    load = *impl_->mass * f;
  });
  return solve_integrated(load);
}

PoissonSolution DistributedPoisson::solve_integrated(const Vector& load) const {
  const Impl& it = *impl_;
  together([&] {
    if (load.size() != it.exchange.n_here())
      throw InvalidOption(std::to_string(load.size()) + " values for " +
                          std::to_string(it.exchange.n_here()) + " vertices");
    if (!load.allFinite())
      throw InvalidOption("the right-hand side holds a value that is not finite");
  });
  PoissonSolution solution;
  const PetscVector right = it.exchange.sum(load);
  Vector b = Vector(OwnRows(right).values()) + it.boundary_load;
  const std::vector<double> sum = it.by_component([&](Index row) { return b[row]; }),
                            total = it.by_component([&](Index row) { return std::abs(b[row]); });
  for (std::size_t c = 0; c < it.n_components; ++c) {
    if (!it.floating[c]) continue;
    ++solution.floating_components;
    const double imbalance = total[c] > 0 ? std::abs(sum[c]) / total[c] : 0;
    solution.imbalance = std::max(solution.imbalance, imbalance);
    if (imbalance > kImbalanceLimit)
      throw Shared<SolverFailure>(
          "component " + std::to_string(c) +
          " has no Dirichlet or Robin data, and its right-hand side and fluxes integrate to " +
          std::to_string(sum[c]) + " (" + std::to_string(imbalance) +
          " of their absolute integral, at most " + std::to_string(kImbalanceLimit) +
          "): no solution exists; balance them or give Dirichlet data");
  }
  for (std::size_t row = 0; row < it.held.size(); ++row) {
    const Index i = static_cast<Index>(row);
    if (it.floats(row)) {
      const std::size_t c = static_cast<std::size_t>(it.components[row]);
      b[i] -= sum[c] / it.measure[c] * it.vertex_mass[i];
    }
    if (it.held[row]) b[i] = 0;
  }
  OwnRows(right).values() = b;
  check(VecAXPY(right, 1, it.lift));
  const PetscVector x = it.solver->solve(right, solution.solve);

  // Floating components: mean zero by mass.
  {
    const OwnRows own(x);
    own.values() += it.fixed_values;
    const std::vector<double> mean =
        it.by_component([&](Index row) { return it.vertex_mass[row] * own.values()[row]; });
    for (std::size_t row = 0; row < it.held.size(); ++row)
      if (it.floats(row)) {
        const std::size_t c = static_cast<std::size_t>(it.components[row]);
        own.values()[static_cast<Index>(row)] -= mean[c] / it.measure[c];
      }
  }
  double largest = 0, size = 0;
  check(VecNorm(x, NORM_INFINITY, &largest));
  check(VecNorm(right, NORM_2, &size));
  const double bound = it.norm * largest + size;
  solution.relative_residual = bound > 0 ? solution.solve.residual * size / bound : 0;
  solution.values = it.exchange.to_part(x);
  return solution;
}

}  // namespace carat
