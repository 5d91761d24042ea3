#pragma once
// The lowest eigenvalues of S x = lambda M x by inverse subspace iteration, independent of the
// library's own eigenmodes.

#include <Eigen/Dense>

#include "carat/solve/cholesky.h"

namespace carat::test {

/// The k lowest with x = 0 at the fixed vertices, ascending. A block of 2k vectors converges at
/// the rate lambda_k / lambda_2k a step, squared in the eigenvalues.
inline Vector lowest_eigenvalues(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                 const std::vector<bool>& fixed, Index k, int steps) {
  const Cholesky solver(stiffness, fixed);
  const Eigen::Index n = stiffness.rows();
  Matrix x = Matrix::Zero(n, 2 * k);
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      if (!fixed[static_cast<std::size_t>(i)])
        x(i, j) = std::sin(1.0 + static_cast<double>((i + 1) * (j + 3)) * 0.7);
  Vector values;
  for (int step = 0; step < steps; ++step) {
    const Matrix load = mass * x;
    x = solver.solve(load);
    // S x = load at free vertices: x^T S x = x^T load.
    const Matrix s = x.transpose() * load, m = x.transpose() * (mass * x);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> ritz((s + s.transpose()) / 2,
                                                                (m + m.transpose()) / 2);
    x = x * ritz.eigenvectors();
    values = ritz.eigenvalues();
  }
  return values.head(k);
}

}  // namespace carat::test
