#pragma once
// Claims as numbers: each function measures by how much a property is missed, relative to the
// natural size of what it is made of. Tests of operators and of deliberately wrong operators share
// them.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "carat/mesh/polygon_mesh.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/discretization.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat::measures {

inline constexpr double kEps = std::numeric_limits<double>::epsilon();

inline double max_abs(const SparseMatrix& a) {
  double largest = 0;
  for (Index row = 0; row < a.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(a, row); entry; ++entry)
      largest = std::max(largest, std::abs(entry.value()));
  return largest;
}

inline bool all_finite(const SparseMatrix& a) {
  return Eigen::Map<const Vector>(a.valuePtr(), a.nonZeros()).allFinite();
}

/// max |A - B| / max |B|.
inline double difference(const SparseMatrix& a, const SparseMatrix& b) {
  const SparseMatrix d = a - b;
  if (!all_finite(d)) return std::numeric_limits<double>::infinity();
  return max_abs(d) / std::max(max_abs(b), std::numeric_limits<double>::min());
}

/// max |A - A^T| / max |A|.
inline double asymmetry(const SparseMatrix& a) {
  return difference(SparseMatrix(a.transpose()), a);
}

/// Largest |row sum| over the row's absolute sum: 0 if A 1 = 0.
inline double row_sum_defect(const SparseMatrix& a) {
  double worst = 0;
  for (Index row = 0; row < a.rows(); ++row) {
    double sum = 0, total = 0;
    for (SparseMatrix::InnerIterator entry(a, row); entry; ++entry) {
      sum += entry.value();
      total += std::abs(entry.value());
    }
    if (total > 0) worst = std::max(worst, std::abs(sum) / total);
  }
  return worst;
}

/// Eigenvalues of a symmetric matrix, ascending, over the largest absolute one.
inline Vector relative_eigenvalues(const SparseMatrix& a) {
  const Vector values =
      Eigen::SelfAdjointEigenSolver<Matrix>(Matrix(a), Eigen::EigenvaluesOnly).eigenvalues();
  return values / std::max(std::abs(values[0]), std::abs(values[values.size() - 1]));
}

/// max over the chosen rows of |sum_j S_ij (x_j - x_i)| / sum_j |S_ij| |x_j - x_i|: 0 where S
/// annihilates the coordinates.
inline double linear_precision_defect(const SparseMatrix& s, const Points& points,
                                      const std::vector<bool>& rows) {
  double worst = 0;
  for (Index row = 0; row < s.rows(); ++row) {
    if (!rows[static_cast<std::size_t>(row)]) continue;
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (SparseMatrix::InnerIterator entry(s, row); entry; ++entry) {
      const Vec3 d = (points.row(entry.col()) - points.row(row)).transpose();
      sum += entry.value() * d;
      total += std::abs(entry.value()) * d.norm();
    }
    if (total > 0) worst = std::max(worst, sum.norm() / total);
  }
  return worst;
}

/// |sum M - area| / area.
inline double mass_defect(const SparseMatrix& mass, double area) {
  return std::abs(mass.sum() - area) / area;
}

/// max |L - D G| / max |L|.
inline double factorisation_defect(const SparseMatrix& stiffness, const SparseMatrix& divergence,
                                   const SparseMatrix& gradient) {
  const SparseMatrix dg = divergence * gradient;
  return difference(dg, SparseMatrix(-stiffness));
}

/// max |D + G^T M_s| / max |D|, M_s assembled here.
inline double adjointness_defect(const SparseMatrix& divergence, const SparseMatrix& gradient,
                                 const Vector& sample_measure, Index dimension) {
  Vector measure(gradient.rows());
  for (Index row = 0; row < measure.size(); ++row) measure[row] = sample_measure[row / dimension];
  const SparseMatrix expected = -SparseMatrix(gradient.transpose()) * measure.asDiagonal();
  return difference(divergence, expected);
}

/// The same; for one-forms by their inner product.
inline double adjointness_defect(const Discretization& d, const SparseMatrix& divergence) {
  if (!d.is_one_form())
    return adjointness_defect(divergence, d.gradient, d.sample_measure, d.gradient_dimension);
  return difference(
      divergence, SparseMatrix(-SparseMatrix(d.gradient.transpose()) * d.one_forms.inner_product));
}

/// Largest deviation of the tangential gradient of u = c . x from c's projection on the frame of
/// each part, over |c|: the gradient is exact on linear functions of planar meshes, and has no
/// jumps.
inline double gradient_defect(const Discretization& d, const Points& points, const Vec3& c) {
  const Vector u = (points.rowwise() - points.row(0)) * c;
  const Vector g = d.gradient * u;
  double worst = 0;
  const Index length = d.gradient_dimension - d.jump_components;
  for (std::size_t i = 0; i < d.frames.parts.size(); ++i)
    for (Index k = 0; k < d.gradient_dimension; ++k) {
      const double expected = k >= length             ? 0.0
                              : d.frames.axes.empty() ? c[k]
                                                      : d.frames.axes[i].col(k).dot(c);
      worst = std::max(worst,
                       std::abs(g[d.frames.parts[i].sample * d.gradient_dimension + k] - expected));
    }
  return worst / c.norm();
}

/// Area of the virtual refinement, summed over triangles (x_i, x_{i+1}, x_f) in space.
inline double refinement_area(const PolygonMesh& mesh, const VirtualVertexRule& rule = {}) {
  const VirtualVertices virtuals = virtual_vertices(mesh, mesh.points(), rule);
  const Points centres = face_points(mesh, mesh.points(), virtuals.weights);
  double area = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 p = mesh.point(face[i]), q = mesh.point(face[(i + 1) % face.size()]);
      area += (q - p).cross(Vec3(centres.row(f).transpose()) - p).norm() / 2;
    }
  }
  return area;
}

/// Sum of the lengths of the faces' vector areas.
inline double total_vector_area(const PolygonMesh& mesh) {
  double area = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
      sum += (mesh.point(face[i]) - mesh.point(face[0]))
                 .cross(mesh.point(face[i + 1]) - mesh.point(face[0]));
    area += sum.norm() / 2;
  }
  return area;
}

/// Squared size over twice the area of the worst virtual triangle: by this factor the entries of a
/// stiffness magnify rounding of the coordinates.
inline double condition(const PolygonMesh& mesh, const VirtualVertexRule& rule = {}) {
  const VirtualVertices virtuals = virtual_vertices(mesh, mesh.points(), rule);
  double worst = 1;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    for (Index c = mesh.faces().begin(f); c < mesh.faces().end(f); ++c) {
      const VirtualTriangle t = virtuals.triangles[c];
      const double length2 = (mesh.point(mesh.faces().indices[mesh.next_corner(f, c)]) -
                              mesh.point(mesh.faces().indices[c]))
                                 .squaredNorm();
      const double tip2 = t.foot * t.foot * length2 + t.double_area * t.double_area / length2;
      if (t.double_area > 0) worst = std::max(worst, std::max(length2, tip2) / t.double_area);
    }
  return worst;
}

inline std::vector<bool> inner_vertices(const PolygonMesh& mesh) {
  std::vector<bool> flags = boundary_vertices(mesh);
  flags.flip();
  return flags;
}

/// Bitwise equality of patterns and values.
inline bool same_bits(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.rows() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

/// Least-squares slope of log(error) against log(h).
inline double log_slope(const std::vector<double>& h, const std::vector<double>& error) {
  const double n = static_cast<double>(h.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double x = std::log(h[k]), y = std::log(error[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace carat::measures
