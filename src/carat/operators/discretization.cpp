#include "carat/operators/discretization.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "carat/base/error.h"

namespace carat {
namespace {

void require_gradient(const Discretization& d, Eigen::Index n_values) {
  if (d.gradient_dimension == 0)
    throw InvalidOption("the operator " + d.name +
                        " defines no gradient, or it was not asked for: "
                        "DiscretizationParts::Gradient");
  const Eigen::Index expected = d.first_row(d.n_samples());
  if (n_values != expected)
    throw InvalidOption(std::to_string(n_values) + " gradient values; there are " +
                        std::to_string(expected));
}

/// Sums measure * axes * g and the measure of every part into rows chosen by `visit(part, add)`.
template <class Visit>
VectorSums sum_parts(const Discretization& d, const Vector& vectors, Index n_rows,
                     const Visit& visit) {
  require_gradient(d, vectors.size());
  if (d.frames.parts.empty() && d.n_samples() > 0)
    throw InvalidOption("the frames were not computed; ask for DiscretizationParts::Frames");
  VectorSums sum = VectorSums::Zero(n_rows, 4);
  Vector sharpened;
  if (d.is_one_form()) sharpened = d.one_forms.sharp * vectors;
  for (std::size_t k = 0; k < d.frames.parts.size(); ++k) {
    const GradientFrames::Part& part = d.frames.parts[k];
    const Eigen::Index first = d.first_row(part.sample);
    const Vec3 vector = d.is_one_form() ? Vec3(sharpened.segment<3>(3 * Eigen::Index{part.sample}))
                        : d.frames.axes.empty() ? Vec3(vectors.segment<3>(first))
                                                : d.frames.axes[k] * vectors.segment<2>(first);
    visit(part, [&](Index row) {
      sum.row(row).head<3>() += part.measure * vector.transpose();
      sum(row, 3) += part.measure;
    });
  }
  return sum;
}

/// Scales the first `length` of groups of `size` values to unit length, and clears the others.
/// \return flags of those without a length
std::vector<bool> normalise(Vector& values, Index size, Index length) {
  const Index n = static_cast<Index>(values.size()) / size;
  std::vector<bool> vanished(static_cast<std::size_t>(n), false);
  for (Index s = 0; s < n; ++s) {
    auto g = values.segment(Eigen::Index{size} * s, length);
    values.segment(Eigen::Index{size} * s + length, size - length).setZero();
    // Scaled before squaring, where the squares of small values would vanish.
    const double scale = g.lpNorm<Eigen::Infinity>();
    if (scale >= std::numeric_limits<double>::min()) {
      g /= scale;
      g.normalize();
    } else {
      g.setZero();
      vanished[static_cast<std::size_t>(s)] = true;
    }
  }
  return vanished;
}

}  // namespace

SparseMatrix Discretization::laplacian() const {
  if (stiffness_product)
    throw InvalidOption("the operator " + name +
                        " was asked for as a product and has no matrix: OperatorForm::Matrices");
  return -stiffness;
}

SparseMatrix Discretization::divergence() const {
  require_gradient(*this, gradient.rows());
  if (is_one_form()) {
    SparseMatrix weighted = one_forms.inner_product * gradient;
    weighted *= -1;
    return weighted.transpose();
  }
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
  if (is_one_form()) return gradient.transpose() * (one_forms.inner_product * -vectors);
  Vector weighted(vectors.size());
  for (Eigen::Index row = 0; row < vectors.size(); ++row)
    weighted[row] = -vectors[row] * sample_measure[row / gradient_dimension];
  return gradient.transpose() * weighted;
}

std::vector<bool> Discretization::normalise_samples(Vector& vectors) const {
  require_gradient(*this, vectors.size());
  if (!is_one_form())
    return normalise(vectors, gradient_dimension, gradient_dimension - jump_components);
  Vector sharpened = one_forms.sharp * vectors;
  std::vector<bool> vanished = normalise(sharpened, 3, 3);
  vectors = one_forms.flat * sharpened;
  return vanished;
}

Points means_of_sums(const VectorSums& sums) {
  Points means = sums.leftCols<3>();
  for (Index row = 0; row < means.rows(); ++row)
    if (sums(row, 3) > 0) means.row(row) /= sums(row, 3);
  return means;
}

Points directions_of_sums(const VectorSums& sums) {
  Points field = means_of_sums(sums);
  for (Index row = 0; row < field.rows(); ++row) {
    const double largest = field.row(row).lpNorm<Eigen::Infinity>();
    if (largest > 0) field.row(row) = (field.row(row) / largest).eval().normalized();
  }
  return field;
}

VectorSums Discretization::element_sums(const Vector& vectors, Index n_elements) const {
  return sum_parts(*this, vectors, n_elements,
                   [](const GradientFrames::Part& part, auto&& add) { add(part.element); });
}

Points Discretization::element_vectors(const Vector& vectors, Index n_elements) const {
  return means_of_sums(element_sums(vectors, n_elements));
}

std::string Discretization::lacks_element_directions() const {
  if (gradient_dimension == 0 || is_one_form()) return "its gradients are no vectors";
  if (frames.parts.empty() && n_samples() > 0) return "the frames were not computed";
  if (jump_components > 0 && !frames.axes.empty()) return "";
  for (std::size_t k = 1; k < frames.parts.size(); ++k)
    if (frames.parts[k].sample == frames.parts[k - 1].sample)
      return "its samples span several elements, and what jumps between these is not known";
  return "";
}

Vector Discretization::element_directions(const Vector& vectors) const {
  require_gradient(*this, vectors.size());
  if (const std::string reason = lacks_element_directions(); !reason.empty())
    throw InvalidOption("the operator " + name + " gives no directions of elements: " + reason);
  Index n_elements = 0;
  for (const GradientFrames::Part& part : frames.parts)
    n_elements = std::max(n_elements, part.element + 1);
  // Scaled first: the squares of small values would vanish in the means' lengths.
  const double scale = vectors.size() > 0 ? vectors.lpNorm<Eigen::Infinity>() : 0.0;
  return directions_of_field(
      directions_of_sums(element_sums(scale > 0 ? Vector(vectors / scale) : vectors, n_elements)));
}

Vector Discretization::directions_of_field(const Points& field) const {
  Vector result = Vector::Zero(first_row(n_samples()));
  const Index length = gradient_dimension - jump_components;
  for (std::size_t k = 0; k < frames.parts.size(); ++k) {
    const GradientFrames::Part& part = frames.parts[k];
    const Eigen::Index row = first_row(part.sample);
    const double share = part.measure / sample_measure[part.sample];
    const Vec3 x = field.row(part.element).transpose();
    if (frames.axes.empty())
      result.segment(row, length) += share * x;
    else
      result.segment(row, length) += share * (frames.axes[k].transpose() * x);
  }
  if (jump_components == 0) return result;
  // Parts of one sample follow each other, the left one first; across is the second axis.
  for (std::size_t k = 1; k < frames.parts.size(); ++k) {
    const GradientFrames::Part &left = frames.parts[k - 1], &right = frames.parts[k];
    if (left.sample != right.sample) continue;
    const auto across = [&](std::size_t part) {
      return frames.axes[part].col(1).dot(field.row(frames.parts[part].element).transpose());
    };
    const double whole = sample_measure[left.sample];
    result[first_row(left.sample) + length] = std::sqrt(left.measure * right.measure) / whole *
                                              (across(k - 1) - across(k)) / std::sqrt(jump_weight);
  }
  return result;
}

VectorSums Discretization::vertex_sums(const Vector& vectors) const {
  return sum_parts(*this, vectors, n_vertices(), [](const GradientFrames::Part& part, auto&& add) {
    for (const Index v : part.vertices)
      if (v >= 0) add(v);
  });
}

Points Discretization::vertex_vectors(const Vector& vectors) const {
  return means_of_sums(vertex_sums(vectors));
}

}  // namespace carat
