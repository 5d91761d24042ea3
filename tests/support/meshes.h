#pragma once
// Small meshes made by hand: every one is a case that real input contains.

#include <cmath>
#include <numbers>
#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat::test {

using Faces = std::vector<std::vector<Index>>;

inline Points make_points(const std::vector<Vec3>& rows) {
  Points points(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return points;
}

inline PolygonMesh make_mesh(const std::vector<Vec3>& points, const Faces& faces) {
  return PolygonMesh::from_faces(make_points(points), faces);
}

/// A regular n-gon of radius 1 in the plane.
inline PolygonMesh regular_polygon(Index n) {
  std::vector<Vec3> points;
  Faces faces(1);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.emplace_back(std::cos(angle), std::sin(angle), 0);
    faces[0].push_back(i);
  }
  return make_mesh(points, faces);
}

inline PolygonMesh single_triangle() {
  return make_mesh({{0, 0, 0}, {2, 0, 0}, {0.5, 1, 0}}, {{0, 1, 2}});
}

/// nx by ny squares of side 1 in z = 0; vertex (i, j) has the number j (nx + 1) + i.
inline PolygonMesh quad_grid(Index nx, Index ny) {
  std::vector<Vec3> points;
  Faces faces;
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i) points.emplace_back(i, j, 0);
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      const Index v = j * (nx + 1) + i;
      faces.push_back({v, v + 1, v + nx + 2, v + nx + 1});
    }
  return make_mesh(points, faces);
}

/// k rectangles around one common edge of length 1, like the pages of a book; their widths and
/// angles differ.
inline PolygonMesh book(Index pages) {
  std::vector<Vec3> points{{0, 0, 0}, {0, 0, 1}};
  Faces faces;
  for (Index k = 0; k < pages; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.2 * std::sin(3.0 * k)) / pages;
    const double width = 1 + 0.3 * std::cos(2.0 * k);
    const Vec3 out(width * std::cos(angle), width * std::sin(angle), 0);
    points.push_back(out);
    points.push_back(out + Vec3(0, 0, 1 + 0.1 * k));
    faces.push_back({0, 2 * k + 2, 2 * k + 3, 1});
  }
  return make_mesh(points, faces);
}

/// Two triangles far apart and, between them, two vertices without a face.
inline PolygonMesh two_components_with_loose_vertices() {
  return make_mesh({{0, 0, 0},
                    {1, 0, 0},
                    {0, 1, 0},
                    {50, 50, 50},
                    {9, 9, 9},
                    {0, 0, 5},
                    {1, 0, 5},
                    {1, 1, 5},
                    {0, 1, 5}},
                   {{0, 1, 2}, {5, 6, 7, 8}});
}

/// n quads around a band with one half twist: not orientable.
inline PolygonMesh moebius_strip(Index n) {
  std::vector<Vec3> points;
  Faces faces;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    const Vec3 outwards(std::cos(angle), std::sin(angle), 0);
    const Vec3 across = std::cos(angle / 2) * outwards + std::sin(angle / 2) * Vec3(0, 0, 1);
    points.push_back(2 * outwards - 0.5 * across);
    points.push_back(2 * outwards + 0.5 * across);
  }
  for (Index i = 0; i + 1 < n; ++i) faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  faces.push_back({2 * n - 2, 1, 0, 2 * n - 1});
  return make_mesh(points, faces);
}

inline PolygonMesh tetrahedron() {
  return make_mesh({{0, 0, 0}, {1, 0, 0}, {0.2, 1, 0}, {0.3, 0.4, 0.9}},
                   {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

inline PolygonMesh cube() {
  return make_mesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
}

/// Two polygons that share two consecutive edges (0-1 and 1-2).
inline PolygonMesh faces_sharing_two_edges() {
  return make_mesh({{0, 0, 0}, {1, 0.3, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, -2, 0.4}},
                   {{0, 1, 2, 3, 4}, {2, 1, 0, 5}});
}

/// One face that passes vertex 0 twice: two triangles joined at a point.
inline PolygonMesh face_with_a_repeated_vertex() {
  return make_mesh({{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {-1, 1, 0}, {-1, -1, 0}},
                   {{0, 1, 2, 0, 3, 4}});
}

/// A square face with a slit from vertex 0 to the inner vertex 4: both sides of edge 0-4 belong to
/// the same face. A second square lies beside it.
inline PolygonMesh slit_face() {
  return make_mesh(
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.9, 0.7, 0}, {4, 0, 0}, {4, 2, 0}},
      {{4, 0, 1, 2, 3, 0}, {1, 5, 6, 2}});
}

/// A planar octagonal spiral of which no point sees all sides: its kernel is empty.
inline PolygonMesh spiral_face() {
  return make_mesh({{0, 0, 0},
                    {5, 0, 0},
                    {5, 4, 0},
                    {1, 4, 0},
                    {1, 2, 0},
                    {3, 2, 0},
                    {3, 3, 0},
                    {2, 3, 0},
                    {2, 3.5, 0},
                    {4, 3.5, 0},
                    {4, 1, 0},
                    {0, 1, 0}},
                   {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}});
}

/// A planar L: its centroid lies outside of its kernel, the kernel is the corner square.
inline PolygonMesh l_shaped_face(double arm) {
  return make_mesh({{0, 0, 0}, {arm, 0, 0}, {arm, 1, 0}, {1, 1, 0}, {1, arm, 0}, {0, arm, 0}},
                   {{0, 1, 2, 3, 4, 5}});
}

/// n by n blocks, each cut into an L-shaped hexagon and the square that fills its notch.
inline PolygonMesh l_shaped_grid(Index n) {
  const Index row = 2 * n + 1;
  std::vector<Vec3> points;
  Faces faces;
  for (Index j = 0; j < row; ++j)
    for (Index i = 0; i < row; ++i) {
      // Odd lines are drawn towards the lower left: thin arms.
      points.emplace_back(i / 2 + (i % 2) * 0.2, j / 2 + (j % 2) * 0.2, 0);
    }
  const auto at = [&](Index i, Index j) { return j * row + i; };
  for (Index j = 0; j < 2 * n; j += 2)
    for (Index i = 0; i < 2 * n; i += 2) {
      faces.push_back({at(i, j), at(i + 1, j), at(i + 2, j), at(i + 2, j + 1), at(i + 1, j + 1),
                       at(i + 1, j + 2), at(i, j + 2), at(i, j + 1)});
      faces.push_back({at(i + 1, j + 1), at(i + 2, j + 1), at(i + 2, j + 2), at(i + 1, j + 2)});
    }
  return make_mesh(points, faces);
}

/// All meshes above that bound or cover something of positive area.
struct NamedMesh {
  const char* name;
  PolygonMesh mesh;
};
inline std::vector<NamedMesh> unusual_meshes() {
  return {{"single_triangle", single_triangle()},
          {"pentagon", regular_polygon(5)},
          {"book_of_3", book(3)},
          {"book_of_4", book(4)},
          {"book_of_7", book(7)},
          {"two_components", two_components_with_loose_vertices()},
          {"moebius_strip", moebius_strip(9)},
          {"tetrahedron", tetrahedron()},
          {"cube", cube()},
          {"faces_sharing_two_edges", faces_sharing_two_edges()},
          {"face_with_a_repeated_vertex", face_with_a_repeated_vertex()},
          {"slit_face", slit_face()},
          {"spiral_face", spiral_face()},
          {"l_shaped_face", l_shaped_face(5)},
          {"l_shaped_grid", l_shaped_grid(2)}};
}

}  // namespace carat::test
