#pragma once
// Vectors at vertices and elements from gradient samples that are spread over the parts of a mesh.

#include "carat/distributed/number_exchange.h"
#include "carat/mesh/mesh_part.h"
#include "carat/operators/discretization.h"

namespace carat {

/// The part's elements in the order in which its discretization numbers them, by their numbers in
/// the whole mesh: all of the part, or its own ones alone for operators within single elements.
Array<Index> discretized_elements(const PartNumbers& numbers, const Discretization& discretization);

/// An element's samples may be those of several parts, as may a vertex's: their shares are summed.
class PartFields {
 public:
  /// Collective. \param discretization  of discretize_part(), with its frames; referred to
  PartFields(const PartNumbers& numbers, const Discretization& discretization);

  /// Collective. Discretization::vertex_vectors() of the whole mesh, at the part's vertices.
  Points vertex_vectors(const Vector& vectors) const;
  /// Collective. Discretization::element_vectors(), one row an element of the part; right in its
  /// own ones.
  Points element_vectors(const Vector& vectors) const;
  /// Collective. Discretization::element_directions(), the part's rows.
  /// \throws InvalidOption  Shared
  Vector element_directions(const Vector& vectors) const;

 private:
  VectorSums element_sums(const Vector& vectors) const;

  const PartNumbers& numbers_;
  const Discretization& discretization_;
  Array<Index> element_ids_;
  NumberExchange vertices_, elements_;
};

/// Edges of the whole mesh, each counted once.
struct EdgeLengths {
  std::int64_t count = 0;
  double sum = 0, longest = 0;  // [length]
};

/// Collective. In volumes of the edges of cells.
EdgeLengths edge_lengths(const MeshPart<PolygonMesh>& part);
EdgeLengths edge_lengths(const MeshPart<PolyhedralMesh>& part);

}  // namespace carat
