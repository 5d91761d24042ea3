#include "carat/solve/conjugate_gradients.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "carat/base/error.h"

namespace carat {
namespace {

/// What the rounding of a product may add to a residual, in units of |A| |x|.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
/// Restarts from the true residual where that of the recursion has drifted from it.
constexpr int kRestarts = 3;

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

/// At most six of the residuals, evenly spaced, the last among them.
std::string course(const std::vector<double>& history) {
  std::string text;
  const std::size_t last = history.size() - 1;
  const std::size_t points = std::min<std::size_t>(6, history.size());
  for (std::size_t k = 0; k < points; ++k) {
    const std::size_t at = points > 1 ? last * k / (points - 1) : last;
    text.append(k > 0 ? ", " : "").append(scientific(history[at]));
    text.append(" (").append(std::to_string(at)).append(")");
  }
  return text;
}

}  // namespace

Vector conjugate_gradients(const std::function<void(const Vector&, Vector&)>& multiply,
                           const Preconditioner& preconditioner, const Vector& b, double size,
                           const IterationLimits& limits, SolveReport& report) {
  Vector x = Vector::Zero(b.size());
  const double norm = b.norm();
  if (!std::isfinite(norm))
    throw SolverFailure("the right-hand side holds values that are not finite");
  if (!(norm > 0)) return x;
  Vector r = b, z, p, q(b.size());
  std::vector<double> history{1};
  double residual = 1, rounding = 0;
  for (int restart = 0; restart <= kRestarts; ++restart) {
    preconditioner.apply(r, z);
    p = z;
    double rz = r.dot(z);
    const auto spent = [&] { return static_cast<Index>(history.size()) > limits.iterations; };
    while (history.back() > limits.tolerance && !spent()) {
      multiply(p, q);
      const double curvature = p.dot(q);
      if (!(curvature > 0) || !(rz > 0))
        throw SolverFailure(
            "the matrix or its preconditioner is not positive definite: conjugate gradients met a "
            "direction of energy " +
            scientific(std::min(curvature, rz)));
      const double step = rz / curvature;
      x += step * p;
      r -= step * q;
      history.push_back(r.norm() / norm);
      preconditioner.apply(r, z);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
    }
    multiply(x, q);
    r = b - q;
    residual = r.norm() / norm;
    rounding = kRounding * size * x.norm() / norm;
    if (residual <= std::max(limits.tolerance, rounding) || spent()) break;
    history.back() = residual;
  }
  if (!(residual <= limits.accepted + rounding))
    throw SolverFailure("conjugate gradients stopped at a residual of " + scientific(residual) +
                        " of the right-hand side after " + std::to_string(history.size() - 1) +
                        " iterations, at most " + scientific(limits.accepted) +
                        " is a solution; residuals by iteration: " + course(history));
  report.iterations = std::max(report.iterations, static_cast<Index>(history.size()) - 1);
  report.residual = std::max(report.residual, residual);
  return x;
}

}  // namespace carat
