#include <gtest/gtest.h>

#include <algorithm>

#include "carat/base/error.h"
#include "carat/mesh/mesh_part.h"
#include "support/mesh_parts.h"

namespace carat::test {
namespace {

std::vector<Index> elements_of(const PolygonMesh& mesh, Index edge) {
  std::vector<Index> faces;
  for (const Index corner : mesh.edges().corners.row(edge))
    faces.push_back(mesh.corner_faces()[corner]);
  return faces;
}
std::vector<Index> elements_of(const PolyhedralMesh& mesh, Index face) {
  const FaceCells cells = mesh.face_cells()[face];
  std::vector<Index> both;
  for (const Index c : {cells.below, cells.above})
    if (c >= 0) both.push_back(c);
  return both;
}

/// Vertices of every element, as they are named.
std::span<const Index> vertices_of(const PolygonMesh& mesh, Index face) { return mesh.face(face); }
std::span<const Index> vertices_of(const PolyhedralMesh& mesh, Index cell) {
  return mesh.cell_vertices().row(cell);
}
std::vector<Index> vertices_of_interface(const PolygonMesh& mesh, Index edge) {
  return {mesh.edges().vertices[edge].begin(), mesh.edges().vertices[edge].end()};
}
std::vector<Index> vertices_of_interface(const PolyhedralMesh& mesh, Index face) {
  return {mesh.face(face).begin(), mesh.face(face).end()};
}

template <class List>
std::vector<Index> mapped(const List& here, const Array<Index>& numbers) {
  std::vector<Index> whole;
  for (const Index i : here) whole.push_back(numbers[i]);
  return whole;
}

/// Every element, interface and vertex is one part's own; what a part holds is what it is in the
/// whole mesh; what it brings it holds with all elements.
template <class Mesh>
void check_division(const Mesh& mesh, const MeshDivision& division) {
  std::vector<int> elements(n_elements(mesh)), interfaces(n_interfaces(mesh)),
      vertices(mesh.n_vertices()), rows(mesh.n_vertices());
  EXPECT_EQ(division.first_row[0], 0);
  EXPECT_EQ(division.first_row[division.n_parts], mesh.n_vertices());
  for (Index part = 0; part < division.n_parts; ++part) {
    const MeshPart<Mesh> own = part_of(mesh, division, part);
    const PartNumbers& numbers = own.numbers;
    ASSERT_EQ(own.mesh.n_vertices(), static_cast<Index>(numbers.vertices.size()));
    ASSERT_EQ(n_elements(own.mesh), static_cast<Index>(numbers.elements.size()));
    ASSERT_EQ(n_interfaces(own.mesh), static_cast<Index>(numbers.interfaces.size()));
    for (Index v = 0; v < own.mesh.n_vertices(); ++v) {
      EXPECT_EQ(own.mesh.point(v), mesh.point(numbers.vertices[v]));
      EXPECT_EQ(numbers.vertex_rows[v], division.vertex_row[numbers.vertices[v]]);
      if (!numbers.own_vertex(v)) continue;
      ++vertices[numbers.vertices[v]];
      ++rows[numbers.vertex_rows[v]];
    }
    for (Index e = 0; e < n_elements(own.mesh); ++e) {
      elements[numbers.elements[e]] += numbers.own_elements[e];
      const std::span<const Index> whole = vertices_of(mesh, numbers.elements[e]);
      EXPECT_EQ(mapped(vertices_of(own.mesh, e), numbers.vertices),
                std::vector<Index>(whole.begin(), whole.end()));
    }
    for (Index i = 0; i < n_interfaces(own.mesh); ++i) {
      EXPECT_EQ(mapped(vertices_of_interface(own.mesh, i), numbers.vertices),
                vertices_of_interface(mesh, numbers.interfaces[i]));
      const std::vector<Index> whole = elements_of(mesh, numbers.interfaces[i]);
      const std::vector<Index> here = mapped(elements_of(own.mesh, i), numbers.elements);
      interfaces[numbers.interfaces[i]] += numbers.own_interfaces[i];
      // In the same order, and so the sides of faces too.
      const bool touches_own = std::any_of(
          whole.begin(), whole.end(), [&](Index e) { return division.element_part[e] == part; });
      EXPECT_TRUE(touches_own || !numbers.own_interfaces[i]);
      if (touches_own) {
        EXPECT_EQ(here, whole);
      }
    }
    const Mesh alone = own_mesh(own);
    EXPECT_EQ(alone.n_vertices(), own.mesh.n_vertices());
    EXPECT_EQ(n_elements(alone), division.elements.size(part));
  }
  EXPECT_EQ(elements, std::vector<int>(elements.size(), 1));
  EXPECT_EQ(vertices, std::vector<int>(vertices.size(), 1));
  EXPECT_EQ(rows, std::vector<int>(rows.size(), 1));
  for (Index i = 0; i < n_interfaces(mesh); ++i)
    EXPECT_EQ(interfaces[i], elements_of(mesh, i).empty() ? 0 : 1);
}

TEST(MeshPart, surfaces_are_divided_without_gap_or_overlap) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    for_divisions(mesh, [&](const MeshDivision& division) { check_division(mesh, division); });
  }
}

TEST(MeshPart, volumes_are_divided_without_gap_or_overlap) {
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    for_divisions(mesh, [&](const MeshDivision& division) { check_division(mesh, division); });
  }
}

TEST(MeshPart, baffles_and_folded_cells_keep_their_sides) {
  // Two tetrahedra on either side of a face that is there twice: the halo must not join them.
  const PolyhedralMesh baffle = PolyhedralMesh::from_owner_neighbour(
      make_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}),
      []() {
        Csr faces;
        for (const std::array<Index, 3>& face : std::vector<std::array<Index, 3>>{{0, 2, 1},
                                                                                  {0, 1, 3},
                                                                                  {1, 2, 3},
                                                                                  {0, 3, 2},
                                                                                  {0, 1, 2},
                                                                                  {0, 4, 1},
                                                                                  {1, 4, 2},
                                                                                  {0, 2, 4}}) {
          faces.indices.insert(faces.indices.end(), face.begin(), face.end());
          faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
        }
        return faces;
      }(),
      std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 1}, {});
  for_divisions(baffle, [&](const MeshDivision& division) {
    check_division(baffle, division);
    EXPECT_EQ(division.n_cut_interfaces, 0);
    EXPECT_EQ(division.n_components, 1);
  });
  const PolyhedralMesh folded = folded_hexes();
  const MeshDivision division = divide(folded, 8, std::vector<Index>{0, 1, 2, 3, 4, 5, 6, 7});
  for (Index part = 0; part < 8; ++part) {
    const auto own = part_of(folded, division, part);
    for (Index f = 0; f < own.mesh.n_faces(); ++f) {
      const FaceCells here = own.mesh.face_cells()[f],
                      whole = folded.face_cells()[own.numbers.interfaces[f]];
      if (here.below >= 0) {
        EXPECT_EQ(own.numbers.elements[here.below], whole.below);
      }
      if (here.above >= 0) {
        EXPECT_EQ(own.numbers.elements[here.above], whole.above);
      }
    }
  }
}

TEST(MeshPart, components_and_quality_are_counted) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const MeshDivision division = divide(mesh, 2, std::vector<Index>{1, 0});
  EXPECT_EQ(division.n_components, 2);
  EXPECT_EQ(
      (std::vector<Index>(division.vertex_component.begin(), division.vertex_component.end())),
      (std::vector<Index>{0, 0, 0, -1, -1, 1, 1, 1, 1}));
  EXPECT_EQ(division.n_cut_interfaces, 0);
  EXPECT_EQ(division.imbalance(), 1);
  const PolygonMesh grid = quad_grid(4, 3);
  const MeshDivision halves = divide(grid, 2, in_blocks(12, 2));
  EXPECT_EQ(halves.n_cut_interfaces, 5);  // two rows of four, cut in the middle of the second
  EXPECT_EQ(divide(grid, 3, std::vector<Index>(12, 1)).imbalance(), 3);
}

TEST(MeshPart, bad_divisions_are_refused) {
  const PolygonMesh mesh = quad_grid(2, 1);
  EXPECT_THROW(divide(mesh, 0, std::vector<Index>{0, 0}), InvalidOption);
  EXPECT_THROW(divide(mesh, 2, std::vector<Index>{0}), InvalidOption);
  EXPECT_THROW(divide(mesh, 2, std::vector<Index>{0, 2}), InvalidOption);
  EXPECT_THROW(part_of(mesh, divide(mesh, 2, std::vector<Index>{0, 1}), 2), InvalidOption);
  const PolyhedralMesh hex = hex_grid(1);
  Array<FaceCells> none(6, FaceCells{-1, -1});
  EXPECT_THROW(
      PolyhedralMesh::from_face_cells(hex.points(), hex.face_mesh().faces(), hex.cells(), none),
      InvalidMesh);
}

}  // namespace
}  // namespace carat::test
