#pragma once
// Poisson's equation over all processes.

#include <memory>
#include <string>

#include "carat/apps/poisson.h"
#include "carat/mesh/mesh_part.h"
#include "carat/operators/part_discretization.h"

namespace carat {

/// Collective. The form of operators with which DistributedPoisson takes less time and memory, as
/// poisson_form(): products where elements have many vertices.
OperatorForm distributed_poisson_form(const MeshPart<PolygonMesh>& part,
                                      const std::string& operator_name);
OperatorForm distributed_poisson_form(const MeshPart<PolyhedralMesh>& part,
                                      const std::string& operator_name);

/// Solves -div(K grad u) = f on a mesh of which every process holds a part, as Poisson does on one
/// that is whole. Conjugate gradients of the sum of all parts' stiffness, preconditioned by
/// multigrid of the sparser one; options of PETSc (-ksp_..., -pc_...) choose others. Of operators
/// as products the matrix is made only if that does not serve.
class DistributedPoisson {
 public:
  /// Collective. \param discretization  of discretize_part(), in the same form in all processes
  /// \param conditions  numbered as in the part. Dirichlet data count for the part's own vertices,
  ///                    those of sides for its own interfaces; others are ignored, so that data may
  ///                    be given wherever they are known.
  /// \throws InvalidOption  as Poisson, Shared
  /// \throws SolverFailure  likewise
  DistributedPoisson(const MeshPart<PolygonMesh>& part, const Discretization& discretization,
                     const BoundaryConditions& conditions = {});
  DistributedPoisson(const MeshPart<PolyhedralMesh>& part, const Discretization& discretization,
                     const BoundaryConditions& conditions = {});
  ~DistributedPoisson();
  DistributedPoisson(DistributedPoisson&&) noexcept;

  /// Collective. \param f  at the part's vertices
  /// \return values at the part's vertices, own and others
  PoissonSolution solve(const Vector& f) const;
  /// Collective. \param load  what the part brings to the integrated right-hand side
  PoissonSolution solve_integrated(const Vector& load) const;

  /// Collective. Takes the mean by mass off a function in every floating component, as solutions
  /// have it. \param function  at the part's vertices
  void remove_floating_means(Vector& function) const;
  /// Collective. error_norms() of the whole mesh; vertices of no element count as without an error.
  /// \param error  at the part's vertices
  ErrorNorms norms(const Vector& error) const;

  /// What the part brought to matrices: of the system, unless it is a product, and of the one that
  /// preconditions.
  const PartShare& share() const;
  /// Component of each of the part's vertices; -1: in no element with a measure.
  const std::vector<Index>& components() const;

 private:
  struct Impl;
  template <class Mesh>
  void set_up(const MeshPart<Mesh>& part, const Discretization& discretization,
              const BoundaryConditions& conditions);
  std::unique_ptr<Impl> impl_;
};

}  // namespace carat
