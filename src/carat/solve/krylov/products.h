#pragma once
// Products of tall matrices with small ones, by BLAS where it is there, and with sparse ones.

#include "carat/base/types.h"

namespace carat {

/// a^T b.
Matrix transposed_product(const Eigen::Ref<const Matrix>& a, const Eigen::Ref<const Matrix>& b);

/// c += factor a b.
void add_product(Eigen::Ref<Matrix> c, double factor, const Eigen::Ref<const Matrix>& a,
                 const Eigen::Ref<const Matrix>& b);

/// The first columns of a, as many as m has, become a m, in place.
/// \param m  (columns of a, at most as many)
void transform_columns(Eigen::Ref<Matrix> a, const Eigen::Ref<const Matrix>& m);

/// a x, several columns at a time. \param threads  0: all the machine has
Matrix sparse_product(const SparseMatrix& a, const Eigen::Ref<const Matrix>& x, int threads);

}  // namespace carat
