// Linear virtual elements on polyhedra against their definition, cell by cell with dense matrices,
// and on cells that are folded, twisted, thin or empty.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "carat/prolongation/virtual_vertices.h"
#include "support/volume_measures.h"
#include "support/volume_meshes.h"

namespace carat::test {
namespace {

struct Dense {
  Matrix stiffness, mass, gradient;
};

/// S_K = |K| G^T K G + tr(K)/3 (I - Pi)^T Lambda (I - Pi), M_K = C^T H C + |K| (I - Pi)^T (I - Pi),
/// every factor a matrix over all vertices of the mesh.
Dense by_definition(const PolyhedralMesh& mesh, const Eigen::Matrix3d& tensor) {
  const Index n = mesh.n_vertices();
  Dense sum{Matrix::Zero(n, n), Matrix::Zero(n, n), Matrix::Zero(3 * mesh.n_cells(), n)};
  const VirtualVertices virtuals = virtual_vertices(mesh.face_mesh(), mesh.points(), {}, 1);
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    Vector one = Vector::Zero(n);  // of the cell's vertices
    for (const Index v : mesh.cell_vertices().row(c)) one[v] = 1;
    const double k = one.sum();
    const Vec3 mean = mesh.points().transpose() * one / k;
    const Matrix y = one.asDiagonal() * (mesh.points().rowwise() - mean.transpose());
    double volume = 0;
    Matrix g = Matrix::Zero(3, n);
    Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
    for (const Index f : mesh.cell(c)) {
      const auto face = mesh.face(f);
      const double sign = mesh.face_cells()[f].below == c ? 1 : -1;
      Vector weights = Vector::Zero(n);
      for (std::size_t i = 0; i < face.size(); ++i)
        weights[face[i]] +=
            virtuals.weights[static_cast<std::size_t>(mesh.face_mesh().faces().begin(f)) + i];
      const Vec3 centre = mesh.points().transpose() * weights - mean;
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Index a = face[i], b = face[(i + 1) % face.size()];
        const Vec3 p = mesh.point(a) - mean, q = mesh.point(b) - mean;
        const Vec3 area = sign / 2 * (p - centre).cross(q - centre);
        Vector values = weights;
        values[a] += 1;
        values[b] += 1;
        g += area * values.transpose() / 3;
        const double part = area.dot(centre) / 3;
        volume += part;
        // The integral of (1, y) (1, y)^T over a tetrahedron: its corners' sum twice, and each.
        Matrix corners(4, 4);
        corners << 1, 1, 1, 1, Vec3::Zero(), p, q, centre;
        h += part / 20 *
             (corners * corners.transpose() +
              corners.rowwise().sum() * corners.rowwise().sum().transpose());
      }
    }
    g /= volume;
    double diameter = 0;
    for (const Index a : mesh.cell_vertices().row(c))
      for (const Index b : mesh.cell_vertices().row(c))
        diameter = std::max(diameter, (mesh.point(a) - mesh.point(b)).norm());
    const Matrix away = Matrix(one.asDiagonal()) - one * one.transpose() / k - y * g;
    const Vector lambda =
        (volume * g.colwise().squaredNorm().transpose()).cwiseMax(diameter) * (tensor.trace() / 3);
    Matrix coefficients(4, n);
    coefficients << one.transpose() / k, g;
    sum.stiffness +=
        volume * g.transpose() * tensor * g + away.transpose() * lambda.asDiagonal() * away;
    sum.mass += coefficients.transpose() * h * coefficients + volume * away.transpose() * away;
    sum.gradient.middleRows(3 * c, 3) = g;
  }
  return sum;
}

PolyhedralMesh generated(const char* family) {
  return generate_volume(family, {.level = 0, .jitter = 0.2});
}

std::vector<NamedVolume> meshes() {
  std::vector<NamedVolume> list{{"twisted", twisted_hexes()}, {"prism", prism_over_polygon(7)}};
  for (const char* family : {"cube-hexahedra", "cube-pyramids", "cube-truncated", "ball-voronoi"})
    list.push_back({family, generated(family)});
  return list;
}

TEST(VemVolume, is_its_definition) {
  Eigen::Matrix3d tensor;
  tensor << 2, 0.5, 0.1, 0.5, 1, -0.2, 0.1, -0.2, 0.7;
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    for (const bool isotropic : {true, false}) {
      DiscretizationOptions options;
      if (!isotropic) {
        Eigen::RowVectorXd row(6);
        row << 2, 1, 0.7, 0.5, -0.2, 0.1;  // xx yy zz xy yz xz
        options.cell_coefficient = row.replicate(mesh.n_cells(), 1);
      }
      const Discretization d = discretize(mesh, "vem", options);
      const Dense expected =
          by_definition(mesh, isotropic ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : tensor);
      const auto near = [](const SparseMatrix& a, const Matrix& b) {
        return (Matrix(a) - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
      };
      EXPECT_LT(near(d.stiffness, expected.stiffness), 1e-12);
      EXPECT_LT(near(d.mass, expected.mass), 1e-12);
      EXPECT_LT(near(d.gradient, expected.gradient), 1e-12);
    }
  }
}

TEST(VemVolume, equals_primal_on_tetrahedra) {
  const PolyhedralMesh mesh = generated("ball-tets");
  EXPECT_LT(difference(discretize(mesh, "vem").stiffness, discretize(mesh, "primal_tet").stiffness),
            1e-11);
}

TEST(VemVolume, masses_are_positive_and_sum_to_the_volume) {
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    for (const MassKind mass : {MassKind::Full, MassKind::Lumped}) {
      const Discretization d = discretize(mesh, "vem", {.mass = mass});
      EXPECT_NEAR(Matrix(d.mass).sum(), d.sample_measure.sum(), 1e-13 * d.sample_measure.sum());
      if (mass == MassKind::Full) {
        EXPECT_GT(relative_eigenvalues(d.mass)[0], 1e-3);
      }
    }
  }
}

TEST(VemVolume, thin_cells_stay_semidefinite_in_any_direction) {
  for (const double aspect : {1e-4, 1e-6, 1e-8})
    for (const bool plate : {true, false}) {
      const PolyhedralMesh prism = prism_over_polygon(5);
      Points points = prism.points();
      points.col(2) *= plate ? aspect : 1;
      points.col(0) *= plate ? 1 : aspect;
      const PolyhedralMesh straight = prism.with_points(points);
      const PolyhedralMesh mesh = move_rigidly(straight);
      SCOPED_TRACE((plate ? "plate " : "sheet ") + std::to_string(aspect));
      const Discretization d = discretize(mesh, "vem");
      ASSERT_TRUE(all_finite(d.stiffness) && all_finite(d.mass) && all_finite(d.gradient));
      EXPECT_EQ(d.diagnostics.count("excluded_samples"), 0);
      EXPECT_LT(row_sum_defect(d.stiffness), 1000 * kEps);
      EXPECT_GT(relative_eigenvalues(d.stiffness)[0], -1000 * kEps);
      // Moving the points has rounded them, by kEps beside a height of `aspect`.
      EXPECT_LT(difference(d.stiffness, discretize(straight, "vem").stiffness),
                1000 * kEps / aspect);
    }
}

TEST(VemVolume, cells_without_a_positive_volume_are_left_out_and_named) {
  const PolyhedralMesh prism = prism_over_polygon(6);
  Points flat = prism.points();
  flat.col(2).setZero();
  Points mirrored = prism.points();
  mirrored.col(2) *= -1;
  for (const Points& points : {flat, mirrored}) {
    const PolyhedralMesh mesh = prism.with_points(points);
    const Discretization d = discretize(mesh, "vem", {.parts = DiscretizationParts::Frames});
    EXPECT_EQ(d.diagnostics.count("excluded_samples"), 1);
    EXPECT_EQ(max_abs(d.stiffness), 0);
    EXPECT_EQ(max_abs(d.gradient), 0);
    try {
      discretize(mesh, "vem", {.degenerate = DegeneratePolicy::Strict});
      ADD_FAILURE() << "nothing was thrown";
    } catch (const DegenerateElement& e) {
      EXPECT_NE(std::string(e.what()).find("cell 0"), std::string::npos) << e.what();
    }
  }
  const Discretization folded = discretize(folded_hexes(), "vem");
  EXPECT_TRUE(all_finite(folded.stiffness) && all_finite(folded.mass));
  EXPECT_LT(row_sum_defect(folded.stiffness), 1e-12);
  EXPECT_GT(relative_eigenvalues(folded.stiffness)[0], -1e-13);
}

}  // namespace
}  // namespace carat::test
