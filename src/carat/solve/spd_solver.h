#pragma once
// Symmetric positive definite systems: one interface to all ways of solving them.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "carat/base/symmetric_operator.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/conjugate_gradients.h"

namespace carat {

enum class SolverKind {
  Auto,                ///< chosen by dimension, size, number of right-hand sides and memory
  Cholesky,            ///< factorisation of the matrix
  Multigrid,           ///< conjugate gradients; preconditioned by multigrid,
  IncompleteCholesky,  ///< by an incomplete factor,
  SparserCholesky,     ///< by a factorisation of the sparser matrix
};

/// All of them, Auto first.
std::vector<SolverKind> solver_kinds();
/// "auto", "cholesky", "multigrid", "incomplete-cholesky", "sparser-cholesky".
const char* solver_kind_name(SolverKind kind);
/// \throws InvalidOption  unknown name; the message lists the known ones
SolverKind solver_kind(const std::string& name);

/// How a matrix is kept.
enum class MatrixStorage {
  Full,
  Triangle,  ///< little more than one triangle: half of the memory (SymmetricMatrix)
};

/// "full", "triangle".
/// \throws InvalidOption  unknown name; the message lists the known ones
MatrixStorage matrix_storage(const std::string& name);

struct SolverOptions {
  SolverKind kind = SolverKind::Auto;
  Index right_hand_sides = 1;  ///< how many are expected: many pay for a factorisation
  int dimension = 2;           ///< of the mesh: factors of volumes fill much faster
  /// Makes a matrix of fewer entries that is spectrally equivalent, from which preconditioners are
  /// built. Empty: they are built from the matrix itself.
  std::function<SparseMatrix()> sparser{};
  int threads = 0;  ///< of products and vectors; 0: all the machine has
  /// Of matrices that Poisson makes its own; shared ones stay as they are.
  MatrixStorage storage = MatrixStorage::Full;
};

/// Whether the solver of so many unknowns is an iteration, lack of memory for a factor and failures
/// aside.
bool takes_iteration(const SolverOptions& options, Index n_unknowns);

/// Bytes of a Cholesky factor with its work space, fitted to CHOLMOD on meshes of all kinds, to a
/// factor of two.
double factor_bytes(Index n_unknowns, double nonzeros, int dimension);

/// What was chosen, and what it cost to set up.
struct SolverInfo {
  SolverKind kind = SolverKind::Cholesky;
  std::string method;              ///< e.g. "conjugate gradients, multigrid", "matrix-free ..."
  std::string reason;              ///< why; empty where the caller chose
  std::string ordering;            ///< of a factorisation
  std::int64_t nonzeros = 0;       ///< in the factor or preconditioner
  std::size_t operator_bytes = 0;  ///< of the matrix, or of what multiplies without it
  bool assembled = true;           ///< the matrix was, or had to be
  bool halved = false;             ///< of the matrix little more than a triangle is kept
  double seconds = 0;              ///< to set it up
};

/// Solves A x = b for many right-hand sides, by a factorisation or by conjugate gradients. These
/// need no matrix where there is a sparser one to precondition with: then an operator that stores
/// none is never assembled, unless a factorisation is chosen or has to take over.
///
/// Rows can be held out ("fixed") as in Cholesky. Where Auto chose an iteration and it fails, a
/// factorisation takes over. Solutions of an iteration have a residual of 1e-12 of the right-hand
/// side or of its rounding, checked anew; none beyond 1e-10 is returned.
class SpdSolver {
 public:
  /// \param a      shared, not copied
  /// \param fixed  empty, or one flag a row: rows and columns to leave out
  /// \throws SolverFailure  not positive definite, as far as the set-up sees
  explicit SpdSolver(std::shared_ptr<const SymmetricOperator> a, std::vector<bool> fixed = {},
                     const SolverOptions& options = {});
  /// \param matrix  symmetric; shared, not copied
  explicit SpdSolver(std::shared_ptr<const SparseMatrix> matrix, std::vector<bool> fixed = {},
                     const SolverOptions& options = {});
  ~SpdSolver();
  SpdSolver(SpdSolver&&) noexcept;
  SpdSolver& operator=(SpdSolver&&) noexcept;

  /// \param rhs     (n, k): k right-hand sides; fixed rows are ignored
  /// \param report  if given: how it went
  /// \return (n, k); zero in fixed rows
  /// \throws SolverFailure  no solution within the limits, with the course of the residuals
  Matrix solve(const Matrix& rhs, SolveReport* report = nullptr) const;

  const SolverInfo& info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace carat
