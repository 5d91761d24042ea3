#pragma once
// Poisson's equation with mixed boundary conditions, on surfaces and in volumes.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "carat/apps/boundary_conditions.h"
#include "carat/operators/discretization.h"
#include "carat/solve/spd_solver.h"

namespace carat {

struct PoissonSolution {
  /// One an unknown, the vertices first; vertices of no element keep their Dirichlet value or 0.
  Vector values;
  /// |S u - b| / (|S| |u| + |b|), maximum norms over the free vertices.
  double relative_residual = 0;
  /// Components without Dirichlet or Robin data: their solution has mean zero (by mass).
  Index floating_components = 0;
  /// |integral of the data| / integral of |data| over the worst floating component. It should
  /// vanish; what is left was subtracted as a constant right-hand side.
  double imbalance = 0;
  /// What solved it, in how many iterations, and |S u - b| / |b| of the system that was solved.
  SolveReport solve{};
};

/// In which form Poisson solves fastest with an operator: products where they are faster than the
/// matrices (polygons and polyhedra of many vertices) and the solver needs no matrix.
OperatorForm poisson_form(const PolygonMesh& mesh, const std::string& operator_name,
                          const SolverOptions& solver = {});
OperatorForm poisson_form(const PolyhedralMesh& mesh, const std::string& operator_name,
                          const SolverOptions& solver = {});

/// Solves -div(K grad u) = f for any number of right-hand sides.
///
/// K is part of the discretization: DiscretizationOptions::coefficient, and in volumes also
/// cell_coefficient for scalars or symmetric tensors a cell.
///
/// Small systems are factorised, large ones solved by conjugate gradients preconditioned through
/// sparser_stiffness(): see SolverOptions. These need no matrix of the operator itself; see
/// poisson_form() and DiscretizationOptions::form. With unknowns beyond the vertices: always
/// factorised. Matrices that are copied or moved can be kept by one triangle
/// (SolverOptions::storage); where there is none, that changes nothing.
class Poisson {
 public:
  /// \throws InvalidOption  vertex or side out of range, a side that is not on the boundary, a
  ///                        value that is not finite, alpha < 0, lists of different length,
  ///                        a vertex with two different Dirichlet values
  /// \param solver  kind, right_hand_sides, threads and storage are read; the rest follows from
  ///                the mesh
  /// \throws SolverFailure  the system is not positive definite, or singular beyond constants
  Poisson(const PolygonMesh& mesh, const Discretization& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});
  Poisson(const PolyhedralMesh& mesh, const Discretization& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});
  /// The same from matrices that are moved, not copied; empty ones of the same size stay behind.
  Poisson(const PolygonMesh& mesh, Discretization&& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});
  Poisson(const PolyhedralMesh& mesh, Discretization&& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});

  /// The same with the matrices shared, neither copied nor moved.
  Poisson(const PolygonMesh& mesh, const std::shared_ptr<const Discretization>& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});
  Poisson(const PolyhedralMesh& mesh, const std::shared_ptr<const Discretization>& discretization,
          const BoundaryConditions& conditions = {}, const SolverOptions& solver = {});

  /// The same system with other data: Dirichlet values, fluxes, right-hand sides of Robin's
  /// conditions. What solves it is shared, nothing is factorised anew.
  /// \throws InvalidOption  as the constructor; other Dirichlet vertices, Robin sides or alpha,
  ///                        which make another system
  Poisson with_data(const PolygonMesh& mesh, const BoundaryConditions& conditions) const;
  Poisson with_data(const PolyhedralMesh& mesh, const BoundaryConditions& conditions) const;

  /// \param f  one value an unknown, the vertices first; the load is mass * f
  /// \throws SolverFailure  a floating component's data do not balance: imbalance > 0.1
  PoissonSolution solve(const Vector& f) const;
  /// \param load  integrated right-hand side, e.g. mass * f
  PoissonSolution solve_integrated(const Vector& load) const;

  /// What was chosen to solve with, and why.
  const SolverInfo& solver() const { return solver_->info(); }

 private:
  struct Operators {
    std::shared_ptr<const SymmetricOperator> stiffness, mass;
  };
  static Operators operators(const Discretization& discretization, const SolverOptions& solver);
  static Operators operators(Discretization&& discretization, const SolverOptions& solver);
  static Operators operators(const std::shared_ptr<const Discretization>& discretization,
                             int threads);
  Poisson(BoundaryIntegrals boundary, const Discretization& discretization, Operators operators,
          const BoundaryConditions& conditions, SolverOptions solver);
  bool any_floating() const {
    return std::find(floating_.begin(), floating_.end(), true) != floating_.end();
  }
  void fix_dirichlet_vertices(Index n_vertices, const BoundaryConditions& conditions);
  void fix_boundary_unknowns(const BoundaryConditions& conditions);
  Poisson with_data(BoundaryIntegrals boundary, const BoundaryConditions& conditions) const;

  std::shared_ptr<const SymmetricOperator> system_;  // stiffness plus Robin's matrix
  double system_norm_ = 0;                           // maximum norm over the rows solved for
  std::shared_ptr<const SymmetricOperator> mass_;
  ExtraUnknowns extra_;
  std::vector<Index> robin_sides_;  // the system depends on these
  std::vector<double> robin_alpha_;
  Vector boundary_load_;     // Neumann and Robin
  std::vector<bool> fixed_;  // rows not solved for
  Vector fixed_values_;
  std::vector<Index> component_;
  std::vector<bool> floating_;  // component -> has no Dirichlet and no Robin data
  std::vector<bool> held_;      // fixed_, and one vertex of each floating component
  std::shared_ptr<const SpdSolver> solver_;
};

/// Deviation of u from a reference.
struct ErrorNorms {
  double rmse = 0;  ///< sqrt(sum e^2 / n)
  double l2 = 0;    ///< sqrt(e^T M e)
  double max = 0;   ///< max |e|
};

/// \param remove_mean  compare up to a constant: both sides lose their mean by mass
ErrorNorms error_norms(const SparseMatrix& mass, const Vector& u, const Vector& reference,
                       bool remove_mean = false);
ErrorNorms error_norms(const SymmetricOperator& mass, const Vector& u, const Vector& reference,
                       bool remove_mean = false);

}  // namespace carat
