#pragma once
// Counts and measures of a volume mesh: what `carat info` prints.

#include <array>
#include <vector>

#include "carat/base/diagnostics.h"
#include "carat/mesh/cell_kind.h"
#include "carat/mesh/polyhedral_mesh.h"
#include "carat/mesh/statistics.h"

namespace carat {

/// What there is to know about a volume mesh before computing on it.
struct VolumeStatistics {
  Index cells = 0;
  Index inner_faces = 0;                                 ///< between two cells
  Index boundary_faces = 0;                              ///< of one cell
  std::array<Index, kCellKinds.size()> cells_of_kind{};  ///< by CellKind
  std::vector<Index> cells_of_size;                      ///< [k] = number of cells with k faces
  Index components = 0;                                  ///< of cells, connected by shared faces
  Index vertex_components = 0;                           ///< of cells, connected by shared vertices
  double volume = 0;                                     ///< sum of the cells' volumes  [length^3]
  /// With sign. Faces that are not planar are cut into triangles about the mean of their
  /// vertices.  [length^3]
  Range cell_volume;
  /// Squared volume over cubed area, in units of Goldberg's bound for this number of faces: 1 for
  /// the regular tetrahedron, the cube and the regular dodecahedron, less for other cells; 0 where
  /// the volume is not positive.
  Range cell_quality;
  MeshStatistics all_faces;  ///< of all faces as one surface mesh: counts, edges, shapes, box
  MeshStatistics boundary;   ///< of boundary_surface(): area, components, non-manifold edges

  /// What deserves a look, with the ids. Cells: inverted_cells, flat_cells, turned_cells; faces:
  /// faces_without_cells, merged_faces, turned_faces, tiny_faces; short_edges; vertices:
  /// hanging_vertices, subdividing_vertices, unreferenced_vertices. Faces given twice that were
  /// not merged, as baffles are, count in all_faces.duplicate_faces.
  Diagnostics findings;
  /// False if the search for hanging vertices was given up; see hanging_vertices().
  bool hanging_vertices_complete = true;
};

/// Cost: O(corners), and O(n log n) for n corners of the boundary.
VolumeStatistics volume_statistics(const PolyhedralMesh& mesh);

}  // namespace carat
