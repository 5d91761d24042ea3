#pragma once
// The diamond Laplacian written out slowly with dense matrices, step by step as in the paper, with
// switches that break one step each. Manifold meshes only.

#include <Eigen/Dense>
#include <cmath>

#include "carat/mesh/polygon_mesh.h"

namespace carat::test {

enum class Mutation {
  None,
  TipsSwapped,          ///< u_r - u_l for u_l - u_r in the second difference
  BoundaryDropped,      ///< boundary diamonds contribute nothing
  HingeProjected,       ///< the right tip projected onto the left plane, not unfolded
  WeightsNotAffine,     ///< the weights of a face sum to 1.01
  BoundaryMassQuarter,  ///< a boundary diamond gives a quarter to each of its three vertices
};

struct DenseDiamond {
  Matrix prolongation, gradient, divergence, stiffness, mass;
  Vector measure;
};

/// min sum |a_i|^2 over the area vectors of (x_i, x_{i+1}, x), each linear in x.
inline Vec3 dense_face_point(const Matrix& x) {
  const Eigen::Index n = x.rows();
  Matrix a(3 * n, 3);
  Vector b(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 p = x.row(i).transpose();
    const Vec3 e = x.row((i + 1) % n).transpose() - p;
    a.middleRows(3 * i, 3) << 0, -e.z(), e.y(), e.z(), 0, -e.x(), -e.y(), e.x(), 0;
    b.segment(3 * i, 3) = e.cross(p);
  }
  return a.colPivHouseholderQr().solve(b);
}

/// Minimum-norm weights with sum 1 that reproduce the face point in the plane of the vector area.
inline Vector dense_face_weights(const Matrix& x) {
  const Eigen::Index n = x.rows();
  const Matrix centred = x.rowwise() - x.colwise().mean();
  Vec3 area = Vec3::Zero();
  for (Eigen::Index i = 0; i < n; ++i)
    area += Vec3(centred.row(i).transpose()).cross(Vec3(centred.row((i + 1) % n).transpose()));
  const Vec3 normal = area.normalized();
  const Vec3 axis_s = normal.unitOrthogonal(), axis_t = normal.cross(axis_s);
  const Vec3 point = dense_face_point(centred);
  Matrix constraints(3, n);
  constraints.row(0).setOnes();
  constraints.row(1) = (centred * axis_s).transpose();
  constraints.row(2) = (centred * axis_t).transpose();
  const Vector target = Vec3(1, axis_s.dot(point), axis_t.dot(point));
  return constraints.completeOrthogonalDecomposition().solve(target);
}

inline DenseDiamond dense_diamond(const PolygonMesh& mesh, Mutation mutation = Mutation::None) {
  const Index nv = mesh.n_vertices(), nf = mesh.n_faces(), ne = mesh.n_edges();
  DenseDiamond out;
  out.prolongation = Matrix::Zero(nv + nf, nv);  // (17)
  out.prolongation.topRows(nv).setIdentity();
  for (Index f = 0; f < nf; ++f) {
    const auto face = mesh.face(f);
    Matrix x(static_cast<Eigen::Index>(face.size()), 3);
    for (std::size_t i = 0; i < face.size(); ++i)
      x.row(static_cast<Eigen::Index>(i)) = mesh.points().row(face[i]);
    Vector weights = dense_face_weights(x);
    if (mutation == Mutation::WeightsNotAffine) weights *= 1.01;
    for (std::size_t i = 0; i < face.size(); ++i)
      out.prolongation(nv + f, face[i]) += weights[static_cast<Eigen::Index>(i)];
  }
  const Matrix all = out.prolongation * mesh.points();

  Matrix unsandwiched = Matrix::Zero(2 * ne, nv + nf);  // (14)
  Vector lumped = Vector::Zero(nv + nf);                // (23)
  out.measure = Vector::Zero(ne);
  for (Index e = 0; e < ne; ++e) {
    const auto [i1, i2] = mesh.edges().vertices[e];
    Index left = -1, right = -1;
    for (const Index c : mesh.edges().corners.row(e)) {
      Index& side = mesh.faces().indices[c] == i1 ? left : right;
      side = nv + mesh.corner_faces()[c];
    }
    const Vec3 x1 = all.row(i1).transpose(), x2 = all.row(i2).transpose();
    const auto tip = [&](Index row) -> Vec3 {
      return row < 0 ? Vec3((x1 + x2) / 2) : Vec3(all.row(row).transpose());
    };
    // (10)-(12)
    const Vec3 u = (x2 - x1).normalized();
    const auto above = [&](const Vec3& x) -> Vec3 { return x - x1 - u * u.dot(x - x1); };
    const Vec3 xl = tip(left), xr = tip(right);
    Vec2 p[4] = {{0, 0},
                 {u.dot(xr - x1), -above(xr).norm()},
                 {(x2 - x1).norm(), 0},
                 {u.dot(xl - x1), above(xl).norm()}};
    double area2 = 0;
    for (int k = 0; k < 4; ++k)
      area2 += p[k].x() * p[(k + 1) % 4].y() - p[k].y() * p[(k + 1) % 4].x();
    const double area = area2 / 2;
    const bool boundary = left < 0 || right < 0;
    if (boundary && mutation == Mutation::BoundaryDropped) continue;
    if (!boundary && mutation == Mutation::HingeProjected)
      p[1].y() = above(xr).dot(above(xl).normalized());
    // (13): each column from the two diamond edges at that vertex, order 1, r, 2, l.
    double used2 = 0;
    for (int k = 0; k < 4; ++k)
      used2 += p[k].x() * p[(k + 1) % 4].y() - p[k].y() * p[(k + 1) % 4].x();
    Eigen::Matrix<double, 2, 4> g;
    for (int k = 0; k < 4; ++k) {
      const Vec2 around = p[(k + 1) % 4] - p[(k + 3) % 4];
      g.col(k) = Vec2(around.y(), -around.x()) / used2;
    }
    if (mutation == Mutation::TipsSwapped) g.col(1).swap(g.col(3));
    out.measure[e] = area;
    const double share = area / (boundary && mutation != Mutation::BoundaryMassQuarter ? 3 : 4);
    const auto scatter = [&](Index row, int column) {
      if (row >= 0) {
        unsandwiched.block(2 * e, row, 2, 1) += g.col(column);
        lumped[row] += share;
      } else {
        unsandwiched.block(2 * e, i1, 2, 1) += g.col(column) / 2;
        unsandwiched.block(2 * e, i2, 2, 1) += g.col(column) / 2;
      }
    };
    scatter(i1, 0);
    scatter(right, 1);
    scatter(i2, 2);
    scatter(left, 3);
  }
  Vector twice(2 * ne);
  for (Index e = 0; e < ne; ++e) twice[2 * e] = twice[2 * e + 1] = out.measure[e];
  out.gradient = unsandwiched * out.prolongation;                                    // (18)
  out.divergence = -out.gradient.transpose() * twice.asDiagonal();                   // (20)
  out.stiffness = -out.divergence * out.gradient;                                    // (21)
  out.mass = out.prolongation.transpose() * lumped.asDiagonal() * out.prolongation;  // (22)
  return out;
}

}  // namespace carat::test
