#pragma once
// Approximate inverses for conjugate gradients.

#include <cstdint>

#include "carat/base/types.h"

namespace carat {

/// A symmetric positive definite approximation of the inverse of a matrix, held-out rows aside.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// z = (approximate inverse) r.
  /// \param r  (n): values of all rows; those of held-out rows are not read
  /// \param z  (n), 0 in held-out rows
  virtual void apply(const Vector& r, Vector& z) const = 0;
  /// The same for k vectors, the k values of a row side by side: (n * k). Without an implementation
  /// of its own: one after the other.
  virtual void apply_block(const Vector& r, Vector& z, Index k) const;
  virtual std::int64_t nonzeros() const = 0;  ///< stored entries of its matrices
};

}  // namespace carat
