#include "carat/distributed/spd_iteration.h"

#include <cmath>

#include "carat/base/text.h"
#include "carat/distributed/processes.h"

namespace carat {
namespace {

constexpr double kTolerance = 1e-12, kAccepted = 1e-10;
/// Multigrid that serves takes a few dozen.
constexpr PetscInt kIterations = 200;

}  // namespace

void set_spd_defaults(KSP solver, int dimension) {
  PC preconditioner = nullptr;
  check(KSPSetType(solver, KSPCG));
  check(KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED));
  check(KSPSetTolerances(solver, kTolerance, 0, PETSC_DEFAULT, kIterations));
  check(KSPGetPC(solver, &preconditioner));
#if defined(PETSC_HAVE_HYPRE)
  if (dimension == 2) {
    check(PCSetType(preconditioner, PCHYPRE));
    check(PCHYPRESetType(preconditioner, "boomeramg"));
    return;
  }
#endif
  static_cast<void>(dimension);
  check(PCSetType(preconditioner, PCGAMG));
}

SpdIteration::SpdIteration(PetscMatrix system, PetscMatrix like, int dimension,
                           std::function<PetscMatrix()> assemble)
    : system_(std::move(system)), like_(std::move(like)), assemble_(std::move(assemble)) {
  if (!like_ && assemble_) system_ = assemble_();
  check(KSPCreate(PETSC_COMM_WORLD, solver_.out()));
  Mat const preconditioned = like_ ? like_ : system_;
  MatNullSpace constants = nullptr;
  check(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_TRUE, 0, nullptr, &constants));
  check(MatSetNearNullSpace(preconditioned, constants));
  check(MatNullSpaceDestroy(&constants));
  check(KSPSetOperators(solver_, system_, preconditioned));
  set_spd_defaults(solver_, dimension);
  check(KSPSetFromOptions(solver_));
  check(KSPSetUp(solver_));
}

std::string SpdIteration::method() const {
  KSPType iteration = nullptr;
  PC preconditioner = nullptr;
  PCType type = nullptr;
  check(KSPGetType(solver_, &iteration));
  check(KSPGetPC(solver_, &preconditioner));
  check(PCGetType(preconditioner, &type));
  PetscBool multiplies = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(static_cast<Mat>(system_)), MATSHELL,
                               &multiplies));
  return std::string(multiplies ? "matrix-free PETSc " : "PETSc ") + iteration + " with " + type +
         (like_ ? " of the sparser stiffness" : "");
}

PetscVector SpdIteration::solve(Vec right_hand_side, SolveReport& report) {
  PetscVector x, residual;
  double size = 0, left = 0;
  check(VecDuplicate(right_hand_side, x.out()));
  check(VecDuplicate(right_hand_side, residual.out()));
  check(VecNorm(right_hand_side, NORM_2, &size));
  if (!std::isfinite(size))
    throw Shared<SolverFailure>("the right-hand side holds a value that is not finite");
  const auto attempt = [&] {
    PetscInt iterations = 0;
    check(KSPSolve(solver_, right_hand_side, x));
    check(KSPGetIterationNumber(solver_, &iterations));
    report.iterations += static_cast<Index>(iterations);
    check(MatMult(system_, x, residual));
    check(VecAYPX(residual, -1, right_hand_side));
    check(VecNorm(residual, NORM_2, &left));
    return left <= kAccepted * size;
  };
  bool solved = attempt();
  if (!solved && like_) {
    if (assemble_) system_ = assemble_();
    like_ = {};
    check(KSPSetOperators(solver_, system_, system_));
    solved = attempt();
  }
  report.method = method();
  report.residual = size > 0 ? left / size : 0;
  if (!solved)
    throw Shared<SolverFailure>(
        report.method + " left a residual of " + scientific(report.residual) +
        " of the right-hand side after " + std::to_string(report.iterations) +
        " iterations, at most 1e-10 is a solution; choose another solver by the options of PETSc, "
        "e.g. -pc_type cholesky -pc_factor_mat_solver_type mumps");
  return x;
}

}  // namespace carat
