#include "carat/operators/discretization.h"

#include <string>

#include "carat/base/error.h"

namespace carat {
namespace {

void require_gradient(const Discretization& d, Eigen::Index n_values) {
  if (d.gradient_dimension == 0)
    throw InvalidOption("the gradient was not computed; ask for DiscretizationParts::Gradient");
  const Eigen::Index expected = Eigen::Index{d.gradient_dimension} * d.n_samples();
  if (n_values != expected)
    throw InvalidOption(std::to_string(n_values) + " gradient values; there are " +
                        std::to_string(expected) + " (" + std::to_string(d.gradient_dimension) +
                        " a sample)");
}

/// Sums measure * axes * g of every part into rows chosen by `visit(part, add)`, then divides.
template <class Visit>
Points average_parts(const Discretization& d, const Vector& vectors, Index n_rows,
                     const Visit& visit) {
  require_gradient(d, vectors.size());
  if (d.frames.parts.empty() && d.n_samples() > 0)
    throw InvalidOption("the frames were not computed; ask for DiscretizationParts::Frames");
  Points sum = Points::Zero(n_rows, 3);
  Vector measure = Vector::Zero(n_rows);
  for (std::size_t k = 0; k < d.frames.parts.size(); ++k) {
    const GradientFrames::Part& part = d.frames.parts[k];
    const Eigen::Index first = Eigen::Index{part.sample} * d.gradient_dimension;
    const Vec3 vector = d.frames.axes.empty() ? Vec3(vectors.segment<3>(first))
                                              : d.frames.axes[k] * vectors.segment<2>(first);
    visit(part, [&](Index row) {
      sum.row(row) += part.measure * vector.transpose();
      measure[row] += part.measure;
    });
  }
  for (Index row = 0; row < n_rows; ++row)
    if (measure[row] > 0) sum.row(row) /= measure[row];
  return sum;
}

}  // namespace

SparseMatrix Discretization::divergence() const {
  require_gradient(*this, gradient.rows());
  SparseMatrix weighted = gradient;
  for (Index row = 0; row < weighted.rows(); ++row) {
    const double measure = -sample_measure[row / gradient_dimension];
    for (SparseMatrix::InnerIterator entry(weighted, row); entry; ++entry)
      entry.valueRef() *= measure;
  }
  return weighted.transpose();
}

Vector Discretization::apply_divergence(const Vector& vectors) const {
  require_gradient(*this, vectors.size());
  Vector weighted(vectors.size());
  for (Eigen::Index row = 0; row < vectors.size(); ++row)
    weighted[row] = -vectors[row] * sample_measure[row / gradient_dimension];
  return gradient.transpose() * weighted;
}

Points Discretization::element_vectors(const Vector& vectors, Index n_elements) const {
  return average_parts(*this, vectors, n_elements,
                       [](const GradientFrames::Part& part, auto&& add) { add(part.element); });
}

Points Discretization::vertex_vectors(const Vector& vectors) const {
  return average_parts(*this, vectors, n_vertices(),
                       [](const GradientFrames::Part& part, auto&& add) {
                         for (const Index v : part.vertices)
                           if (v >= 0) add(v);
                       });
}

}  // namespace carat
