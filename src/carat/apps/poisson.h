#pragma once
// Poisson's equation with mixed boundary conditions.

#include <string>
#include <vector>

#include "carat/operators/discretization.h"
#include "carat/solve/spd_solver.h"

namespace carat {

/// Conditions on parts of the boundary; where there is none, the natural one K du/dn = 0 holds.
/// Edges are numbered as in PolygonMesh::edges() and must lie on the boundary.
struct BoundaryConditions {
  /// u = value at these vertices (anywhere, not only on the boundary).
  std::vector<Index> dirichlet_vertices{};
  std::vector<double> dirichlet_values{};
  /// K du/dn = flux over these edges, n the outward conormal: positive flux flows in.
  std::vector<Index> neumann_edges{};
  std::vector<double> neumann_flux{};
  /// K du/dn + alpha u = g over these edges, alpha >= 0.
  std::vector<Index> robin_edges{};
  std::vector<double> robin_alpha{}, robin_g{};
};

struct PoissonSolution {
  Vector values;  ///< one a vertex; vertices without a face keep their Dirichlet value or 0
  /// |S u - b| / (|S| |u| + |b|), maximum norms over the free vertices.
  double relative_residual = 0;
  /// Components without Dirichlet or Robin data: their solution has mean zero (by mass).
  Index floating_components = 0;
  /// |integral of the data| / integral of |data| over the worst floating component. It should
  /// vanish; what is left was subtracted as a constant right-hand side.
  double imbalance = 0;
};

/// Solves -div(K grad u) = f for any number of right-hand sides. K is part of the discretization.
class Poisson {
 public:
  /// \throws InvalidOption  vertex or edge out of range, an edge that is not on the boundary, a
  ///                        value that is not finite, alpha < 0, lists of different length,
  ///                        a vertex with two different Dirichlet values
  /// \throws SolverFailure  the system is not positive definite
  Poisson(const PolygonMesh& mesh, const Discretization& discretization,
          const BoundaryConditions& conditions = {});

  /// \param f  values at the vertices; the load is mass * f
  /// \throws SolverFailure  a floating component's data do not balance: imbalance > 0.1
  PoissonSolution solve(const Vector& f) const;
  /// \param load  integrated right-hand side, e.g. mass * f
  PoissonSolution solve_integrated(const Vector& load) const;

  const FactorInfo& info() const { return solver_->info(); }

 private:
  SparseMatrix system_;  // stiffness plus Robin's diagonal
  SparseMatrix mass_;
  Vector boundary_load_;     // Neumann and Robin
  std::vector<bool> fixed_;  // rows not solved for
  Vector fixed_values_;
  std::vector<Index> component_;
  std::vector<bool> floating_;  // component -> has no Dirichlet and no Robin data
  std::unique_ptr<SpdSolver> solver_;
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

}  // namespace carat
