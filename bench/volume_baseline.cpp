#include "volume_baseline.h"

#include <Eigen/Dense>
#include <chrono>
#include <vector>

namespace carat::bench {
namespace {

using Plain = SparseMatrix::Plain;
using Triplet = Eigen::Triplet<double, Index>;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Weights of least norm with sum 1 that minimise |rows (x^T w) - rhs|^2: rows and rhs are those of
/// the normal equations of a point.
Vector least_norm_weights(const Matrix& x, const Eigen::Matrix3d& a, const Vec3& b) {
  const Eigen::Index n = x.rows();
  Matrix system(n + 1, n);
  Vector rhs(n + 1);
  system.topRows(n) = x * a * x.transpose();
  rhs.head(n) = x * b;
  system.row(n).setConstant(a.trace());
  rhs[n] = a.trace();
  return system.completeOrthogonalDecomposition().solve(rhs);
}

Vector face_weights(const Matrix& points) {
  const Eigen::Index n = points.rows();
  const Eigen::RowVector3d mean = points.colwise().mean();
  const Matrix x = points.rowwise() - mean;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 e = (x.row((i + 1) % n) - x.row(i)).transpose();
    const Eigen::Matrix3d q = e.squaredNorm() * Eigen::Matrix3d::Identity() - e * e.transpose();
    a += q;
    b += q * x.row(i).transpose();
  }
  return least_norm_weights(x, a, b);
}

}  // namespace

Baseline triplet_baseline(const PolyhedralMesh& mesh) {
  Baseline result;
  const Index n_v = mesh.n_vertices(), n_f = mesh.n_faces(), n_c = mesh.n_cells();
  const Csr& faces = mesh.face_mesh().faces();
  double start = now();
  std::vector<Triplet> to_faces, to_cells;
  for (Index v = 0; v < n_v; ++v) to_faces.emplace_back(v, v, 1.0);
  Points face_points(n_f, 3), cell_points(n_c, 3);
  for (Index f = 0; f < n_f; ++f) {
    Matrix x(faces.size(f), 3);
    for (Index i = 0; i < x.rows(); ++i) x.row(i) = mesh.points().row(mesh.face(f)[i]);
    const Vector w = face_weights(x);
    face_points.row(f) = w.transpose() * x;
    for (Index i = 0; i < x.rows(); ++i) to_faces.emplace_back(n_v + f, mesh.face(f)[i], w[i]);
  }
  for (Index r = 0; r < n_v + n_f; ++r) to_cells.emplace_back(r, r, 1.0);
  for (Index c = 0; c < n_c; ++c) {
    std::vector<Index> nodes(mesh.cell_vertices().row(c).begin(),
                             mesh.cell_vertices().row(c).end());
    Matrix x(static_cast<Eigen::Index>(nodes.size()) + mesh.cells().size(c), 3);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      x.row(static_cast<Eigen::Index>(i)) = mesh.points().row(nodes[i]);
    for (const Index f : mesh.cell(c)) {
      x.row(static_cast<Eigen::Index>(nodes.size())) = face_points.row(f);
      nodes.push_back(n_v + f);
    }
    const Eigen::RowVector3d mean = x.colwise().mean();
    const Matrix y = x.rowwise() - mean;
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Vec3 b = Vec3::Zero();
    for (const Index f : mesh.cell(c)) {
      const Vec3 xf = (face_points.row(f) - mean).transpose();
      const auto face = mesh.face(f);
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3 p = (mesh.points().row(face[i]) - mean).transpose();
        const Vec3 q = (mesh.points().row(face[(i + 1) % face.size()]) - mean).transpose();
        const Vec3 area = (q - p).cross(xf - p) / 2;
        a += area * area.transpose();
        b += area * area.dot(p);
      }
    }
    const Vector w = least_norm_weights(y, a, b);
    cell_points.row(c) = mean + w.transpose() * y;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      to_cells.emplace_back(n_v + n_f + c, nodes[i], w[static_cast<Eigen::Index>(i)]);
  }
  result.weights_seconds = now() - start;

  start = now();
  std::vector<Triplet> g, m_sample, m_hat;
  for (Index f = 0; f < n_f; ++f) {
    const FaceCells cells = mesh.face_cells()[f];
    const Vec3 xf = face_points.row(f).transpose();
    const auto tip = [&](Index c) { return c < 0 ? xf : Vec3(cell_points.row(c).transpose()); };
    const Vec3 d = tip(cells.above) - tip(cells.below);
    const bool inner = cells.below >= 0 && cells.above >= 0;
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
      const Index v1 = faces.indices[corner];
      const Index v2 = faces.indices[mesh.face_mesh().next_corner(f, corner)];
      const Vec3 p = mesh.point(v2) - mesh.point(v1), q = xf - mesh.point(v1);
      const Vec3 s = q.cross(d), t = d.cross(p), w = p.cross(q);
      const double det = w.dot(d), volume = det / 6;
      for (Index k = 0; k < 3; ++k) {
        const Index row = 3 * corner + k;
        g.emplace_back(row, v1, -(s[k] + t[k]) / det);
        g.emplace_back(row, v2, s[k] / det);
        g.emplace_back(row, n_v + f, t[k] / det);
        g.emplace_back(row, cells.above < 0 ? n_v + f : n_v + n_f + cells.above, w[k] / det);
        g.emplace_back(row, cells.below < 0 ? n_v + f : n_v + n_f + cells.below, -w[k] / det);
        m_sample.emplace_back(row, row, volume);
      }
      for (const Index node : {v1, v2, n_v + f})
        m_hat.emplace_back(node, node, volume / (inner ? 6 : 4));
      for (const Index c : {cells.below, cells.above})
        if (c >= 0) m_hat.emplace_back(n_v + n_f + c, n_v + n_f + c, volume / 4);
    }
  }
  const Index n_all = n_v + n_f + n_c, n_rows = 3 * mesh.face_mesh().n_corners();
  Plain face_prolongation(n_v + n_f, n_v), cell_prolongation(n_all, n_v + n_f),
      hat_gradient(n_rows, n_all), sample_mass(n_rows, n_rows), hat_mass(n_all, n_all);
  face_prolongation.setFromTriplets(to_faces.begin(), to_faces.end());
  cell_prolongation.setFromTriplets(to_cells.begin(), to_cells.end());
  hat_gradient.setFromTriplets(g.begin(), g.end());
  sample_mass.setFromTriplets(m_sample.begin(), m_sample.end());
  hat_mass.setFromTriplets(m_hat.begin(), m_hat.end());
  const Plain prolongation = cell_prolongation * face_prolongation;
  const Plain gradient = hat_gradient * prolongation;
  const Plain divergence = Plain(gradient.transpose()) * sample_mass;
  result.stiffness = divergence * gradient;
  result.mass = Plain(Plain(prolongation.transpose()) * hat_mass) * prolongation;
  result.assembly_seconds = now() - start;
  return result;
}

}  // namespace carat::bench
