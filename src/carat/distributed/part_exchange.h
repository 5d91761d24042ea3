#pragma once
// Vectors and matrices over all vertices of a mesh, from and to the vertices of its parts. Seen by
// this folder's sources alone.

#include "carat/distributed/petsc.h"
#include "carat/mesh/mesh_part.h"

namespace carat {

/// Between the vertices of the parts and vectors with one row a vertex, in the order of
/// MeshDivision::vertex_row: each process holds the rows of its part's own vertices.
class PartExchange {
 public:
  /// Collective.
  explicit PartExchange(const PartNumbers& numbers);

  Index n_own() const { return n_own_; }
  Index n_here() const { return static_cast<Index>(rows_.size()); }
  const std::vector<PetscInt>& rows() const { return rows_; }  ///< of the part's vertices

  /// A vector of zeros.
  PetscVector vector() const;
  /// Collective. The values at the part's vertices.
  Vector to_part(Vec values) const;
  void to_part(Vec values, Vector& here) const;
  /// Collective. The sum of what all parts bring.
  PetscVector sum(const Vector& of_part) const;
  void sum(const Vector& of_part, Vec into) const;
  /// Collective. The sum of what all parts bring, a matrix over the part's vertices from each.
  PetscMatrix sum(const SparseMatrix& of_part) const;

 private:
  Index n_own_ = 0, n_all_ = 0;
  std::vector<PetscInt> rows_;
  PetscVector here_;
  PetscScatter scatter_;
};

/// The process's own rows of a vector.
class OwnRows {
 public:
  explicit OwnRows(Vec vector) : vector_(vector) {
    check(VecGetLocalSize(vector, &size_));
    check(VecGetArray(vector, &values_));
  }
  ~OwnRows() { VecRestoreArray(vector_, &values_); }
  OwnRows(const OwnRows&) = delete;
  OwnRows& operator=(const OwnRows&) = delete;
  Eigen::Map<Vector> values() const { return {values_, size_}; }

 private:
  Vec vector_;
  PetscInt size_ = 0;
  double* values_ = nullptr;
};

}  // namespace carat
