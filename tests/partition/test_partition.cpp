#include <gtest/gtest.h>

#include <algorithm>

#include "carat/base/error.h"
#include "carat/distributed/partition.h"
#include "support/mesh_parts.h"

namespace carat::test {
namespace {

TEST(Partition, parts_are_even_and_cuts_are_short) {
  // A square of n^2 faces in 4 parts: two straight cuts have 2 n edges.
  const PolygonMesh square = quad_grid(40, 40);
  const MeshDivision of_square = divide(square, 4, partition(square, 4));
  EXPECT_LT(of_square.imbalance(), 1.06);
  EXPECT_LT(of_square.n_cut_interfaces, 3 * 40);
  const PolyhedralMesh cube = hex_grid(12);
  const MeshDivision of_cube = divide(cube, 3, partition(cube, 3));
  EXPECT_LT(of_cube.imbalance(), 1.06);
  EXPECT_LT(of_cube.n_cut_interfaces, 3 * 144);
}

TEST(Partition, all_meshes_get_parts_that_exist) {
  const auto check = [](const auto& meshes) {
    for (const auto& [name, mesh] : meshes)
      for (const Index n_parts : {1, 2, 3, 7}) {
        SCOPED_TRACE(name);
        const std::vector<Index> parts = partition(mesh, n_parts);
        const MeshDivision division = divide(mesh, n_parts, parts);
        EXPECT_EQ(division.elements.indices.size(), static_cast<std::size_t>(n_elements(mesh)));
        for (int again = 0; again < 5; ++again) EXPECT_EQ(parts, partition(mesh, n_parts));
      }
  };
  check(surfaces_to_divide());
  check(volumes_to_divide());
  EXPECT_TRUE(partition(PolygonMesh(), 3).empty());
}

TEST(Partition, no_parts_are_refused) {
  EXPECT_THROW(partition(quad_grid(2, 2), 0), InvalidOption);
}

}  // namespace
}  // namespace carat::test
