#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "carat/kernels/virtual_cell.h"
#include "carat/kernels/virtual_cell_block.h"

namespace carat::test {
namespace {

constexpr int kFaces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                              {2, 3, 7, 6}, {0, 4, 7, 3}, {1, 2, 6, 5}};

/// A cube that is bent by `bend` of its sides, as both kernels take it.
CellGeometry hexahedron(double bend, HexahedronBlock& block, int lane) {
  Points x(8, 3);
  x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  x += bend * Points::Random(8, 3);
  const auto put = [&](double(&to)[3][kBlockCells], const Vec3& value) {
    for (int k = 0; k < 3; ++k) to[k][lane] = value[k];
  };
  CellGeometry cell;
  const Vec3 anchor = x.row(0).transpose();
  for (Index i = 0; i < 8; ++i) {
    cell.vertices.emplace_back(Vec3(x.row(i).transpose()) - anchor);
    put(block.position[i], cell.vertices.back());
  }
  for (int f = 0; f < 6; ++f) {
    Vec3 origin = Vec3::Zero();
    std::vector<Index> face;
    for (const int v : kFaces[f]) {
      face.push_back(v);
      origin += 0.25 * x.row(v).transpose();
    }
    cell.face_points.emplace_back(origin - anchor);
    put(block.position[8 + f], cell.face_points.back());
    const FaceMoment m = face_moment(x, face, origin);
    cell.moments.push_back(m);
    const double values[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
    for (int k = 0; k < 6; ++k) block.moment[f][k][lane] = values[k];
    // Half of the faces are given the other way round.
    const double sign = f % 2 == 0 ? 0.5 : -0.5;
    if (sign < 0) std::reverse(face.begin(), face.end());
    block.sign[f][lane] = sign;
    Vec3 previous = Vec3(x.row(face.back()).transpose()) - origin;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 next = Vec3(x.row(face[i]).transpose()) - origin;
      put(block.corner[f][i], next);
      const Vec3 normal = sign * previous.cross(next);
      cell.virtual_planes.push_back({normal, normal.dot(cell.face_points.back())});
      previous = next;
    }
  }
  return cell;
}

TEST(VirtualCellBlock, has_the_bits_of_the_kernel_for_one_cell) {
  int regular = 0, others = 0;
  for (const bool centroid : {false, true})
    for (const double bend : {0.0, 0.05, 0.2, 0.5})
      for (int repetition = 0; repetition < 50; ++repetition) {
        HexahedronBlock block{};
        std::vector<CellGeometry> cells;
        // The last lane is a cell without volume.
        for (int l = 0; l + 1 < kBlockCells; ++l) cells.push_back(hexahedron(bend, block, l));
        const unsigned unsound = virtual_cell_block(block, centroid);
        EXPECT_TRUE(unsound >> (kBlockCells - 1) & 1U);
        VirtualCellKernel kernel(
            {.point = centroid ? VirtualPoint::Centroid : VirtualPoint::AreaMinimizer});
        for (std::size_t l = 0; l < cells.size(); ++l) {
          double weights[14];
          const bool sound = kernel.compute(cells[l], weights) == VirtualVertexStatus::Regular;
          EXPECT_EQ(unsound >> l & 1U, sound ? 0U : 1U);
          ++(sound ? regular : others);
          for (int i = 0; sound && i < 14; ++i) EXPECT_EQ(block.weight[i][l], weights[i]);
        }
      }
  EXPECT_GT(regular, 1000);
  EXPECT_GT(others, 20);
}

}  // namespace
}  // namespace carat::test
