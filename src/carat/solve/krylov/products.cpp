#include "carat/solve/krylov/products.h"

#include <algorithm>

#include "carat/base/parallel.h"

#ifdef CARAT_WITH_CHOLMOD
// Of the BLAS that CHOLMOD needs: Eigen's own products keep to the least processor.
extern "C" void dgemm_(const char* transpose_a, const char* transpose_b, const int* rows,
                       const int* columns, const int* inner, const double* factor, const double* a,
                       const int* a_stride, const double* b, const int* b_stride,
                       const double* c_factor, double* c, const int* c_stride);
#endif

namespace carat {
namespace {

using ConstRef = Eigen::Ref<const Matrix>;

#ifdef CARAT_WITH_CHOLMOD
/// c = factor op(a) b + c_factor c.
void multiply(char transpose_a, double factor, const ConstRef& a, const ConstRef& b,
              double c_factor, Eigen::Ref<Matrix> c) {
  const int rows = static_cast<int>(c.rows()), columns = static_cast<int>(c.cols());
  const int inner = static_cast<int>(b.rows());
  const auto stride = [](const auto& x) {
    return static_cast<int>(std::max<Eigen::Index>(1, x.outerStride()));
  };
  const int a_stride = stride(a), b_stride = stride(b), c_stride = stride(c);
  dgemm_(&transpose_a, "N", &rows, &columns, &inner, &factor, a.data(), &a_stride, b.data(),
         &b_stride, &c_factor, c.data(), &c_stride);
}
#endif

/// Rows [begin, end) of y = a x for kColumns columns.
template <int kColumns>
void multiply_rows(const SparseMatrix& a, const double* x, Eigen::Index x_stride, double* y,
                   Eigen::Index y_stride, Index begin, Index end) {
  const Index* const offsets = a.outerIndexPtr();
  const Index* const columns = a.innerIndexPtr();
  const double* const values = a.valuePtr();
  for (Index row = begin; row < end; ++row) {
    double sums[kColumns] = {};
    for (Index k = offsets[row]; k < offsets[row + 1]; ++k)
      for (int c = 0; c < kColumns; ++c) sums[c] += values[k] * x[columns[k] + c * x_stride];
    for (int c = 0; c < kColumns; ++c) y[row + c * y_stride] = sums[c];
  }
}

}  // namespace

Matrix sparse_product(const SparseMatrix& a, const ConstRef& x, int threads) {
  Matrix y(a.rows(), x.cols());
  const Eigen::Index x_stride = x.outerStride(), y_stride = y.outerStride();
  parallel_blocks(static_cast<Index>(a.rows()), threads, [&](int, Index begin, Index end) {
    Eigen::Index c = 0;
    for (; c + 4 <= x.cols(); c += 4)
      multiply_rows<4>(a, x.data() + c * x_stride, x_stride, y.data() + c * y_stride, y_stride,
                       begin, end);
    for (; c < x.cols(); ++c)
      multiply_rows<1>(a, x.data() + c * x_stride, x_stride, y.data() + c * y_stride, y_stride,
                       begin, end);
  });
  return y;
}

Matrix transposed_product(const ConstRef& a, const ConstRef& b) {
#ifdef CARAT_WITH_CHOLMOD
  Matrix c = Matrix::Zero(a.cols(), b.cols());
  if (c.size() > 0) multiply('T', 1, a, b, 0, c);
  return c;
#else
  return a.transpose() * b;
#endif
}

void add_product(Eigen::Ref<Matrix> c, double factor, const ConstRef& a, const ConstRef& b) {
  if (c.size() == 0 || a.cols() == 0) return;
#ifdef CARAT_WITH_CHOLMOD
  multiply('N', factor, a, b, 1, c);
#else
  c.noalias() += factor * a * b;
#endif
}

void transform_columns(Eigen::Ref<Matrix> a, const ConstRef& m) {
  // Some rows at a time, so that no second matrix of this size is needed.
  constexpr Eigen::Index kRows = 2048;
  Matrix rows;
  for (Eigen::Index r = 0; r < a.rows(); r += kRows) {
    const Eigen::Index n = std::min(kRows, a.rows() - r);
    rows.setZero(n, m.cols());
    add_product(rows, 1, a.middleRows(r, n), m);
    a.block(r, 0, n, m.cols()) = rows;
  }
}

}  // namespace carat
