#include "carat/distributed/componentwise.h"

#include <cmath>
#include <string>

#include "carat/base/text.h"
#include "carat/distributed/processes.h"
#include "carat/solve/componentwise.h"

namespace carat {
namespace {

using namespace componentwise;

/// The matrix with the magnitudes of its entries.
PetscMatrix magnitudes(Mat matrix) {
  PetscMatrix result;
  check(MatDuplicate(matrix, MAT_COPY_VALUES, result.out()));
  Mat inside = nullptr, outside = nullptr;
  check(MatMPIAIJGetSeqAIJ(result, &inside, &outside, nullptr));
  for (Mat block : {inside, outside}) {
    MatInfo info;
    double* values = nullptr;
    check(MatGetInfo(block, MAT_LOCAL, &info));
    check(MatSeqAIJGetArray(block, &values));
    const auto n = static_cast<std::ptrdiff_t>(info.nz_used);
    for (std::ptrdiff_t k = 0; k < n; ++k) values[k] = std::abs(values[k]);
    check(MatSeqAIJRestoreArray(block, &values));
  }
  return result;
}

class Product {
 public:
  explicit Product(Mat matrix) : matrix_(matrix) {
    check(MatCreateVecs(matrix, x_.out(), y_.out()));
  }
  Vector operator()(const Vector& x) const {
    OwnRows(x_).values() = x;
    check(MatMult(matrix_, x_, y_));
    return OwnRows(y_).values();
  }

 private:
  Mat matrix_;
  PetscVector x_, y_;
};

}  // namespace

Vector solve_componentwise(Mat matrix, Vector inverse, Vector b, SolveReport& report) {
  const PetscMatrix sizes = magnitudes(matrix);
  const Product multiply(matrix), multiply_sizes(sizes);
  // Bounds then do not depend on units.
  const double largest_inverse = largest_of_all(inverse.size() > 0 ? inverse.maxCoeff() : 0.0);
  const double unit = largest_inverse > 0 ? std::ldexp(1.0, std::ilogb(largest_inverse)) : 1.0;
  inverse /= unit;
  b *= unit;
  for (Index i = 0; i < b.size(); ++i)
    if (inverse[i] == 0) b[i] = 0;
  const double largest = largest_of_all(b.size() > 0 ? b.lpNorm<Eigen::Infinity>() : 0.0);
  if (!std::isfinite(sum_of_all(b.sum())))
    throw Shared<SolverFailure>("the right-hand side holds values that are not finite");

  double scale = largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1;
  Vector x = Vector::Zero(b.size()), r = b / scale, p = inverse.cwiseProduct(r);
  const auto error = [&] {
    const Vector residual = b - unit * multiply(x);
    const Vector size = unit * multiply_sizes(x.cwiseAbs()) + b.cwiseAbs();
    double worst = 0;
    for (Index i = 0; i < x.size(); ++i)
      if (inverse[i] > 0 && size[i] >= kVanished) {
        const double own = std::abs(residual[i] / size[i]);
        worst = std::isfinite(own) ? std::max(worst, own) : HUGE_VAL;
      }
    return largest_of_all(worst);
  };
  double energy = sum_of_all(r.dot(p));
  double worst = 1;
  Index iterations = 0;
  for (; worst > kTolerance && energy > 0 && iterations < kIterations; ++iterations) {
    const Vector q = unit * multiply(p);
    const double curvature = sum_of_all(p.dot(q));
    if (!(curvature > 0))
      throw Shared<SolverFailure>(
          "the matrix is not positive definite, or holds values that are not finite: conjugate "
          "gradients met a direction without energy");
    const double step = energy / curvature;
    x += step * scale * p;
    for (Index i = 0; i < r.size(); ++i)
      if (inverse[i] > 0) r[i] -= step * q[i];
    const double next = sum_of_all(inverse.cwiseProduct(r).dot(r));
    const bool grows = next < kSmallEnergy && scale > std::ldexp(1.0, kRescaling - 1000);
    const double growth = grows ? std::ldexp(1.0, kRescaling) : 1;
    p = (inverse.cwiseProduct(r) + next / energy * p) * growth;
    r *= growth;
    energy = next * growth * growth;
    scale /= growth;
    if (iterations % kCheckEvery == kCheckEvery - 1) worst = error();
  }
  worst = error();
  if (!(worst <= kTolerance))
    throw Shared<SolverFailure>("conjugate gradients left a residual of " + scientific(worst) +
                                " of its row after " + std::to_string(iterations) +
                                " iterations, at most 1e-10 is a solution");
  report.iterations = std::max(report.iterations, iterations);
  report.residual = std::max(report.residual, worst);
  return x;
}

}  // namespace carat
