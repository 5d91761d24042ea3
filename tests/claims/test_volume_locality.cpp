// Locality in volumes: which entries exist, predicted from the connectivity by brute force.
// [BBA21 section 7]: the diamond couples the vertices of all cells that share a face with, or are,
// a cell of the vertex; BHKB20 and linear elements only those of common cells.

#include <set>

#include "support/volume_claim_cases.h"
#include "support/volume_measures.h"

namespace carat::test {
namespace {

using Columns = std::vector<std::set<Index>>;

/// The vertices of a cell, from its faces.
std::set<Index> vertices_of(const PolyhedralMesh& mesh, Index c) {
  std::set<Index> vertices;
  for (const Index f : mesh.cell(c)) vertices.insert(mesh.face(f).begin(), mesh.face(f).end());
  return vertices;
}

Columns predicted_columns(const PolyhedralMesh& mesh, bool cell_local) {
  Columns columns(static_cast<std::size_t>(mesh.n_vertices())), cells;
  for (Index c = 0; c < mesh.n_cells(); ++c) cells.push_back(vertices_of(mesh, c));
  const auto couple = [&](Index c, Index d) {
    for (const Index v : cells[c]) columns[v].insert(cells[d].begin(), cells[d].end());
  };
  for (Index c = 0; c < mesh.n_cells(); ++c) couple(c, c);
  if (cell_local) return columns;
  std::vector<Index> seen(static_cast<std::size_t>(mesh.n_faces()), -1);
  for (Index c = 0; c < mesh.n_cells(); ++c)
    for (const Index f : mesh.cell(c)) {
      if (seen[f] >= 0) {
        couple(c, seen[f]);
        couple(seen[f], c);
      }
      seen[f] = c;
    }
  return columns;
}

void expect_columns(const SparseMatrix& matrix, const Columns& predicted) {
  for (Index row = 0; row < matrix.rows(); ++row) {
    std::vector<Index> columns;
    for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
      columns.push_back(static_cast<Index>(entry.col()));
    const std::vector<Index> expected(predicted[row].begin(), predicted[row].end());
    ASSERT_EQ(columns, expected) << "row " << row;
  }
}

class VolumeLocality : public VolumeClaimTest {};

TEST_P(VolumeLocality, entries_are_exactly_those_predicted) {
  const PolyhedralMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  expect_columns(d.stiffness, predicted_columns(mesh, GetParam().entry->claims.face_local));
  if (d.mass.nonZeros() > mesh.n_vertices()) expect_columns(d.mass, predicted_columns(mesh, true));
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeLocality,
                         testing::ValuesIn(volume_claim_cases({0, 1},
                                                              [](const VolumeClaimCase& c) {
                                                                return c.options.jitter == 0;
                                                              })),
                         volume_case_name);

/// Row lengths inside a grid of n^3 hexahedra.
TEST(VolumeLocalityCounts, rows_inside_a_grid_of_hexahedra) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 1});
  const Discretization diamond = discretize(mesh), bunge = discretize(mesh, "bunge");
  Index checked = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 p = mesh.point(v);
    if (p.minCoeff() < 0.2 || p.maxCoeff() > 0.8) continue;
    ++checked;
    // 3^3 of the eight cells; the cells across a face add a layer of 3^2 on each of six sides.
    EXPECT_EQ(bunge.stiffness.row(v).nonZeros(), 27);
    EXPECT_EQ(diamond.stiffness.row(v).nonZeros(), 27 + 6 * 9);
  }
  EXPECT_GE(checked, 27);
}

}  // namespace
}  // namespace carat::test
