#pragma once
// The same surface described differently: numbering, start vertices, orientation, position.

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat::test {

/// A fixed permutation of 0..n-1 that leaves little in place.
inline std::vector<Index> permutation(Index n, std::uint64_t seed) {
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::uint64_t state = seed * 0x9e3779b97f4a7c15u + 1;
  for (Index i = n - 1; i > 0; --i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    std::swap(order[i], order[static_cast<Index>((state >> 33) % static_cast<unsigned>(i + 1))]);
  }
  return order;
}

inline std::vector<std::vector<Index>> face_lists(const PolygonMesh& mesh) {
  std::vector<std::vector<Index>> faces;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    faces.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
  return faces;
}

/// Vertex v gets the number new_number[v].
inline PolygonMesh renumber(const PolygonMesh& mesh, const std::vector<Index>& new_number) {
  Points points(mesh.n_vertices(), 3);
  for (Index v = 0; v < mesh.n_vertices(); ++v) points.row(new_number[v]) = mesh.points().row(v);
  auto faces = face_lists(mesh);
  for (auto& face : faces)
    for (Index& v : face) v = new_number[v];
  return PolygonMesh::from_faces(std::move(points), faces);
}

/// The matrix of a renumbered mesh, brought back to the old numbers.
inline SparseMatrix restore_numbers(const SparseMatrix& matrix,
                                    const std::vector<Index>& new_number) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> p(matrix.rows());
  for (Index v = 0; v < matrix.rows(); ++v) p.indices()[v] = new_number[v];
  return p.inverse() * matrix * p;
}

inline PolygonMesh permute_faces(const PolygonMesh& mesh, std::uint64_t seed) {
  const auto faces = face_lists(mesh);
  std::vector<std::vector<Index>> permuted;
  for (const Index f : permutation(mesh.n_faces(), seed)) permuted.push_back(faces[f]);
  return PolygonMesh::from_faces(mesh.points(), permuted);
}

/// Every face starts with another of its vertices.
inline PolygonMesh rotate_faces(const PolygonMesh& mesh) {
  auto faces = face_lists(mesh);
  for (std::size_t f = 0; f < faces.size(); ++f)
    std::rotate(faces[f].begin(),
                faces[f].begin() + static_cast<std::ptrdiff_t>(1 + f % (faces[f].size() - 1)),
                faces[f].end());
  return PolygonMesh::from_faces(mesh.points(), faces);
}

/// Turns every `step`-th face over; 1: all.
inline PolygonMesh flip_faces(const PolygonMesh& mesh, std::size_t step) {
  auto faces = face_lists(mesh);
  for (std::size_t f = 0; f < faces.size(); f += step)
    std::reverse(faces[f].begin(), faces[f].end());
  return PolygonMesh::from_faces(mesh.points(), faces);
}

inline Eigen::Matrix3d some_rotation() {
  return (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-1.3, Vec3::UnitY()) *
          Eigen::AngleAxisd(2.1, Vec3::UnitZ()))
      .toRotationMatrix();
}

inline PolygonMesh move_rigidly(const PolygonMesh& mesh) {
  const Points points =
      (mesh.points() * some_rotation().transpose()).rowwise() + Eigen::RowVector3d(0.3, -0.8, 1.7);
  return mesh.with_points(points);
}

}  // namespace carat::test
