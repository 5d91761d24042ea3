#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "carat/kernels/diamond_3d.h"
#include "carat/kernels/face_diamond_block.h"

namespace carat::test {
namespace {

/// A jittered star-shaped face with its point and the tips below and above it.
struct Face {
  Points vertices;
  std::vector<Index> order;
  Vec3 point, below, above;

  Face(int valence, int seed) : vertices(valence, 3) {
    const auto noise = [&](int k) { return 0.2 * std::sin(12.9 * k + 3.7 * seed); };
    for (int i = 0; i < valence; ++i) {
      const double angle = 2 * M_PI * i / valence;
      vertices.row(i) << std::cos(angle) + noise(3 * i), std::sin(angle) + noise(3 * i + 1),
          noise(3 * i + 2);
      order.push_back(i);
    }
    point = {noise(40) / 4, noise(41) / 4, noise(42) / 4};
    below = {noise(50), noise(51), noise(52) - 0.7};
    above = {noise(60), noise(61), noise(62) + 0.8};
  }
};

/// The lanes of a block of faces that lie behind each other in one array of points.
struct Block {
  std::vector<Face> faces;
  Points points;
  std::array<std::vector<Index>, kBlockDiamondFaces> order;
  FaceDiamonds result;
  unsigned degenerate;

  Block(int valence, std::vector<Face> given, double share) : faces(std::move(given)) {
    points.resize(kBlockDiamondFaces * valence, 3);
    std::array<FaceDiamondInput, kBlockDiamondFaces> input;
    for (int l = 0; l < kBlockDiamondFaces; ++l) {
      const Face& face = faces[l];
      points.middleRows(l * valence, valence) = face.vertices;
      for (const Index v : face.order) order[l].push_back(l * valence + v);
      input[l] = {order[l].data(), face.point.data(), face.below.data(), face.above.data(), share};
    }
    degenerate = face_diamond_block(valence, points.data(), input.data(), 1e-14, result);
  }
};

std::vector<Face> regular_faces(int valence) {
  std::vector<Face> faces;
  for (int l = 0; l < kBlockDiamondFaces; ++l) faces.emplace_back(valence, l);
  return faces;
}

class FaceDiamondBlock : public testing::TestWithParam<int> {};

TEST_P(FaceDiamondBlock, has_the_sums_over_the_diamonds_of_every_face) {
  const int valence = GetParam();
  const Block block(valence, regular_faces(valence), 6);
  ASSERT_EQ(block.degenerate, 0U);
  for (int l = 0; l < kBlockDiamondFaces; ++l) {
    const Face& face = block.faces[l];
    // Energy and masses over the vertices, the face point and u_above - u_below.
    Matrix energy = Matrix::Zero(valence + 2, valence + 2);
    Vector mass = Vector::Zero(valence + 2);
    for (int i = 0; i < valence; ++i) {
      const int j = (i + 1) % valence;
      const Diamond3d d =
          diamond_3d(face.vertices.row(i).transpose(), face.vertices.row(j).transpose(), face.point,
                     face.below, face.above, 1e-14);
      ASSERT_GT(d.volume(), 0);
      EXPECT_EQ(block.result.volume[i][l], d.volume()) << "the same bits";
      const Eigen::Matrix<double, 3, 5> g = diamond_gradient(d);
      Matrix gradient = Matrix::Zero(3, valence + 2);
      gradient.col(i) = g.col(0);
      gradient.col(j) = g.col(1);
      gradient.col(valence) = g.col(2);
      gradient.col(valence + 1) = g.col(4);
      energy += d.volume() * gradient.transpose() * gradient;
      for (const int k : {i, j, valence}) mass[k] += d.volume() / 6;
      mass[valence + 1] += d.volume() / 4;
    }
    const FaceDiamonds& sums = block.result;
    Matrix found = Matrix::Zero(valence + 2, valence + 2);
    const auto set = [&](int a, int b, double value) {
      found(a, b) += value;
      if (a != b) found(b, a) += value;
    };
    for (int i = 0; i < valence; ++i) {
      set(i, i, sums.diagonal[i][l]);
      set(i, (i + 1) % valence, -sums.side[i][l]);
      set(i, valence, -sums.spoke[i][l]);
      set(i, valence + 1, sums.tip[i][l]);
      EXPECT_NEAR(sums.mass[i][l], mass[i], 1e-15);
    }
    set(valence, valence, sums.point_diagonal[l]);
    set(valence, valence + 1, sums.point_tip[l]);
    set(valence + 1, valence + 1, sums.gamma[l]);
    EXPECT_LT((found - energy).norm(), 1e-14 * energy.norm()) << "face " << l;
    EXPECT_NEAR(sums.point_mass[l], mass[valence], 1e-14);
    EXPECT_NEAR(sums.tip_mass[l], mass[valence + 1], 1e-14);
  }
}

TEST_P(FaceDiamondBlock, knows_degenerate_faces_and_a_face_does_not_depend_on_its_block) {
  const int valence = GetParam();
  std::vector<Face> faces = regular_faces(valence);
  faces[2].vertices.row(1) = faces[2].vertices.row(0);  // a side without length
  std::swap(faces[5].below, faces[5].above);            // inverted
  faces[7].above = faces[7].below;                      // no height
  faces[1] = faces[3];
  const Block block(valence, faces, 4), regular(valence, regular_faces(valence), 4);
  EXPECT_EQ(block.degenerate, 1U << 2 | 1U << 5 | 1U << 7);
  for (int i = 0; i < valence; ++i) {
    EXPECT_EQ(block.result.diagonal[i][1], regular.result.diagonal[i][3]);
    EXPECT_EQ(block.result.tip[i][1], regular.result.tip[i][3]);
    EXPECT_EQ(block.result.mass[i][1], regular.result.mass[i][3]);
  }
  EXPECT_EQ(block.result.gamma[1], regular.result.gamma[3]);
}

INSTANTIATE_TEST_SUITE_P(Valences, FaceDiamondBlock, testing::Values(3, 4, 5, 6, 8));

}  // namespace
}  // namespace carat::test
