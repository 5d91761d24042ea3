#pragma once
// Symmetric positive definite systems over all processes. Seen by this folder's sources alone.

#include <functional>
#include <string>

#include "carat/distributed/part_exchange.h"
#include "carat/solve/conjugate_gradients.h"

namespace carat {

/// Conjugate gradients with algebraic multigrid of another matrix, until the residual is 1e-12 of
/// the right-hand side; PETSc's options change all of that. Where multigrid of the other matrix
/// does not serve, that of the system takes over.
class SpdIteration {
 public:
  /// Collective. \param like  spectrally equivalent and sparser; null: the system itself
  /// \param dimension  of the mesh
  /// \param assemble   makes the matrix of a system that only multiplies; collective
  SpdIteration(PetscMatrix system, PetscMatrix like, int dimension,
               std::function<PetscMatrix()> assemble = {});

  /// Collective. \throws SolverFailure  Shared: the residual of the solution is above 1e-10
  PetscVector solve(Vec right_hand_side, SolveReport& report);
  Mat system() const { return system_; }
  std::string method() const;

 private:
  PetscMatrix system_, like_;
  std::function<PetscMatrix()> assemble_;
  PetscSolver solver_;
};

/// Puts conjugate gradients and multigrid into a solver of PETSc where its options do not say
/// otherwise: BoomerAMG on surfaces, GAMG in volumes, where its set-up takes a quarter of the time.
void set_spd_defaults(KSP solver, int dimension);

}  // namespace carat
