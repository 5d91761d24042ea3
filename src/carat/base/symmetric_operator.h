#pragma once
// Symmetric linear operators, whether their matrix is stored or not.

#include <cstddef>
#include <memory>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// A symmetric matrix that can be multiplied with vectors. Immutable, and for several threads at a
/// time; products are the same bits for any number of threads.
class SymmetricOperator {
 public:
  virtual ~SymmetricOperator() = default;
  virtual Index rows() const = 0;
  /// y = A x for k vectors at once, which reads the operator once.
  /// \param x, y  (rows, k), the k values of a row side by side; they must not overlap
  virtual void multiply(const double* x, double* y, Index k) const = 0;
  /// \param x  (rows)
  Vector operator*(const Vector& x) const {
    Vector y(rows());
    multiply(x.data(), y.data(), 1);
    return y;
  }
  virtual Vector diagonal() const = 0;
  /// Sum of the absolute values of every row, or a bound of it: their largest bounds the norm, and
  /// what rounding does to a product.
  virtual Vector row_norms() const = 0;
  /// Connected components by couplings that are not zero, numbered by first row; -1 for rows
  /// without any.
  virtual std::vector<Index> components() const = 0;
  /// The sum with a symmetric matrix.
  virtual std::shared_ptr<const SymmetricOperator> plus(const SparseMatrix& other) const = 0;
  /// Whether the matrix is stored.
  virtual bool assembled() const = 0;
  /// Whether little more than one triangle of it is.
  virtual bool halved() const { return false; }
  /// Entries of the matrix.
  virtual std::int64_t nonzeros() const { return matrix()->nonZeros(); }
  /// The matrix; made now where it is not stored, which takes longer than to assemble it.
  virtual std::shared_ptr<const SparseMatrix> matrix() const = 0;
  /// A matrix with the lower triangle and the diagonal of this one; entries above may be missing.
  /// Made as matrix() where neither is stored.
  virtual std::shared_ptr<const SparseMatrix> lower_triangle() const { return matrix(); }
  virtual std::size_t bytes() const = 0;  ///< that a product reads
};

}  // namespace carat
