#include <algorithm>
#include <initializer_list>
#include <utility>

#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"

namespace carat {
namespace {

// A block is twice as high as wide and holds two L shapes, one turned by half a turn:
// the foot of each is as wide as the block and a quarter of it high; their common side leans, so
// that the mean of the six vertices, in the middle of the block, falls out of the L.
constexpr double kFoot = 0.25;  // of the block's height
constexpr double kLean = 0.15;  // of the block's width, to either side of its middle

struct Block {
  double left, right, bottom, top;
  bool mirrored;

  Vec3 at(double x, double y) const {
    const double s = mirrored ? 1 - x : x;
    return {s == 0   ? left
            : s == 1 ? right
                     : left + s * (right - left),
            y == 0   ? bottom
            : y == 1 ? top
                     : bottom + y * (top - bottom),
            0};
  }
};

/// Columns of blocks; every other column is mirrored, so that feet meet feet.
struct Blocks {
  Index columns, rows;
  double anisotropy;

  Block operator()(Index i, Index j) const {
    return {grade(double(i) / columns, anisotropy), grade(double(i + 1) / columns, anisotropy),
            double(j) / rows, double(j + 1) / rows, i % 2 == 1};
  }
};

}  // namespace

/// 6 * 2^level by 3 * 2^level blocks of two L shapes.
PolygonMesh generate_plane_lshape(const FamilyOptions& options) {
  const Index columns = lattice_size(options.level, 6, 12 * 0.5);
  const Blocks blocks{columns, columns / 2, options.anisotropy};
  // Row by row: the blocks' lower corners, the feet on their upright sides, two inner vertices.
  const Index row = 2 * (columns + 1) + 2 * columns;
  Points points(static_cast<Eigen::Index>(row) * blocks.rows + columns + 1, 3);
  Points kernel_points(2 * static_cast<Eigen::Index>(columns) * blocks.rows, 3);
  Csr faces;
  const auto add_face = [&](std::initializer_list<Index> face, bool mirrored) {
    faces.indices.insert(faces.indices.end(), face);
    if (mirrored) std::reverse(faces.indices.end() - 6, faces.indices.end());
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  };
  for (Index j = 0; j < blocks.rows; ++j) {
    const Index corners = j * row, feet = corners + columns + 1, inner = feet + columns + 1;
    for (Index i = 0; i < columns; ++i) {
      const Block block = blocks(i, j);
      const Index left = block.mirrored ? i + 1 : i, right = block.mirrored ? i : i + 1;
      const Index low = inner + 2 * i, high = low + 1;
      points.row(corners + left) = block.at(0, 0).transpose();
      points.row(corners + right) = block.at(1, 0).transpose();
      points.row(feet + left) = block.at(0, 1 - kFoot).transpose();
      points.row(feet + right) = block.at(1, kFoot).transpose();
      points.row(low) = block.at(0.5 - kLean, kFoot).transpose();
      points.row(high) = block.at(0.5 + kLean, 1 - kFoot).transpose();
      points.row(corners + row + left) = block.at(0, 1).transpose();
      points.row(corners + row + right) = block.at(1, 1).transpose();
      kernel_points.row(faces.n_rows()) = block.at(0.17, kFoot / 2).transpose();
      add_face({corners + left, corners + right, feet + right, low, high, feet + left},
               block.mirrored);
      kernel_points.row(faces.n_rows()) = block.at(1 - 0.17, 1 - kFoot / 2).transpose();
      add_face({corners + row + right, corners + row + left, feet + left, high, low, feet + right},
               block.mirrored);
    }
  }
  const PolygonMesh mesh(std::move(points), std::move(faces));
  return jitter_vertices(mesh, kSquare, options, &kernel_points);
}

}  // namespace carat
