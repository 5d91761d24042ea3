#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "carat/prolongation/virtual_vertices.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

struct FacePoint {
  std::vector<double> weights;
  std::vector<VirtualTriangle> triangles;
  VirtualVertexStatus status;
  Vec3 point;
};

FacePoint face_point(const PolygonMesh& mesh, VirtualVertexRule rule = {}) {
  FacePoint out;
  out.weights.resize(mesh.face(0).size());
  out.triangles.resize(mesh.face(0).size());
  VirtualVertexKernel kernel(rule);
  out.status =
      kernel.compute(mesh.points(), mesh.face(0), out.weights.data(), out.triangles.data());
  out.point = kernel.point();
  return out;
}

double squared_areas(const PolygonMesh& mesh, const Vec3& x) {
  const auto face = mesh.face(0);
  double sum = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 p = mesh.point(face[i]), q = mesh.point(face[(i + 1) % face.size()]);
    sum += (q - p).cross(x - p).squaredNorm() / 4;
  }
  return sum;
}

PolygonMesh skew_pentagon() {
  return make_mesh({{0, 0, 0.1}, {2, 0, -0.2}, {2.5, 1.2, 0.3}, {1, 2, 0}, {-0.3, 1, 0.2}},
                   {{0, 1, 2, 3, 4}});
}

TEST(VirtualVertexKernel, triangles_have_equal_weights) {
  const FacePoint p = face_point(single_triangle());
  for (const double weight : p.weights) EXPECT_EQ(weight, 1.0 / 3);
  EXPECT_EQ(p.status, VirtualVertexStatus::Regular);
  EXPECT_LT((p.point - Vec3(2.5 / 3, 1.0 / 3, 0)).norm(), 4 * kEps);
}

TEST(VirtualVertexKernel, regular_polygons_have_equal_weights_for_every_rule) {
  for (const Index n : {4, 5, 6, 8, 17})
    for (const VirtualPoint point :
         {VirtualPoint::AreaMinimizer, VirtualPoint::Centroid, VirtualPoint::TraceMinimizer}) {
      const FacePoint p = face_point(regular_polygon(n), {.point = point});
      for (const double weight : p.weights) EXPECT_NEAR(weight, 1.0 / n, 1e-14);
      for (const VirtualTriangle& t : p.triangles) {
        EXPECT_NEAR(t.foot, 0.5, 1e-13);
        EXPECT_NEAR(t.double_area, std::sin(2 * std::numbers::pi / n), 1e-13);
      }
    }
}

TEST(VirtualVertexKernel, area_minimiser_is_stationary) {
  // With the literal weights the point is the minimiser in space; in the plane it is its
  // projection.
  const PolygonMesh mesh = skew_pentagon();
  const Vec3 x = face_point(mesh, {.weights = AffineWeights::MinimumNorm}).point;
  const double least = squared_areas(mesh, x);
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, -1, 0.5)})
    for (const double step : {-1e-3, 1e-3}) EXPECT_GT(squared_areas(mesh, x + step * d), least);
  const Vec3 projected = face_point(mesh).point;
  VirtualVertexKernel kernel({});
  std::vector<double> weights(5);
  std::vector<VirtualTriangle> triangles(5);
  kernel.compute(mesh.points(), mesh.face(0), weights.data(), triangles.data());
  const Vec3 normal = kernel.area_vector().normalized();
  EXPECT_LT((projected - x).cross(normal).norm(), 1e-13);
}

TEST(VirtualVertexKernel, weights_reproduce_the_point_and_triangles_are_its_own) {
  const PolygonMesh mesh = skew_pentagon();
  for (const AffineWeights rule : {AffineWeights::InPlane, AffineWeights::MinimumNorm}) {
    const FacePoint p = face_point(mesh, {.weights = rule});
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (Index i = 0; i < 5; ++i) {
      sum += p.weights[i] * mesh.point(i);
      total += p.weights[i];
    }
    EXPECT_NEAR(total, 1, 10 * kEps);
    EXPECT_LT((sum - p.point).norm(), 10 * kEps);
    for (Index i = 0; i < 5; ++i) {
      const Vec3 e = mesh.point((i + 1) % 5) - mesh.point(i), d = p.point - mesh.point(i);
      EXPECT_NEAR(p.triangles[i].foot, e.dot(d) / e.squaredNorm(), 1e-14);
      EXPECT_NEAR(p.triangles[i].double_area, e.cross(d).norm(), 1e-14);
    }
  }
}

TEST(VirtualVertexKernel, trace_minimiser_is_least_in_the_plane) {
  const PolygonMesh mesh =
      make_mesh({{0, 0, 0}, {3, 0, 0}, {3.5, 1, 0}, {1, 2, 0}, {0, 1, 0}}, {{0, 1, 2, 3, 4}});
  const auto trace = [&](const Vec3& x) {
    double sum = 0;
    for (Index i = 0; i < 5; ++i) {
      const Vec3 p = mesh.point(i), q = mesh.point((i + 1) % 5);
      sum += ((q - p).squaredNorm() + (x - p).squaredNorm() + (x - q).squaredNorm()) /
             (q - p).cross(x - p).norm();
    }
    return sum;
  };
  const Vec3 x = face_point(mesh, {.point = VirtualPoint::TraceMinimizer}).point;
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(1, -1, 0)})
    for (const double step : {-1e-3, 1e-3}) EXPECT_GT(trace(x + step * d), trace(x));
}

TEST(VirtualVertexKernel, flipping_points_move_to_the_centroid_of_the_kernel) {
  // The kernel of the L with arms of width 1 is the unit square at its corner.
  const FacePoint p = face_point(l_shaped_face(5), {.point = VirtualPoint::Centroid});
  EXPECT_EQ(p.status, VirtualVertexStatus::Moved);
  EXPECT_LT((p.point - Vec3(0.5, 0.5, 0)).norm(), 1e-13);
  const FacePoint left =
      face_point(l_shaped_face(5), {.point = VirtualPoint::Centroid, .keep_in_kernel = false});
  EXPECT_EQ(left.status, VirtualVertexStatus::Flipped);
  EXPECT_LT((left.point - Vec3(2, 2, 0)).norm(), 1e-13);
  EXPECT_EQ(face_point(spiral_face()).status, VirtualVertexStatus::Flipped);
}

TEST(VirtualVertexKernel, faces_without_area_take_the_mean) {
  const PolygonMesh line = make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}}, {{0, 1, 2, 3}});
  const FacePoint p = face_point(line);
  EXPECT_EQ(p.status, VirtualVertexStatus::Degenerate);
  for (const double weight : p.weights) EXPECT_EQ(weight, 0.25);
  EXPECT_LT((p.point - Vec3(2, 0, 0)).norm(), 1e-14);
  for (const VirtualTriangle& t : p.triangles) EXPECT_EQ(t.double_area, 0);
}

TEST(VirtualVertices, points_are_the_weighted_sums_of_their_vertices) {
  const PolygonMesh mesh = l_shaped_grid(2);
  const VirtualVertices virtuals = virtual_vertices(mesh, mesh.points());
  const Points points = face_points(mesh, mesh.points(), virtuals.weights);
  const Matrix expected =
      (prolongation_matrix(mesh, virtuals.weights) * mesh.points()).bottomRows(mesh.n_faces());
  EXPECT_LT((points - expected).cwiseAbs().maxCoeff(), 1e-14);
  VirtualVertexKernel kernel({});
  std::vector<double> weights(16);
  std::vector<VirtualTriangle> triangles(16);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    kernel.compute(mesh.points(), mesh.face(f), weights.data(), triangles.data());
    EXPECT_LT((points.row(f).transpose() - kernel.point()).norm(), 1e-13);
  }
}

TEST(VirtualVertices, report_counts_every_kind) {
  const PolygonMesh mesh = l_shaped_grid(2);
  Diagnostics diagnostics;
  report_virtual_vertices(virtual_vertices(mesh, mesh.points(), {.point = VirtualPoint::Centroid}),
                          diagnostics);
  EXPECT_EQ(diagnostics.count("moved_virtual_vertices"), 4);
  EXPECT_EQ(diagnostics.count("flipped_virtual_vertices"), 0);
  EXPECT_EQ(diagnostics.count("degenerate_faces"), 0);
  EXPECT_EQ(diagnostics.findings().size(), 3u) << "a count of zero is news";
}

}  // namespace
}  // namespace carat::test
