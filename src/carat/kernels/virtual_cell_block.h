#pragma once
// The common case of VirtualCellKernel for several hexahedra at a time.

namespace carat {

/// Cells that a block holds.
inline constexpr int kBlockCells = 8;

/// Hexahedra, one lane a cell, as CellGeometry has them: all but the corners relative to a vertex
/// of the cell.
struct alignas(64) HexahedronBlock {
  static constexpr int kVertices = 8, kFaces = 6, kCorners = 4;
  double position[kVertices + kFaces][3][kBlockCells];  ///< vertices, then face points
  double moment[kFaces][6][kBlockCells];                ///< xx, yy, zz, xy, xz, yz
  double corner[kFaces][kCorners][3][kBlockCells];      ///< relative to the face point
  double sign[kFaces][kBlockCells];                     ///< half of that of the faces' normals
  double weight[kVertices + kFaces][kBlockCells];       ///< receives the weights
};

/// The weights of VirtualCellKernel, with the same bits on every processor.
/// \return bit c set: cell c is degenerate or its point flips a virtual tetrahedron; its weights
///         are not valid and VirtualCellKernel has to be asked
unsigned virtual_cell_block(HexahedronBlock& block, bool centroid);

}  // namespace carat
