#pragma once
// What a part of a mesh brings to the operators of the whole mesh.

#include <string>

#include "carat/mesh/mesh_part.h"
#include "carat/operators/discretization.h"

namespace carat {

/// Operators over the vertices of `part.mesh` whose sum over all parts is that of the whole mesh;
/// gradient samples are the part's own. Nothing is exchanged with other parts.
/// \param options  cell_coefficient: of the cells of part.mesh
/// \throws InvalidOption      as discretize(); an operator with unknowns beyond the vertices
/// \throws InvalidMesh        as discretize()
/// \throws DegenerateElement  as discretize(), numbered as in the part
Discretization discretize_part(const MeshPart<PolygonMesh>& part, const std::string& operator_name,
                               const DiscretizationOptions& options = {});
Discretization discretize_part(const MeshPart<PolyhedralMesh>& part,
                               const std::string& operator_name,
                               const DiscretizationOptions& options = {});

/// The part's share of sparser_stiffness(). Empty (0 x 0): there is nothing sparser. Where the part
/// holds triangles alone and the mesh others too, a coefficient is sampled at slightly other
/// points.
/// \param discretization  of discretize_part(); its name and options are read
SparseMatrix sparser_part_stiffness(const MeshPart<PolygonMesh>& part,
                                    const Discretization& discretization);
SparseMatrix sparser_part_stiffness(const MeshPart<PolyhedralMesh>& part,
                                    const Discretization& discretization);

/// What a part brings to a matrix, and how much of it belongs to rows of other parts' vertices: all
/// that an assembly over several processes has to send.
struct PartShare {
  std::int64_t entries = 0, sent = 0;
  /// As coordinates: two indices and a value.
  std::int64_t bytes_sent() const { return 16 * sent; }
  PartShare& operator+=(const PartShare& other) {
    entries += other.entries;
    sent += other.sent;
    return *this;
  }
};
/// \param of_part  over the part's vertices; its zeros are not counted
PartShare share_of(const SparseMatrix& of_part, const PartNumbers& numbers);

}  // namespace carat
