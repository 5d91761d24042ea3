#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"

namespace carat {
namespace {

using Faces = std::vector<std::vector<Index>>;
constexpr double kEps = std::numeric_limits<double>::epsilon();

PolygonMesh make(std::initializer_list<std::array<double, 3>> x, const Faces& faces) {
  Points points(static_cast<Eigen::Index>(x.size()), 3);
  Eigen::Index row = 0;
  for (const auto& [a, b, c] : x) points.row(row++) << a, b, c;
  return PolygonMesh::from_faces(points, faces);
}

PolygonMesh cube() {
  return make(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
      {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
}

TEST(Statistics, EmptyMesh) {
  const MeshStatistics s = mesh_statistics(PolygonMesh());
  EXPECT_EQ(s.vertices + s.edges + s.faces + s.components + s.euler_characteristic, 0);
  EXPECT_FALSE(s.closed);
  EXPECT_EQ(s.area, 0);
  EXPECT_EQ(s.edge_length.max, 0);
  EXPECT_EQ(s.face_quality.mean, 0);
}

TEST(Statistics, Cube) {
  const MeshStatistics s = mesh_statistics(cube());
  EXPECT_EQ(s.vertices, 8);
  EXPECT_EQ(s.edges, 12);
  EXPECT_EQ(s.faces, 6);
  EXPECT_EQ(s.faces_of_valence, (std::vector<Index>{0, 0, 0, 0, 6}));
  EXPECT_EQ(s.components, 1);
  EXPECT_EQ(s.euler_characteristic, 2);
  EXPECT_TRUE(s.closed);
  EXPECT_EQ(s.boundary_edges, 0);
  EXPECT_EQ(s.boundary_loops, 0);
  EXPECT_EQ(s.nonmanifold_edges, 0);
  EXPECT_EQ(s.nonmanifold_vertices, 0);
  EXPECT_EQ(s.inconsistent_edges, 0);
  EXPECT_EQ(s.nonplanar_faces, 0);
  EXPECT_EQ(s.nonconvex_faces, 0);
  EXPECT_EQ(s.degenerate_faces, 0);
  EXPECT_EQ(s.duplicate_faces, 0);
  EXPECT_DOUBLE_EQ(s.area, 6);
  EXPECT_DOUBLE_EQ(s.enclosed_volume, 1);
  EXPECT_DOUBLE_EQ(s.edge_length.min, 1);
  EXPECT_DOUBLE_EQ(s.edge_length.mean, 1);
  EXPECT_DOUBLE_EQ(s.edge_length.max, 1);
  EXPECT_DOUBLE_EQ(s.face_area.mean, 1);
  EXPECT_DOUBLE_EQ(s.face_quality.min, 1);
  EXPECT_DOUBLE_EQ(s.face_quality.max, 1);
  EXPECT_EQ(s.lower, Vec3(0, 0, 0));
  EXPECT_EQ(s.upper, Vec3(1, 1, 1));
}

TEST(Statistics, VolumeIsSignedAndOnlyOfConsistentMeshes) {
  const PolygonMesh mesh = cube();
  Faces inverted, one_turned;
  for (Index f = 0; f < 6; ++f) {
    const auto face = mesh.face(f);
    one_turned.emplace_back(face.begin(), face.end());
    inverted.emplace_back(face.rbegin(), face.rend());
  }
  one_turned[3] = inverted[3];
  EXPECT_DOUBLE_EQ(
      mesh_statistics(PolygonMesh::from_faces(mesh.points(), inverted)).enclosed_volume, -1);
  const MeshStatistics s = mesh_statistics(PolygonMesh::from_faces(mesh.points(), one_turned));
  EXPECT_TRUE(s.closed);
  EXPECT_EQ(s.inconsistent_edges, 4);
  EXPECT_EQ(s.enclosed_volume, 0);
}

TEST(Statistics, RegularPolygonsHaveQualityOne) {
  for (Index n = 3; n < 12; ++n) {
    Points points(n, 3);
    std::vector<Index> face;
    for (Index i = 0; i < n; ++i) {
      points.row(i) << std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 5;
      face.push_back(i);
    }
    const MeshStatistics s = mesh_statistics(PolygonMesh::from_faces(points, {face}));
    EXPECT_NEAR(s.face_quality.mean, 1, 8 * n * kEps) << n;  // rounding of n cosines
    EXPECT_EQ(s.nonconvex_faces, 0);
    EXPECT_EQ(s.boundary_loops, 1);
  }
  EXPECT_NEAR(mesh_statistics(make({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}))
                  .face_quality.min,
              8.0 / 9, 4 * kEps);
}

TEST(Statistics, NonManifoldMeshes) {
  // Three triangles on an edge: no vertex has more than one fan.
  const MeshStatistics book =
      mesh_statistics(make({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
                           {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}));
  EXPECT_EQ(book.nonmanifold_edges, 1);
  EXPECT_EQ(book.nonmanifold_vertices, 0);
  EXPECT_EQ(book.boundary_edges, 6);
  EXPECT_EQ(book.inconsistent_edges, 0);
  // Two triangles that touch in a vertex, and a vertex without a face.
  const MeshStatistics bow =
      mesh_statistics(make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {9, 9, 9}},
                           {{0, 1, 2}, {0, 3, 4}}));
  EXPECT_EQ(bow.nonmanifold_vertices, 1);
  EXPECT_EQ(bow.nonmanifold_edges, 0);
  EXPECT_EQ(bow.components, 1);
  EXPECT_EQ(bow.boundary_loops, 1);
  EXPECT_EQ(bow.unreferenced_vertices, 1);
  EXPECT_EQ(bow.euler_characteristic, 5 - 6 + 2);
  EXPECT_EQ(bow.upper, Vec3(9, 9, 9));
  // Neighbours turned against each other.
  const MeshStatistics turned =
      mesh_statistics(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(turned.inconsistent_edges, 1);
  EXPECT_EQ(turned.nonmanifold_vertices, 0);
}

TEST(Statistics, ComponentsAndLoops) {
  // A square ring of four trapezoids, and a triangle apart; numbers interleaved.
  const PolygonMesh mesh =
      make({{0, 0, 0},
            {9, 0, 0},
            {3, 0, 0},
            {9, 1, 0},
            {3, 3, 0},
            {0, 3, 0},
            {1, 1, 0},
            {2, 1, 0},
            {2, 2, 0},
            {1, 2, 0},
            {8, 0, 0},
            {7, 7, 7}},
           {{0, 2, 7, 6}, {2, 4, 8, 7}, {4, 5, 9, 8}, {5, 0, 6, 9}, {1, 3, 10}});
  const MeshStatistics s = mesh_statistics(mesh);
  EXPECT_EQ(s.components, 2);
  EXPECT_EQ(s.boundary_loops, 3);
  EXPECT_EQ(s.boundary_edges, 11);
  EXPECT_EQ(s.euler_characteristic, 0 + 1);
  EXPECT_EQ(vertex_components(mesh), (std::vector<Index>{0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, -1}));
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < 11; ++v) EXPECT_TRUE(boundary[v]) << v;
  EXPECT_FALSE(boundary[11]);
}

TEST(Statistics, DuplicateFacesHaveTheSameVertexSet) {
  const MeshStatistics s = mesh_statistics(
      make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 2, 2}}, {{0, 1, 2, 3},
                                                                     {0, 1, 2},
                                                                     {2, 1, 0},
                                                                     {1, 2, 0},
                                                                     {3, 2, 1, 0},
                                                                     {0, 1, 3},
                                                                     {4, 1, 2},
                                                                     {0, 1, 0, 2}}));
  EXPECT_EQ(s.duplicate_faces, 4);  // {0,1,2} thrice more (once with a repeat), {0,1,2,3} once
}

TEST(Statistics, ShapesOfFaces) {
  const MeshStatistics s =
      mesh_statistics(make({{0, 0, 0},
                            {2, 0, 0},
                            {0.5, 0.5, 0},
                            {0, 2, 0},  // an arrow head
                            {1, 1, 0.01},
                            {0, 1, 0},
                            {1, 0, 0},  // a bent quad with 0
                            {4, 0, 0},
                            {3, 0, 0}},  // with 0, 1: on a line
                           {{0, 1, 2, 3}, {0, 6, 4, 5}, {0, 7, 8}, {0, 6, 1, 3}}));
  EXPECT_EQ(s.nonconvex_faces, 1);
  EXPECT_EQ(s.nonplanar_faces, 1);
  EXPECT_EQ(s.degenerate_faces, 1);
  EXPECT_EQ(s.faces_of_valence, (std::vector<Index>{0, 0, 0, 1, 3}));
}

TEST(Statistics, AreaVectorsAndNormals) {
  const PolygonMesh mesh = cube();
  const Points areas = face_area_vectors(mesh);
  EXPECT_EQ(areas.row(0), Eigen::RowVector3d(0, 0, -1));
  EXPECT_EQ(areas.row(3), Eigen::RowVector3d(1, 0, 0));
  const Points normals = vertex_normals(mesh);
  for (Index v = 0; v < 8; ++v) {
    const Vec3 outwards = (mesh.point(v) - Vec3::Constant(0.5)).normalized();
    EXPECT_LT((normals.row(v).transpose() - outwards).norm(), 4 * kEps);
  }
  // The two sides of one triangle cancel, and a vertex without a face has no normal.
  const Points none = vertex_normals(
      make({{0, 0, 0}, {1, 0.1, 0}, {0.3, 1, 0.7}, {5, 5, 5}}, {{0, 1, 2}, {1, 0, 2}}));
  EXPECT_EQ(none, Points::Zero(4, 3));
}

class StatisticsInvariance : public testing::TestWithParam<std::string> {};

void expect_same(const MeshStatistics& a, const MeshStatistics& b, double scale, double tolerance) {
  EXPECT_EQ(a.faces_of_valence, b.faces_of_valence);
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.boundary_loops, b.boundary_loops);
  EXPECT_EQ(a.nonplanar_faces, b.nonplanar_faces);
  EXPECT_EQ(a.nonconvex_faces, b.nonconvex_faces);
  EXPECT_EQ(a.degenerate_faces, b.degenerate_faces);
  EXPECT_EQ(a.duplicate_faces, b.duplicate_faces);
  EXPECT_NEAR(a.area * scale * scale, b.area, tolerance * b.area);
  EXPECT_NEAR(a.edge_length.min * scale, b.edge_length.min, tolerance * b.edge_length.max);
  EXPECT_NEAR(a.edge_length.mean * scale, b.edge_length.mean, tolerance * b.edge_length.max);
  EXPECT_NEAR(a.face_quality.min, b.face_quality.min, tolerance);
  EXPECT_NEAR(a.enclosed_volume * scale * scale * scale, b.enclosed_volume,
              tolerance * b.area * scale);
}

TEST_P(StatisticsInvariance, ScaleAndTranslation) {
  const PolygonMesh mesh = generate_mesh(GetParam(), {.level = 1, .jitter = 0.2});
  const MeshStatistics reference = mesh_statistics(mesh);
  for (const double scale : {1e-9, 1e-3, 1e9})
    // Rounding of the scaled coordinates over the shortest edges.
    expect_same(reference, mesh_statistics(mesh.with_points(scale * mesh.points())), scale, 1e-10);
  // 1e6 diameters away coordinates are rounded to 1e6 eps of the mesh, and the shortest edges of
  // the Voronoi cells are some 1e-4 of it.
  Points far = mesh.points();
  far.rowwise() += Eigen::RowVector3d(2.5e6, -1.5e6, 1e6);
  expect_same(reference, mesh_statistics(mesh.with_points(far)), 1, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Families, StatisticsInvariance,
                         testing::Values("plane-voronoi", "plane-concave", "plane-lshape",
                                         "sphere-triangles", "sphere-hexagons"),
                         [](const auto& family) {
                           std::string name = family.param;
                           name[name.find('-')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace carat
