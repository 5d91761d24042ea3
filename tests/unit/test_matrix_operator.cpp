#include <gtest/gtest.h>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/solve/cholesky.h"
#include "carat/solve/matrix_operator.h"

namespace carat::test {
namespace {

TEST(MatrixOperator, multiplies_as_the_matrix_does) {
  const Discretization d = discretize(generate_mesh("plane-voronoi", {.level = 3}));
  const auto matrix = std::make_shared<SparseMatrix>(d.stiffness);
  const Index n = static_cast<Index>(matrix->rows());
  for (const Index k : {1, 2, 5, 8, 13}) {
    const Matrix x = Matrix::Random(n, k);
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Rows rows = x;
    Rows y(n, k), again(n, k);
    MatrixOperator(matrix, 1).multiply(rows.data(), y.data(), k);
    MatrixOperator(matrix, 3).multiply(rows.data(), again.data(), k);
    EXPECT_EQ(y, again);
    EXPECT_LT((Matrix(y) - *matrix * x).cwiseAbs().maxCoeff(), 1e-13);
    for (Index j = 0; j < k; ++j)
      EXPECT_EQ(Vector(y.col(j)), MatrixOperator(matrix) * Vector(x.col(j)));
  }
  const MatrixOperator a(matrix);
  EXPECT_EQ(a.diagonal(), Vector(matrix->diagonal()));
  EXPECT_EQ(a.components(), matrix_components(*matrix));
  EXPECT_NEAR((a.row_norms() - matrix->cwiseAbs() * Vector::Ones(n)).norm(), 0, 1e-12);
  EXPECT_LT((*a.plus(d.mass) * Vector::Ones(n) - d.mass * Vector::Ones(n)).norm(), 1e-12);
}

}  // namespace
}  // namespace carat::test
