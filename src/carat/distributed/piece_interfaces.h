#pragma once
// Where the pieces of several processes meet. Seen by this folder's sources alone; everything here
// is collective.

#include <cstdint>
#include <vector>

#include "carat/distributed/piece_numbers.h"
#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// An element of this process, by its place in the piece, which another process needs in its halo.
struct HaloElement {
  int process;
  Index element;
  friend auto operator<=>(const HaloElement&, const HaloElement&) = default;
};

/// What the whole mesh knows of a piece's interfaces.
struct InterfaceBook {
  /// Of edges or faces, of which there may be more than Index can number; -1: a face that is not
  /// numbered.
  std::vector<std::int64_t> numbers;
  std::vector<bool> own;          ///< brought by this process
  std::vector<HaloElement> halo;  ///< ascending, each once
  /// Volumes: the faces as vertices' numbers in the whole mesh, as its lowest cell names them, and
  /// the numbers of the cells on their sides.
  Csr faces;
  Array<FaceCells> sides;
};

/// \param vertices  in the whole mesh
/// \param elements  in the whole mesh
/// \param first     number of the first interface
InterfaceBook keep_interfaces(const PolygonMesh& mesh, const Numbering& vertices,
                              const Numbering& elements, std::int64_t first);
/// \param ids  of the faces; empty: they are matched by vertices, and numbered as cells name them
InterfaceBook keep_interfaces(const PolyhedralMesh& mesh, const Numbering& vertices,
                              const Numbering& elements, const std::vector<std::int64_t>& ids,
                              bool have_ids, std::int64_t first);

}  // namespace carat
