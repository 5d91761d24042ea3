#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/mesh/polygon_mesh.h"

namespace carat {
namespace {

using Faces = std::vector<std::vector<Index>>;

Points line_of_points(Index n) {
  Points points(n, 3);
  for (Index v = 0; v < n; ++v) points.row(v) << v, double(v) * v, 1;
  return points;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidMesh& error) {
    return error.what();
  }
  return "";
}

std::string message_of(Index n_points, const Faces& faces) {
  return message_of([&] { PolygonMesh::from_faces(line_of_points(n_points), faces); });
}

/// Edges by an ordered map, the slow and obvious way.
void expect_edges_as_by_brute_force(const PolygonMesh& mesh) {
  std::map<std::pair<Index, Index>, std::vector<Index>> expected;
  Index corner = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    for (std::size_t i = 0; i < face.size(); ++i, ++corner)
      expected[std::minmax({face[i], face[(i + 1) % face.size()]})].push_back(corner);
  }
  const EdgeTopology& edges = mesh.edges();
  ASSERT_EQ(edges.size(), static_cast<Index>(expected.size()));
  ASSERT_EQ(edges.corners.n_rows(), edges.size());
  ASSERT_EQ(edges.of_corner.size(), static_cast<std::size_t>(mesh.n_corners()));
  Index e = 0;
  for (const auto& [ends, corners] : expected) {
    EXPECT_EQ(edges.vertices[e][0], ends.first);
    EXPECT_EQ(edges.vertices[e][1], ends.second);
    const auto row = edges.corners.row(e);
    EXPECT_EQ(std::vector<Index>(row.begin(), row.end()), corners) << "edge " << e;
    for (const Index c : corners) EXPECT_EQ(edges.of_corner[c], e);
    ++e;
  }
}

TEST(PolygonMesh, KeepsVerticesAndFacesAsGiven) {
  const Faces faces{{4, 2, 0, 1}, {1, 3, 4}, {0, 2, 5}};
  const PolygonMesh mesh = PolygonMesh::from_faces(line_of_points(7), faces);
  EXPECT_EQ(mesh.n_vertices(), 7);
  EXPECT_EQ(mesh.n_faces(), 3);
  EXPECT_EQ(mesh.n_corners(), 10);
  for (Index f = 0; f < 3; ++f)
    EXPECT_EQ(std::vector<Index>(mesh.face(f).begin(), mesh.face(f).end()), faces[f]);
  EXPECT_EQ(mesh.points(), line_of_points(7));
  EXPECT_EQ(mesh.point(3), Vec3(3, 9, 1));
}

TEST(PolygonMesh, EmptyMeshHasNothing) {
  const PolygonMesh nothing;
  EXPECT_EQ(nothing.n_vertices(), 0);
  EXPECT_EQ(nothing.n_faces(), 0);
  EXPECT_EQ(nothing.n_edges(), 0);
  EXPECT_EQ(nothing.vertex_corners().n_rows(), 0);
  const PolygonMesh points_only = PolygonMesh::from_faces(line_of_points(3), {});
  EXPECT_EQ(points_only.n_edges(), 0);
  EXPECT_EQ(points_only.edges().corners.n_rows(), 0);
  EXPECT_EQ(points_only.vertex_corners().n_rows(), 3);
}

TEST(PolygonMesh, EdgesOfMixedFaces) {
  expect_edges_as_by_brute_force(PolygonMesh::from_faces(
      line_of_points(9), {{0, 1, 2, 3}, {3, 2, 4}, {2, 1, 5, 6, 7}, {8, 7, 6}}));
}

TEST(PolygonMesh, EdgesOfManyFacesAndTurnedNeighbours) {
  // Five faces on edge 0-1, in both directions, and a face that runs along an edge twice.
  expect_edges_as_by_brute_force(PolygonMesh::from_faces(
      line_of_points(8),
      {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 5, 6}, {1, 0, 7}, {2, 3, 2, 4}, {0, 1, 2}}));
}

TEST(PolygonMesh, EdgesOfRandomFaces) {
  std::uint32_t state = 7;
  const auto draw = [&](Index n) {
    state = state * 1664525u + 1013904223u;
    return static_cast<Index>((state >> 8) % static_cast<std::uint32_t>(n));
  };
  for (int round = 0; round < 50; ++round) {
    Faces faces;
    for (int f = 0; f < 40; ++f) {
      std::vector<Index> face;
      const Index start = draw(20), size = 3 + draw(5), step = 1 + draw(2);
      for (Index i = 0; i < size; ++i) face.push_back((start + i * step) % 20);
      faces.push_back(face);
    }
    expect_edges_as_by_brute_force(PolygonMesh::from_faces(line_of_points(20), faces));
  }
}

// Quadratic cost would take minutes here and run into the time limit of the test.
TEST(PolygonMesh, HighValenceFanCostsNoMoreThanItsSize) {
  constexpr Index kTriangles = 100000;
  Csr faces;
  for (Index i = 0; i < kTriangles; ++i) {
    // Neighbours far apart in number, so that the buckets arrive unsorted.
    const Index a = 1 + static_cast<Index>(i * 7919LL % kTriangles);
    const Index b = 1 + static_cast<Index>((i + 1) * 7919LL % kTriangles);
    faces.indices.insert(faces.indices.end(), {0, a, b});
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  const PolygonMesh mesh(line_of_points(kTriangles + 1), std::move(faces));
  EXPECT_EQ(mesh.n_edges(), 2 * kTriangles);
  EXPECT_EQ(mesh.vertex_corners().size(0), kTriangles);
}

TEST(PolygonMesh, FaceOfTwoAlternatingVerticesIsRefusedFast) {
  std::vector<Index> face(300000);
  for (std::size_t i = 0; i < face.size(); ++i) face[i] = static_cast<Index>(i % 2);
  EXPECT_NE(message_of(2, {face}), "");
}

TEST(PolygonMesh, DropsVerticesThatRepeatTheirPredecessor) {
  const PolygonMesh mesh = PolygonMesh::from_faces(
      line_of_points(5), {{0, 0, 1, 2, 2, 2}, {1, 2, 3}, {4, 3, 1, 4, 4}, {0, 1, 0, 2}});
  EXPECT_EQ(mesh.n_dropped_corners(), 5);
  const auto face = [&](Index f) {
    return std::vector<Index>(mesh.face(f).begin(), mesh.face(f).end());
  };
  EXPECT_EQ(face(0), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(face(1), (std::vector<Index>{1, 2, 3}));
  EXPECT_EQ(face(2), (std::vector<Index>{4, 3, 1}));
  EXPECT_EQ(face(3), (std::vector<Index>{0, 1, 0, 2}));  // repeats, but not in a row
  expect_edges_as_by_brute_force(mesh);
  EXPECT_EQ(PolygonMesh::from_faces(line_of_points(3), {{0, 1, 2}}).n_dropped_corners(), 0);
}

TEST(PolygonMesh, CornersOfVerticesAndFaces) {
  const PolygonMesh mesh =
      PolygonMesh::from_faces(line_of_points(6), {{0, 1, 2, 3}, {3, 2, 4}, {2, 1, 4}});
  const auto row = mesh.vertex_corners().row(2);
  EXPECT_EQ(std::vector<Index>(row.begin(), row.end()), (std::vector<Index>{2, 5, 7}));
  EXPECT_EQ(mesh.vertex_corners().size(5), 0);
  EXPECT_EQ(mesh.corner_faces()[3], 0);
  EXPECT_EQ(mesh.corner_faces()[4], 1);
  EXPECT_EQ(mesh.corner_faces()[9], 2);
  EXPECT_EQ(mesh.next_corner(0, 3), 0);
  EXPECT_EQ(mesh.next_corner(0, 1), 2);
  EXPECT_EQ(mesh.next_corner(1, 6), 4);
}

TEST(PolygonMesh, PaddedAndListConstructorsAgree) {
  Eigen::Matrix<Index, 3, 5, Eigen::RowMajor> padded;
  padded << 0, 1, 2, -1, -1,  //
      2, 3, 4, 5, 6,          //
      0, 2, 6, 1, -1;
  const PolygonMesh a = PolygonMesh::from_padded(line_of_points(7), padded);
  const PolygonMesh b =
      PolygonMesh::from_faces(line_of_points(7), {{0, 1, 2}, {2, 3, 4, 5, 6}, {0, 2, 6, 1}});
  EXPECT_EQ(a.faces().offsets, b.faces().offsets);
  EXPECT_EQ(a.faces().indices, b.faces().indices);
}

TEST(PolygonMesh, PaddingInsideAFaceIsRefused) {
  Eigen::Matrix<Index, 1, 5, Eigen::RowMajor> padded;
  padded << 0, 1, -1, 2, -1;
  const std::string message =
      message_of([&] { PolygonMesh::from_padded(line_of_points(3), padded); });
  EXPECT_EQ(message,
            "face 0 (vertices 0 1 -1 2): vertex -1 does not exist; the mesh has vertices 0 to 2");
}

TEST(PolygonMesh, CopiesShareTheConnectivity) {
  const PolygonMesh mesh = PolygonMesh::from_faces(line_of_points(4), {{0, 1, 2}, {2, 1, 3}});
  const PolygonMesh copy = mesh;
  const PolygonMesh moved = mesh.with_points(2 * line_of_points(4));
  EXPECT_EQ(&copy.faces(), &mesh.faces());
  EXPECT_EQ(&copy.edges(), &mesh.edges());
  EXPECT_EQ(&moved.edges(), &mesh.edges());
  EXPECT_EQ(moved.points(), 2 * mesh.points());
  EXPECT_EQ(mesh.points(), line_of_points(4));
}

TEST(PolygonMesh, MessagesNameElementValueAndRemedy) {
  EXPECT_EQ(message_of(3, {{0, 1, 2}, {0, 1, 3}}),
            "face 1 (vertices 0 1 3): vertex 3 does not exist; the mesh has vertices 0 to 2");
  EXPECT_EQ(message_of(3, {{0, 1}}),
            "face 0 (vertices 0 1): a face needs at least 3 distinct vertices; remove it");
  EXPECT_EQ(message_of(3, {{0, 1, 2}, {}}),
            "face 1 (vertices): a face needs at least 3 distinct vertices; remove it");
  EXPECT_EQ(message_of(3, {{0, 1, 0, 1, 1, 0, 1, 0, 1}}),
            "face 0 (vertices 0 1 0 1 1 0 1 0 ...): a face needs at least 3 distinct vertices; "
            "remove it");
  Points points = line_of_points(3);
  points(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of([&] {
              PolygonMesh::from_faces(points, {{0, 1, 2}});
            }).find("vertex 1: coordinate z is"),
            std::string::npos);
  points(1, 2) = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(message_of([&] {
              PolygonMesh::from_faces(points, {{0, 1, 2}});
            }),
            "vertex 1: coordinate z is -inf; every coordinate must be a finite number");
  const PolygonMesh mesh = PolygonMesh::from_faces(line_of_points(3), {{0, 1, 2}});
  EXPECT_EQ(message_of([&] { mesh.with_points(line_of_points(4)); }),
            "4 points for a mesh of 3 vertices; the numbers must be equal");
  EXPECT_NE(message_of([&] { mesh.with_points(points); }), "");
}

TEST(PolygonMesh, ErrorsCarryTheElement) {
  try {
    PolygonMesh::from_faces(line_of_points(3), {{0, 1, 2}, {0, 1, 2}, {0, 1, 7}});
    FAIL() << "an index out of range was accepted";
  } catch (const InvalidMesh& error) {
    EXPECT_EQ(error.elements(), std::vector<Index>{2});
  }
}

TEST(PolygonMesh, OffsetsMustDescribeTheCorners) {
  const auto message = [&](Array<Index> offsets) {
    Csr faces;
    faces.offsets = std::move(offsets);
    faces.indices = {0, 1, 2, 2, 1, 3};
    return message_of([&] { PolygonMesh(line_of_points(4), std::move(faces)); });
  };
  EXPECT_EQ(message({0, 3, 6}), "");
  const std::string ends = "face offsets must start at 0 and end at the number of corners (6)";
  EXPECT_EQ(message({}), ends);
  EXPECT_EQ(message({1, 3, 6}), ends);
  EXPECT_EQ(message({0, 3}), ends);
  EXPECT_EQ(message({0, 3, 9}), ends);
  EXPECT_EQ(message({0, 5, 3, 6}), "face 1: face offsets must not descend");
  EXPECT_EQ(message({0, 9, 3, 6}), "face 1: face offsets must not descend");
}

}  // namespace
}  // namespace carat
