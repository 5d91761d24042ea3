#include <gtest/gtest.h>

#include "carat/assembly/row_assembly.h"
#include "carat/base/error.h"
#include "carat/operators/surface/incidence.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

TEST(Pattern, rows_of_a_face_hold_its_vertices_once) {
  const PolygonMesh mesh = face_with_a_repeated_vertex();
  const SparseMatrix pattern = face_pattern(surface_incidence(mesh), 1);
  EXPECT_EQ(pattern.nonZeros(), 25);
  for (Index row = 0; row < 5; ++row)
    for (Index k = 0; k < 5; ++k)
      EXPECT_EQ(pattern.innerIndexPtr()[pattern.outerIndexPtr()[row] + k], k);
}

TEST(Pattern, columns_ascend_for_any_number_of_threads) {
  const PolygonMesh mesh = quad_grid(60, 50);  // enough vertices to be split
  const SparseMatrix one = face_pattern(surface_incidence(mesh), 1);
  for (const int threads : {2, 3, 8}) {
    const SparseMatrix many = face_pattern(surface_incidence(mesh), threads);
    ASSERT_EQ(many.nonZeros(), one.nonZeros());
    EXPECT_TRUE(std::equal(one.innerIndexPtr(), one.innerIndexPtr() + one.nonZeros(),
                           many.innerIndexPtr()));
  }
  for (Index row = 0; row < one.rows(); ++row)
    EXPECT_TRUE(std::is_sorted(one.innerIndexPtr() + one.outerIndexPtr()[row],
                               one.innerIndexPtr() + one.outerIndexPtr()[row + 1]));
}

TEST(Pattern, more_entries_than_32_bits_are_refused_before_allocation) {
  const Array<Index> sizes(3, 1'000'000'000);
  try {
    allocate_rows(3, 1'000'000'000, sizes, "a test matrix");
    FAIL() << "nothing was thrown";
  } catch (const InvalidMesh& e) {
    EXPECT_NE(std::string(e.what()).find("a test matrix would have 3000000000"), std::string::npos)
        << e.what();
  }
}

TEST(FaceBlocks, sum_of_local_matrices_and_their_row_sums) {
  const PolygonMesh mesh = quad_grid(2, 1);
  const SurfaceIncidence incidence = surface_incidence(mesh);
  const auto local = [](Index f, Index a, Index b) { return 100.0 * (f + 1) + 10 * a + b; };
  Matrix expected = Matrix::Zero(6, 6);
  for (Index f = 0; f < 2; ++f)
    for (Index a = 0; a < 4; ++a)
      for (Index b = 0; b < 4; ++b) expected(mesh.face(f)[a], mesh.face(f)[b]) += local(f, a, b);
  SparseMatrix full = face_pattern(incidence, 1);
  assemble_face_blocks(full, incidence, false, 1, local);
  EXPECT_EQ(Matrix(full), expected);
  SparseMatrix lumped = diagonal_pattern(6);
  assemble_face_blocks(lumped, incidence, true, 1, local);
  EXPECT_EQ(Matrix(lumped), Matrix(expected.rowwise().sum().asDiagonal()));
}

}  // namespace
}  // namespace carat::test
