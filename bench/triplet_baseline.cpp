#include "triplet_baseline.h"

#include <Eigen/Dense>
#include <chrono>
#include <vector>

#include "carat/kernels/diamond_2d.h"

namespace carat::bench {
namespace {

using Plain = SparseMatrix::Plain;
using Triplet = Eigen::Triplet<double, Index>;

/// Minimum-norm affine weights of the point of least squared triangle areas, as an (n+1) x n
/// least-squares problem in the weights.
Vector area_minimizer_weights(const Matrix& x) {
  const Eigen::Index n = x.rows();
  const Eigen::RowVector3d mean = x.colwise().mean();
  const Matrix y = x.rowwise() - mean;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 e = (y.row((i + 1) % n) - y.row(i)).transpose();
    const Eigen::Matrix3d q = e.squaredNorm() * Eigen::Matrix3d::Identity() - e * e.transpose();
    a += q;
    b += q * y.row(i).transpose();
  }
  Matrix system(n + 1, n);
  Vector rhs(n + 1);
  system.topRows(n) = y * a * y.transpose();
  rhs.head(n) = y * b;
  system.row(n).setConstant(a.trace());
  rhs[n] = a.trace();
  return system.completeOrthogonalDecomposition().solve(rhs);
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Baseline triplet_baseline(const PolygonMesh& mesh) {
  Baseline result;
  const Index n_v = mesh.n_vertices(), n_f = mesh.n_faces();
  double start = now();
  std::vector<double> weights;
  Points face_points(n_f, 3);
  for (Index f = 0; f < n_f; ++f) {
    Matrix x(mesh.faces().size(f), 3);
    for (Index i = 0; i < x.rows(); ++i) x.row(i) = mesh.points().row(mesh.face(f)[i]);
    const Vector w = area_minimizer_weights(x);
    weights.insert(weights.end(), w.data(), w.data() + w.size());
    face_points.row(f) = w.transpose() * x;
  }
  result.weights_seconds = now() - start;

  start = now();
  std::vector<Triplet> p, g, m_sample, m_hat;
  for (Index v = 0; v < n_v; ++v) p.emplace_back(v, v, 1.0);
  for (Index f = 0; f < n_f; ++f)
    for (Index c = mesh.faces().begin(f); c < mesh.faces().end(f); ++c)
      p.emplace_back(n_v + f, mesh.faces().indices[c], weights[c]);
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e) {
    const auto [v1, v2] = edges.vertices[e];
    const Vec3 x1 = mesh.point(v1), x2 = mesh.point(v2);
    Index faces[2] = {-1, -1};
    for (const Index c : edges.corners.row(e))
      faces[mesh.faces().indices[c] == v1 ? 0 : 1] = mesh.corner_faces()[c];
    const Vec3 mid = (x1 + x2) / 2;
    const Vec3 xl = faces[0] < 0 ? mid : Vec3(face_points.row(faces[0]).transpose());
    const Vec3 xr = faces[1] < 0 ? mid : Vec3(face_points.row(faces[1]).transpose());
    const Eigen::Matrix<double, 2, 4> gradient = diamond_gradient(x1, x2, xl, xr);
    const double area = ((x2 - x1).cross(xl - x1).norm() + (x2 - x1).cross(xr - x1).norm()) / 2;
    const double share = area / (faces[0] < 0 || faces[1] < 0 ? 3 : 4);
    for (Index k = 0; k < 2; ++k) {
      const Index row = 2 * e + k;
      g.emplace_back(row, v1, gradient(k, 0));
      g.emplace_back(row, v2, gradient(k, 1));
      for (Index side = 0; side < 2; ++side) {
        if (faces[side] >= 0) {
          g.emplace_back(row, n_v + faces[side], gradient(k, 2 + side));
        } else {
          g.emplace_back(row, v1, gradient(k, 2 + side) / 2);
          g.emplace_back(row, v2, gradient(k, 2 + side) / 2);
        }
      }
      m_sample.emplace_back(row, row, area);
    }
    for (const Index v : {v1, v2}) m_hat.emplace_back(v, v, share);
    for (const Index f : faces)
      if (f >= 0) m_hat.emplace_back(n_v + f, n_v + f, share);
  }
  const Index n_all = n_v + n_f, n_rows = 2 * edges.size();
  Plain prolongation(n_all, n_v), hat_gradient(n_rows, n_all), sample_mass(n_rows, n_rows),
      hat_mass(n_all, n_all);
  prolongation.setFromTriplets(p.begin(), p.end());
  hat_gradient.setFromTriplets(g.begin(), g.end());
  sample_mass.setFromTriplets(m_sample.begin(), m_sample.end());
  hat_mass.setFromTriplets(m_hat.begin(), m_hat.end());
  const Plain gradient = hat_gradient * prolongation;
  const Plain divergence = Plain(gradient.transpose()) * sample_mass;
  result.stiffness = divergence * gradient;
  result.mass = Plain(Plain(prolongation.transpose()) * hat_mass) * prolongation;
  result.assembly_seconds = now() - start;
  return result;
}

}  // namespace carat::bench
