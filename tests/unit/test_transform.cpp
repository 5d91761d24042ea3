#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/mesh/transform.h"

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

PolygonMesh one_polygon(const std::vector<Vec2>& x) {
  Points points(static_cast<Eigen::Index>(x.size()), 3);
  std::vector<Index> face;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) << x[i].x(), x[i].y(), 0;
    face.push_back(static_cast<Index>(i));
  }
  return PolygonMesh::from_faces(points, {face});
}

std::set<std::set<Index>> face_sets(const PolygonMesh& mesh) {
  std::set<std::set<Index>> sets;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    sets.insert(std::set<Index>(mesh.face(f).begin(), mesh.face(f).end()));
  return sets;
}

/// n - 2 triangles that cover the polygon once: none turned over, and the areas add up.
void expect_covered_once(const PolygonMesh& polygon) {
  const PolygonMesh triangles = triangulate(polygon);
  ASSERT_EQ(triangles.n_faces(), polygon.n_corners() - 2);
  const Vec3 whole = face_area_vectors(polygon).row(0);
  const Points areas = face_area_vectors(triangles);
  double sum = 0, least = 0;
  for (Index f = 0; f < triangles.n_faces(); ++f) {
    const double area = areas.row(f).dot(whole.normalized());
    least = std::min(least, area);
    sum += area;
  }
  // Rounding of n products of coordinates of the size of the polygon.
  const double rounding = 4 * polygon.n_corners() * kEps * whole.norm();
  EXPECT_GE(least, -rounding);
  EXPECT_NEAR(sum, whole.norm(), 10 * rounding);
}

std::vector<Vec2> polar(Index n, const std::function<double(double)>& radius) {
  std::vector<Vec2> x;
  for (Index i = 0; i < n; ++i) {
    const double t = 2 * M_PI * i / n;
    x.push_back(radius(t) * Vec2(std::cos(t), std::sin(t)));
  }
  return x;
}

std::vector<Vec2> spiral(Index n) {
  std::vector<Vec2> x;
  for (Index i = 0; i < n; ++i) {
    const Index half = n / 2, k = i < half ? i : n - 1 - i;
    const double t = 12 * M_PI * k / half;
    x.push_back((t + (i < half ? 12 : 10)) * Vec2(std::cos(t), std::sin(t)));
  }
  return x;
}

// ---- triangulate ---------------------------------------------------------------------------

TEST(Triangulate, QuadsAreCutInsideThenShortWhereverTheyStart) {
  const std::vector<std::array<double, 3>> kite{{0, 0, 0}, {2, -1, 0}, {3, 0, 0}, {2, 1, 0}};
  const std::vector<std::array<double, 3>> dart{{0, 0, 0}, {3, -0.5, 0}, {2, 0, 0}, {3, 0.5, 0}};
  const std::vector<std::array<double, 3>> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<double, 3>> straight{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 3, 0}};
  for (Index start = 0; start < 4; ++start) {
    std::vector<Index> face;
    for (Index i = 0; i < 4; ++i) face.push_back((start + i) % 4);
    const auto cut = [&](const auto& x) {
      Points points(4, 3);
      for (Index v = 0; v < 4; ++v) points.row(v) << x[v][0], x[v][1], x[v][2];
      return face_sets(triangulate(PolygonMesh::from_faces(points, {face})));
    };
    const std::set<std::set<Index>> even{{0, 1, 2}, {0, 2, 3}}, odd{{1, 2, 3}, {0, 1, 3}};
    EXPECT_EQ(cut(kite), odd);      // the short diagonal
    EXPECT_EQ(cut(dart), even);     // the only one inside, though 1-3 is shorter
    EXPECT_EQ(cut(square), even);   // a tie: at the lowest number
    EXPECT_EQ(cut(straight), odd);  // 0-2 would leave an empty triangle
  }
}

TEST(Triangulate, KeepsTrianglesOrderAndSources) {
  const PolygonMesh mesh =
      make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0.5, 0}, {0.5, 2, 0}},
           {{1, 4, 2}, {0, 1, 2, 3}, {5, 3, 2}});
  std::vector<Index> sources{7, 7, 7, 7, 7, 7, 7};
  const PolygonMesh triangles = triangulate(mesh, &sources);
  EXPECT_EQ(sources, (std::vector<Index>{0, 1, 1, 2}));
  EXPECT_EQ(triangles.points(), mesh.points());
  const auto first = triangles.face(0);
  EXPECT_EQ(std::vector<Index>(first.begin(), first.end()), (std::vector<Index>{1, 4, 2}));
  for (Index f = 0; f < triangles.n_faces(); ++f) EXPECT_GT(face_area_vectors(triangles)(f, 2), 0);
}

TEST(Triangulate, ConvexPolygonsAreCutEvenly) {
  for (const Index n : {5, 6, 7, 12, 64, 1000}) {
    const PolygonMesh polygon = one_polygon(polar(n, [](double) { return 1.0; }));
    expect_covered_once(polygon);
    // Halving the corners again and again leaves no vertex with many diagonals.
    const PolygonMesh triangles = triangulate(polygon);
    Index most = 0;
    for (Index v = 0; v < n; ++v) most = std::max(most, triangles.vertex_corners().size(v));
    EXPECT_LE(most, 2 * std::log2(n) + 2) << n;
  }
}

TEST(Triangulate, NonConvexPolygonsAreCoveredOnce) {
  for (const Index n : {10, 50, 500}) {
    expect_covered_once(
        one_polygon(polar(n, [n](double t) { return std::cos(n * t / 2) > 0 ? 1 : 0.2; })));
    expect_covered_once(one_polygon(polar(n, [](double t) { return 1 + 0.6 * std::sin(3 * t); })));
    expect_covered_once(one_polygon(spiral(40 * n)));
  }
}

TEST(Triangulate, EarsThatHoldAReflexCornerAreNotCut) {
  // A notch from far away ends inside the triangle of the shortest diagonal.
  expect_covered_once(one_polygon({{0, 0}, {1, 0}, {10, 9}, {0.2, 0.2}, {9, 10}, {0, 1}}));
  std::uint32_t state = 3;
  for (int round = 0; round < 200; ++round)
    expect_covered_once(one_polygon(polar(5 + round % 60, [&](double) {
      state = state * 1664525u + 1013904223u;
      return 0.05 + (state >> 8) * 0x1p-24;
    })));
}

TEST(Triangulate, StraightCornersLeaveNoEmptyTriangle) {
  // An L with ten straight corners a side.
  const std::vector<Vec2> corners{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::vector<Vec2> x;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k < 11; ++k)
      x.push_back(corners[i] + k / 11.0 * (corners[(i + 1) % corners.size()] - corners[i]));
  const PolygonMesh polygon = one_polygon(x);
  expect_covered_once(polygon);
  EXPECT_EQ(mesh_statistics(triangulate(polygon)).degenerate_faces, 0);
}

TEST(Triangulate, FacesWithoutAPlaneAreCutAsAFan) {
  const std::set<std::set<Index>> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  // A pentagon that turns twice, with convex corners alone; points on a line have no plane.
  const std::vector<Vec2> star{
      {-0.76, 0.44}, {0.28, -0.76}, {0.13, 0.52}, {-0.64, -0.55}, {0.93, 0.09}};
  EXPECT_EQ(face_sets(triangulate(one_polygon(star))), fan);
  EXPECT_EQ(face_sets(triangulate(one_polygon({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}}))), fan);
  EXPECT_EQ(face_sets(triangulate(one_polygon({{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}))), fan);
}

TEST(Triangulate, FacesThatVisitAVertexTwice) {
  const PolygonMesh mesh = make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                                {{0, 1, 2, 0, 3, 4}, {0, 1, 0, 2}, {0, 1, 0, 2, 0, 3}});
  const PolygonMesh triangles = triangulate(mesh);
  for (Index f = 0; f < triangles.n_faces(); ++f) EXPECT_EQ(triangles.face(f).size(), 3u);
  EXPECT_EQ(triangles.n_dropped_corners(), 0);
}

// Quadratic cost would take minutes here and run into the time limit of the test.
TEST(Triangulate, HugePolygonsTakeNoQuadraticTime) {
  constexpr Index kCorners = 100000;
  expect_covered_once(one_polygon(polar(kCorners, [](double) { return 1.0; })));
  expect_covered_once(one_polygon(polar(kCorners, [](double t) { return 2 + std::sin(50 * t); })));
  expect_covered_once(one_polygon(spiral(kCorners)));
}

TEST(Triangulate, AreaOfPlanarFamiliesIsKept) {
  for (const char* family : {"plane-quads", "plane-voronoi", "plane-concave", "plane-lshape"})
    for (const double jitter : {0.0, 0.4}) {
      const PolygonMesh mesh = generate_mesh(family, {.level = 2, .jitter = jitter});
      const MeshStatistics s = mesh_statistics(triangulate(mesh));
      EXPECT_NEAR(s.area, 1, 1e-13) << family;  // rounding of some 10^3 areas
      EXPECT_EQ(s.faces, mesh.n_corners() - 2 * mesh.n_faces());
      EXPECT_EQ(s.inconsistent_edges, 0);
      const Points areas = face_area_vectors(triangulate(mesh));
      EXPECT_GE(areas.col(2).minCoeff(), 0) << family;
    }
}

TEST(Triangulate, SphereStaysClosed) {
  for (const char* family : {"sphere-quads", "sphere-hexagons", "sphere-concave"}) {
    const PolygonMesh mesh = generate_mesh(family, {.level = 2, .jitter = 0.2});
    const MeshStatistics s = mesh_statistics(triangulate(mesh));
    EXPECT_TRUE(s.closed);
    EXPECT_EQ(s.inconsistent_edges, 0);
    EXPECT_EQ(s.euler_characteristic, 2);
    EXPECT_GT(s.enclosed_volume, 3.9) << family;
  }
}

// ---- dual_mesh -----------------------------------------------------------------------------

TEST(DualMesh, ClosedMeshesSwapVerticesAndFaces) {
  for (const char* family : {"sphere-triangles", "sphere-quads", "torus-triangles"}) {
    const PolygonMesh mesh = generate_mesh(family, {.level = 1});
    const PolygonMesh dual = dual_mesh(mesh);
    EXPECT_EQ(dual.n_vertices(), mesh.n_faces());
    EXPECT_EQ(dual.n_faces(), mesh.n_vertices());
    EXPECT_EQ(dual.n_edges(), mesh.n_edges());
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      EXPECT_EQ(dual.faces().size(v), mesh.vertex_corners().size(v));
    const MeshStatistics s = mesh_statistics(dual), t = mesh_statistics(dual_mesh(dual));
    EXPECT_TRUE(s.closed);
    EXPECT_EQ(s.inconsistent_edges, 0);
    EXPECT_GT(s.enclosed_volume, 0) << "the dual is turned over";
    EXPECT_GT(t.enclosed_volume, 0);
    EXPECT_EQ(t.vertices, mesh.n_vertices());
    EXPECT_EQ(t.faces, mesh.n_faces());
  }
}

TEST(DualMesh, VerticesAreMeansOfFaces) {
  const PolygonMesh mesh = generate_mesh("sphere-quads", {.level = 0});
  const PolygonMesh dual = dual_mesh(mesh);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    Vec3 mean = Vec3::Zero();
    for (const Index v : mesh.face(f)) mean += mesh.point(v) / 4;
    EXPECT_LT((dual.point(f) - mean).norm(), 8 * kEps);
  }
}

TEST(DualMesh, BoundaryKeepsTheDomain) {
  for (const char* family : {"plane-triangles", "plane-quads", "plane-voronoi"}) {
    const PolygonMesh mesh = generate_mesh(family, {.level = 2});
    const MeshStatistics before = mesh_statistics(mesh);
    const PolygonMesh dual = dual_mesh(mesh);
    const MeshStatistics s = mesh_statistics(dual);
    EXPECT_NEAR(s.area, 1, 1e-14) << family;  // rounding of a compensated sum
    EXPECT_EQ(s.euler_characteristic, 1);
    EXPECT_EQ(s.faces, before.vertices);
    EXPECT_EQ(s.vertices, before.faces + 2 * before.boundary_edges);
    EXPECT_EQ(s.boundary_edges, 2 * before.boundary_edges);
    EXPECT_EQ(s.boundary_loops, 1);
    EXPECT_EQ(s.inconsistent_edges, 0);
    EXPECT_GT(face_area_vectors(dual).col(2).minCoeff(), 0);
  }
}

TEST(DualMesh, NumbersAsDocumented) {
  // Two triangles: faces 0 1, then midpoints of the boundary edges 01 02 13 23, then vertices.
  const PolygonMesh dual =
      dual_mesh(make({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}}, {{0, 1, 2}, {1, 3, 2}}));
  ASSERT_EQ(dual.n_vertices(), 2 + 4 + 4);
  EXPECT_EQ(dual.point(2), Vec3(1, 0, 0));
  EXPECT_EQ(dual.point(3), Vec3(0, 1, 0));
  EXPECT_EQ(dual.point(4), Vec3(2, 1, 0));
  EXPECT_EQ(dual.point(5), Vec3(1, 2, 0));
  EXPECT_EQ(dual.point(9), Vec3(2, 2, 0));
  ASSERT_EQ(dual.n_faces(), 4);
  const auto face = [&](Index f) {
    return std::vector<Index>(dual.face(f).begin(), dual.face(f).end());
  };
  EXPECT_EQ(face(0), (std::vector<Index>{6, 2, 0, 3}));
  EXPECT_EQ(face(1), (std::vector<Index>{7, 4, 1, 0, 2}));
  EXPECT_EQ(face(2), (std::vector<Index>{8, 3, 0, 1, 5}));
  EXPECT_EQ(face(3), (std::vector<Index>{9, 5, 1, 4}));
}

TEST(DualMesh, SeveralFansGiveSeveralPolygons) {
  const PolygonMesh bow =
      make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {7, 7, 7}},
           {{0, 1, 2}, {0, 3, 4}});
  const PolygonMesh dual = dual_mesh(bow);
  EXPECT_EQ(dual.n_faces(), 6);  // vertex 0 twice, the one without a face never
  EXPECT_EQ(dual.n_vertices(), 2 + 6 + 5);
  EXPECT_DOUBLE_EQ(mesh_statistics(dual).area, mesh_statistics(bow).area);
  // Two tetrahedra that share a vertex: two closed fans there.
  Faces tetrahedra;
  for (const Index first : {1, 4}) {
    const Index a = first, b = first + 1, c = first + 2;
    for (const auto& face : Faces{{0, b, a}, {0, c, b}, {0, a, c}, {a, b, c}})
      tetrahedra.push_back(face);
  }
  const PolygonMesh touching =
      make({{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {-1, -1, -1}, {0, 1, -1}},
           tetrahedra);
  EXPECT_EQ(dual_mesh(touching).n_faces(), 8);
  EXPECT_TRUE(mesh_statistics(dual_mesh(touching)).closed);
}

TEST(DualMesh, PillowHasNothingLeft) {
  // Two triangles back to back: every fan has two faces, too few for a polygon.
  const PolygonMesh dual =
      dual_mesh(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}}));
  EXPECT_EQ(dual.n_vertices(), 2);
  EXPECT_EQ(dual.n_faces(), 0);
}

TEST(DualMesh, FaceThatUsesAnEdgeTwice) {
  // A quad with a spike 0-4 into its inside.
  const PolygonMesh mesh =
      make({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.4, 0.4, 0}}, {{0, 1, 2, 3, 0, 4}});
  const PolygonMesh dual = dual_mesh(mesh);
  EXPECT_GE(dual.n_faces(), 4);
  EXPECT_EQ(mesh_statistics(dual).inconsistent_edges, 0);
}

std::string message_of_dual(const PolygonMesh& mesh) {
  try {
    dual_mesh(mesh);
  } catch (const InvalidMesh& error) {
    return error.what();
  }
  return "";
}

TEST(DualMesh, RefusesWhatHasNone) {
  EXPECT_EQ(message_of_dual(make({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
                                 {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}})),
            "edge 0 (vertices 0 1) belongs to 3 faces; a dual mesh needs at most 2 an edge: "
            "separate the sheets");
  EXPECT_EQ(
      message_of_dual(make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 2, 3}})),
      "edge 2 (vertices 1 2): faces 0 and 1 run along it in the same direction; a dual mesh "
      "needs consistently oriented faces: turn one of them over");
}

TEST(DualMesh, HighValenceVertex) {
  constexpr Index kFaces = 100000;
  const PolygonMesh polygon = one_polygon(polar(kFaces, [](double) { return 1.0; }));
  Points points(kFaces + 1, 3);
  points << polygon.points(), 0, 0, 0;
  Faces faces;
  for (Index i = 0; i < kFaces; ++i) faces.push_back({kFaces, i, (i + 1) % kFaces});
  const PolygonMesh dual = dual_mesh(PolygonMesh::from_faces(points, faces));
  EXPECT_EQ(dual.faces().size(kFaces), kFaces);
}

}  // namespace
}  // namespace carat
