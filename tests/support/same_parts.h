#pragma once
// Whether two parts of a mesh are the same in every bit.

#include <gtest/gtest.h>

#include <cstring>

#include "carat/distributed/part_data.h"
#include "support/mesh_parts.h"

namespace carat::test {

inline void expect_same(const Csr& a, const Csr& b) {
  EXPECT_EQ(a.offsets, b.offsets);
  EXPECT_EQ(a.indices, b.indices);
}

inline void expect_same(const PartNumbers& a, const PartNumbers& b) {
  EXPECT_EQ(std::vector({a.part, a.n_parts, a.first_row, a.end_row, a.n_vertices, a.n_components}),
            std::vector({b.part, b.n_parts, b.first_row, b.end_row, b.n_vertices, b.n_components}));
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.vertex_rows, b.vertex_rows);
  EXPECT_EQ(a.vertex_components, b.vertex_components);
  EXPECT_EQ(a.elements, b.elements);
  EXPECT_EQ(a.interfaces, b.interfaces);
  EXPECT_EQ(a.own_elements, b.own_elements);
  EXPECT_EQ(a.own_interfaces, b.own_interfaces);
}

inline void expect_same(const Points& a, const Points& b) {
  ASSERT_EQ(a.rows(), b.rows());
  EXPECT_TRUE(a.size() == 0 ||
              std::memcmp(a.data(), b.data(), sizeof(double) * std::size_t(a.size())) == 0);
}

inline void expect_same(const PolygonMesh& a, const PolygonMesh& b) {
  expect_same(a.points(), b.points());
  expect_same(a.faces(), b.faces());
}

inline void expect_same(const PolyhedralMesh& a, const PolyhedralMesh& b) {
  expect_same(a.face_mesh(), b.face_mesh());
  expect_same(a.cells(), b.cells());
  ASSERT_EQ(a.face_cells().size(), b.face_cells().size());
  for (Index f = 0; f < a.n_faces(); ++f) {
    EXPECT_EQ(a.face_cells()[f].below, b.face_cells()[f].below);
    EXPECT_EQ(a.face_cells()[f].above, b.face_cells()[f].above);
  }
}

template <class Mesh>
void expect_same(const MeshPart<Mesh>& a, const MeshPart<Mesh>& b) {
  expect_same(a.numbers, b.numbers);
  expect_same(a.mesh, b.mesh);
}

inline void expect_same(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].name, b[k].name);
    EXPECT_EQ(a[k].components, b[k].components);
    EXPECT_EQ(a[k].values, b[k].values);
  }
}

template <class Mesh>
void expect_same(const PartData<Mesh>& a, const PartData<Mesh>& b) {
  expect_same(a.part, b.part);
  expect_same(a.fields.vertex, b.fields.vertex);
  expect_same(a.fields.face, b.fields.face);
  expect_same(a.fields.cell, b.fields.cell);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t k = 0; k < a.patches.size(); ++k) {
    EXPECT_EQ(a.patches[k].name, b.patches[k].name);
    EXPECT_EQ(a.patches[k].type, b.patches[k].type);
    EXPECT_EQ(a.patches[k].faces, b.patches[k].faces);
  }
}

}  // namespace carat::test
