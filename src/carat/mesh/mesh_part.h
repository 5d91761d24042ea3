#pragma once
// Parts of a mesh for processes that share the work: who brings what, and the mesh that each needs.

#include <cstdint>
#include <span>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// A mesh divided into parts. *Elements* are the faces of a surface or the cells of a volume,
/// *interfaces* the edges of a surface or the faces of a volume.
///
/// Every element, interface with an element, and vertex belongs to exactly one part. Where the
/// elements of an interface or vertex are of several parts, the sum of their numbers chooses among
/// them, so that these have about equal shares.
struct MeshDivision {
  Index n_parts = 0;
  Array<Index> element_part;    ///< element -> its part
  Csr elements;                 ///< part -> its elements, ascending
  Array<Index> interface_part;  ///< interface -> the part that brings it; -1: it has no element
  Array<Index> vertex_part;     ///< vertex -> its part; without an element: 0
  /// Numbers of the vertices one part after the other, in each by their own number.
  Array<Index> vertex_row;
  Array<Index> first_row;  ///< part -> its first row, n_parts + 1 numbers
  /// Vertex -> its connected component by elements, numbered by their lowest vertices; -1: without
  /// an element.
  Array<Index> vertex_component;
  Index n_components = 0;
  Index n_cut_interfaces = 0;  ///< those with elements of several parts

  /// Most elements of a part over their mean; 1: even.
  double imbalance() const;
};

/// The rule by which an interface or vertex goes to one of the parts of its elements.
/// \param parts            of its elements, in their order, as often as they have it
/// \param sum_of_elements  of their numbers
/// \return                 -1: it has no element
Index choose_part(std::span<const Index> parts, std::uint64_t sum_of_elements);

/// \param n_parts       at least 1; parts may be empty
/// \param element_part  element -> part
/// \throws InvalidOption  another number of elements, a part that does not exist
/// Cost: O(sizes).
MeshDivision divide(const PolygonMesh& mesh, Index n_parts, std::span<const Index> element_part);
MeshDivision divide(const PolyhedralMesh& mesh, Index n_parts, std::span<const Index> element_part);

/// What a part's mesh is in the whole one. Numbers of the part follow those of the whole mesh, of
/// which Index numbers the vertices and elements. A mesh in parts may have more interfaces than
/// that.
struct PartNumbers {
  Index part = 0, n_parts = 1;
  Index first_row = 0, end_row = 0;  ///< the part's own vertices
  Index n_vertices = 0;              ///< of the whole mesh
  Index n_components = 0;            ///< of the whole mesh
  Array<Index> vertices;             ///< here -> in the whole mesh, ascending
  Array<Index> vertex_rows;          ///< MeshDivision::vertex_row
  Array<Index> vertex_components;    ///< MeshDivision::vertex_component
  Array<Index> elements;             ///< here -> in the whole mesh, ascending
  Array<std::int64_t> interfaces;    ///< here -> in the whole mesh, ascending
  std::vector<bool> own_elements;    ///< not those of the halo
  std::vector<bool> own_interfaces;  ///< brought by this part

  bool own_vertex(Index v) const { return vertex_rows[v] >= first_row && vertex_rows[v] < end_row; }
};

/// A part's own elements and a halo of those across their interfaces. A mesh like any other: what
/// is at its outer border looks like a boundary, but no own interface lies there.
template <class Mesh>
struct MeshPart {
  Mesh mesh;
  PartNumbers numbers;
};

/// The own elements alone, with the vertices numbered as in the part: what methods need that couple
/// the vertices of single elements. Their matrices add up over all parts.
PolygonMesh own_mesh(const MeshPart<PolygonMesh>& part);
PolyhedralMesh own_mesh(const MeshPart<PolyhedralMesh>& part);

/// Cost: that of the part, n log n.
MeshPart<PolygonMesh> part_of(const PolygonMesh& mesh, const MeshDivision& division, Index part);
MeshPart<PolyhedralMesh> part_of(const PolyhedralMesh& mesh, const MeshDivision& division,
                                 Index part);

}  // namespace carat
