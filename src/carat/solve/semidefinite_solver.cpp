#include "carat/solve/semidefinite_solver.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat {

SemidefiniteSolver::SemidefiniteSolver(std::shared_ptr<const SparseMatrix> matrix,
                                       const SolverOptions& options)
    : components_(matrix_components(*matrix)) {
  const Index n = static_cast<Index>(matrix->rows());
  for (const Index c : components_) n_components_ = std::max(n_components_, c + 1);
  sizes_.assign(static_cast<std::size_t>(n_components_), 0);
  // Ground the row with the largest diagonal of each component: the best determined one.
  std::vector<Index> ground(static_cast<std::size_t>(n_components_), -1);
  const Vector diagonal = matrix->diagonal();
  for (Index row = 0; row < n; ++row) {
    const Index c = components_[row];
    if (c < 0) continue;
    ++sizes_[c];
    if (ground[c] < 0 || diagonal[row] > diagonal[ground[c]]) ground[c] = row;
  }
  std::vector<bool> fixed(static_cast<std::size_t>(n), false);
  for (Index row = 0; row < n; ++row) fixed[row] = components_[row] < 0;
  for (const Index row : ground) fixed[row] = true;
  solver_ = std::make_unique<SpdSolver>(std::move(matrix), std::move(fixed), options);
}

Matrix SemidefiniteSolver::solve(Matrix rhs, SolveReport* report) const {
  const auto remove_means = [&](Matrix& values) {
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      std::vector<double> sum(sizes_.size(), 0.0);
      for (std::size_t row = 0; row < components_.size(); ++row)
        if (components_[row] >= 0) sum[components_[row]] += values(static_cast<Index>(row), k);
      for (std::size_t row = 0; row < components_.size(); ++row) {
        const Index c = components_[row];
        if (c >= 0)
          values(static_cast<Index>(row), k) -= sum[c] / sizes_[c];
        else
          values(static_cast<Index>(row), k) = 0;
      }
    }
  };
  if (rhs.rows() != static_cast<Eigen::Index>(components_.size()))
    throw InvalidOption("a right-hand side of " + std::to_string(rhs.rows()) + " rows for " +
                        std::to_string(components_.size()) + " unknowns");
  remove_means(rhs);
  Matrix result = solver_->solve(rhs, report);
  remove_means(result);
  return result;
}

double SemidefiniteSolver::imbalance(const Vector& rhs) const {
  std::vector<double> sum(sizes_.size(), 0.0), total(sizes_.size(), 0.0);
  for (std::size_t row = 0; row < components_.size(); ++row)
    if (components_[row] >= 0) {
      sum[components_[row]] += rhs[static_cast<Index>(row)];
      total[components_[row]] += std::abs(rhs[static_cast<Index>(row)]);
    }
  double worst = 0;
  for (std::size_t c = 0; c < sum.size(); ++c)
    if (total[c] > 0) worst = std::max(worst, std::abs(sum[c]) / total[c]);
  return worst;
}

}  // namespace carat
