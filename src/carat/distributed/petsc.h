#pragma once
// PETSc's objects with owners, and its errors as exceptions. Seen by this folder's sources alone.

#include <petscksp.h>

#include <utility>

namespace carat {

/// \throws SolverFailure  what PETSc says of the error
void check(PetscErrorCode error);

/// Owns one object of PETSc.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class PetscOwner {
 public:
  PetscOwner() = default;
  ~PetscOwner() { destroy(&object_); }
  PetscOwner(PetscOwner&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  PetscOwner& operator=(PetscOwner&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  operator Object() const { return object_; }
  /// For functions that make the object.
  Object* out() {
    destroy(&object_);
    return &object_;
  }
  /// For functions that change the handle.
  Object& handle() { return object_; }

 private:
  Object object_ = nullptr;
};

using PetscVector = PetscOwner<Vec, VecDestroy>;
using PetscMatrix = PetscOwner<Mat, MatDestroy>;
using PetscSolver = PetscOwner<KSP, KSPDestroy>;
using PetscScatter = PetscOwner<VecScatter, VecScatterDestroy>;
using PetscIndices = PetscOwner<IS, ISDestroy>;

}  // namespace carat
