// Locality: which entries exist, predicted from the connectivity by brute force.
// [BBA21 section 7]: the diamond couples the vertices of all faces that share an edge with, or
// are, a face of the vertex; BHKB20 and cotan only those of common faces.

#include <set>

#include "support/claim_cases.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

using Columns = std::vector<std::set<Index>>;

Columns predicted_columns(const PolygonMesh& mesh, bool face_local) {
  Columns columns(static_cast<std::size_t>(mesh.n_vertices()));
  const auto couple = [&](Index f, Index g) {
    for (const Index v : mesh.face(f)) columns[v].insert(mesh.face(g).begin(), mesh.face(g).end());
  };
  for (Index f = 0; f < mesh.n_faces(); ++f) couple(f, f);
  if (face_local) return columns;
  for (Index e = 0; e < mesh.n_edges(); ++e)
    for (const Index a : mesh.edges().corners.row(e))
      for (const Index b : mesh.edges().corners.row(e))
        couple(mesh.corner_faces()[a], mesh.corner_faces()[b]);
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

class Locality : public ClaimTest {};

TEST_P(Locality, entries_are_exactly_those_predicted) {
  const PolygonMesh mesh = GetParam().mesh();
  const Discretization d = discretization(mesh);
  const bool face_local = GetParam().entry->claims.face_local;
  expect_columns(d.stiffness, predicted_columns(mesh, face_local));
  if (d.mass.nonZeros() > mesh.n_vertices()) expect_columns(d.mass, predicted_columns(mesh, true));
}

INSTANTIATE_TEST_SUITE_P(Claims, Locality, testing::ValuesIn(claim_cases()), case_name);

TEST(LocalityCounts, thirteen_entries_a_row_on_the_regular_torus) {
  for (int level = 0; level < kLevels; ++level) {
    const PolygonMesh mesh = generate_mesh("torus-triangles", {.level = level});
    const Discretization d = discretize(mesh);
    for (Index row = 0; row < d.n_vertices(); ++row)
      ASSERT_EQ(d.stiffness.row(row).nonZeros(), 13) << "level " << level << ", row " << row;
    EXPECT_EQ(discretize(mesh, "cotan").stiffness.nonZeros(), 7 * mesh.n_vertices());
  }
}

TEST(LocalityCounts, unusual_connectivity) {
  for (const NamedMesh& named : unusual_meshes()) {
    SCOPED_TRACE(named.name);
    expect_columns(discretize(named.mesh).stiffness, predicted_columns(named.mesh, false));
    expect_columns(discretize(named.mesh, "bunge").stiffness, predicted_columns(named.mesh, true));
  }
}

}  // namespace
}  // namespace carat::test
