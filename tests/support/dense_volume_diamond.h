#pragma once
// The diamond Laplacian of volumes written out slowly with dense matrices, step by step as in the
// paper's section 6, with switches that break one step each. Cells that contain their virtual
// vertex only.

#include "carat/mesh/polyhedral_mesh.h"
#include "support/dense_diamond.h"

namespace carat::test {

enum class VolumeMutation {
  None,
  TipsSwapped,           ///< u_r and u_l change places
  BoundaryDropped,       ///< boundary diamonds contribute nothing
  WeightsNotAffine,      ///< the weights of a cell sum to 1.01
  BoundaryMassLiteral,   ///< (33) to the letter: boundary diamonds lose the missing tip's quarter
  LastWeightEliminated,  ///< least norm of all weights of a cell but the last
  OneDiamondAFace,       ///< a single gradient over the whole ring of minimal diamonds
};

/// Cell point and weights over [vertices, then face points] of a cell, in this order.
struct DenseCell {
  Vec3 point;
  Vector weights;
};

/// \param x      vertices and face points of the cell
/// \param sides  triangles of its virtual boundary
inline DenseCell dense_cell(const Matrix& x, const std::vector<Eigen::Matrix3d>& sides,
                            VolumeMutation mutation) {
  // (29): every volume a . (p - x_c) / 3 is linear in x_c.
  const Vec3 mean = x.colwise().mean().transpose();
  Matrix a(static_cast<Eigen::Index>(sides.size()), 3);
  Vector b(a.rows());
  for (std::size_t t = 0; t < sides.size(); ++t) {
    const Eigen::Matrix3d& s = sides[t];  // columns
    const Vec3 area = (s.col(1) - s.col(0)).cross(s.col(2) - s.col(0)) / 2;
    a.row(static_cast<Eigen::Index>(t)) = area.transpose();
    b[static_cast<Eigen::Index>(t)] = area.dot(s.col(0) - mean);
  }
  const Vec3 offset = a.colPivHouseholderQr().solve(b);
  // Sum 1 and the point itself, in the least-norm sense.
  const Eigen::Index m = x.rows();
  Matrix constraints(4, m);
  constraints.row(0).setOnes();
  constraints.bottomRows(3) = (x.rowwise() - mean.transpose()).transpose();
  Eigen::Vector4d target;
  target << 1, offset;
  DenseCell cell{mean + offset, Vector(m)};
  if (mutation == VolumeMutation::LastWeightEliminated) {
    const Eigen::Vector4d last = constraints.col(m - 1);
    const Matrix rest = constraints.leftCols(m - 1).colwise() - last;
    cell.weights.head(m - 1) =
        rest.bottomRows(3).completeOrthogonalDecomposition().solve((target - last).tail<3>());
    cell.weights[m - 1] = 1 - cell.weights.head(m - 1).sum();
  } else {
    cell.weights = constraints.completeOrthogonalDecomposition().solve(target);
  }
  if (mutation == VolumeMutation::WeightsNotAffine) cell.weights *= 1.01;
  return cell;
}

/// P of (30), and with it all positions.
inline Matrix dense_prolongation(const PolyhedralMesh& mesh, VolumeMutation mutation) {
  const Index nv = mesh.n_vertices(), nf = mesh.n_faces(), nc = mesh.n_cells();
  Matrix p = Matrix::Zero(nv + nf + nc, nv);
  p.topRows(nv).setIdentity();
  for (Index f = 0; f < nf; ++f) {
    const auto face = mesh.face(f);
    Matrix x(static_cast<Eigen::Index>(face.size()), 3);
    for (std::size_t i = 0; i < face.size(); ++i)
      x.row(static_cast<Eigen::Index>(i)) = mesh.points().row(face[i]);
    const Vector weights = dense_face_weights(x);
    for (std::size_t i = 0; i < face.size(); ++i)
      p(nv + f, face[i]) += weights[static_cast<Eigen::Index>(i)];
  }
  for (Index c = 0; c < nc; ++c) {
    std::vector<Index> rows;
    for (const Index f : mesh.cell(c))
      for (const Index v : mesh.face(f))
        if (std::find(rows.begin(), rows.end(), v) == rows.end()) rows.push_back(v);
    for (const Index f : mesh.cell(c)) rows.push_back(nv + f);
    Matrix x(static_cast<Eigen::Index>(rows.size()), 3);
    for (std::size_t k = 0; k < rows.size(); ++k)
      x.row(static_cast<Eigen::Index>(k)) = p.row(rows[k]) * mesh.points();
    std::vector<Eigen::Matrix3d> sides;
    for (const Index f : mesh.cell(c)) {
      const auto face = mesh.face(f);
      for (std::size_t i = 0; i < face.size(); ++i) {
        sides.emplace_back();
        sides.back() << mesh.point(face[i]), mesh.point(face[(i + 1) % face.size()]),
            (p.row(nv + f) * mesh.points()).transpose();
      }
    }
    const DenseCell cell = dense_cell(x, sides, mutation);
    for (std::size_t k = 0; k < rows.size(); ++k)
      p.row(nv + nf + c) += cell.weights[static_cast<Eigen::Index>(k)] * p.row(rows[k]);
  }
  return p;
}

/// Adds the surface integral (24) of one outward triangle to the rows' columns.
inline void add_triangle(Matrix& integral, const Matrix& x, Index i, Index j, Index k) {
  const Vec3 xi = x.row(i).transpose(), xj = x.row(j).transpose(), xk = x.row(k).transpose();
  const Vec3 area = (xj - xi).cross(xk - xi) / 2;  // (25)
  for (const Index v : {i, j, k}) integral.col(v) += area / 3;
}

inline DenseDiamond dense_volume_diamond(const PolyhedralMesh& mesh,
                                         VolumeMutation mutation = VolumeMutation::None) {
  const Index nv = mesh.n_vertices(), nf = mesh.n_faces();
  const Csr& faces = mesh.face_mesh().faces();
  const Index n_diamonds = static_cast<Index>(faces.indices.size());
  DenseDiamond out;
  out.prolongation = dense_prolongation(mesh, mutation);
  const Matrix x = out.prolongation * mesh.points();
  const Index n = static_cast<Index>(x.rows());
  Matrix unsandwiched = Matrix::Zero(3 * n_diamonds, n);
  Vector lumped = Vector::Zero(n);
  out.measure = Vector::Zero(n_diamonds);
  for (Index f = 0; f < nf; ++f) {
    const FaceCells cells = mesh.face_cells()[f];
    const bool boundary = cells.boundary();
    if (boundary && mutation == VolumeMutation::BoundaryDropped) continue;
    const Index l = cells.below < 0 ? -1 : nv + nf + cells.below;
    const Index r = cells.above < 0 ? -1 : nv + nf + cells.above;
    const Index vf = nv + f;
    Matrix ring = Matrix::Zero(3, n);
    double ring_volume = 0;
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
      const Index v1 = faces.indices[corner];
      const Index v2 = faces.indices[corner + 1 == faces.end(f) ? faces.begin(f) : corner + 1];
      Matrix integral = Matrix::Zero(3, n);
      if (l >= 0) {
        add_triangle(integral, x, v2, v1, l);
        add_triangle(integral, x, vf, v2, l);
        add_triangle(integral, x, v1, vf, l);
      } else {
        add_triangle(integral, x, v2, v1, vf);
      }
      if (r >= 0) {
        add_triangle(integral, x, v1, v2, r);
        add_triangle(integral, x, v2, vf, r);
        add_triangle(integral, x, vf, v1, r);
      } else {
        add_triangle(integral, x, v1, v2, vf);
      }
      // The integral of the gradient of the coordinates is |D| times the identity.
      const double volume = (integral * x).trace() / 3;
      ring += integral;
      ring_volume += volume;
      if (mutation == VolumeMutation::TipsSwapped && !boundary)
        integral.col(l).swap(integral.col(r));
      out.measure[corner] = volume;
      unsandwiched.middleRows(3 * corner, 3) = integral / volume;  // (27)
      const bool quarter = boundary && mutation != VolumeMutation::BoundaryMassLiteral;
      for (const Index v : {v1, v2, vf}) lumped[v] += volume / (quarter ? 4 : 6);  // (33)
      for (const Index v : {l, r})
        if (v >= 0) lumped[v] += volume / 4;
    }
    if (mutation == VolumeMutation::OneDiamondAFace)
      for (Index corner = faces.begin(f); corner < faces.end(f); ++corner)
        unsandwiched.middleRows(3 * corner, 3) = ring / ring_volume;
  }
  Vector thrice(3 * n_diamonds);
  for (Index row = 0; row < thrice.size(); ++row) thrice[row] = out.measure[row / 3];
  out.gradient = unsandwiched * out.prolongation;                    // (31)
  out.divergence = -out.gradient.transpose() * thrice.asDiagonal();  // (32)
  out.stiffness = -out.divergence * out.gradient;
  out.mass = out.prolongation.transpose() * lumped.asDiagonal() * out.prolongation;
  return out;
}

}  // namespace carat::test
