// Matrices of independent implementations on five small volume meshes; data/README.md gives their
// provenance. Agreement is max |A - B| / max |B| over all entries; the values are good to 1e-12.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "carat/operators/registry.h"
#include "carat/prolongation/virtual_cells.h"
#include "support/volume_reference.h"

namespace carat {
namespace {

constexpr double kAgreement = 1e-10;

class VolumeReference : public testing::TestWithParam<const char*> {
 protected:
  std::string path(const std::string& file) const {
    return std::string(CARAT_REFERENCE_DATA) + "/" + GetParam() + "/" + file;
  }
  PolyhedralMesh mesh() const { return test::read_plain_ovm(path("mesh.ovm")); }

  void expect_agreement(const SparseMatrix& matrix, const std::string& name) const {
    const Matrix expected = test::read_dense_mtx(path(name + ".mtx"));
    ASSERT_EQ(matrix.rows(), expected.rows());
    ASSERT_EQ(matrix.cols(), expected.cols());
    const double difference =
        (Matrix(matrix) - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
    EXPECT_LT(difference, kAgreement) << name;
  }
  static DiscretizationOptions options(VirtualPoint point) {
    DiscretizationOptions result;
    result.virtual_vertex = {point, AffineWeights::MinimumNorm, true};
    return result;
  }
  void expect_bunge(VirtualPoint point, const std::string& prefix) const {
    DiscretizationOptions opts = options(point);
    opts.mass = MassKind::Lumped;
    const Discretization d = discretize(mesh(), "bunge", opts);
    expect_agreement(d.stiffness, prefix + "_stiffness");
    expect_agreement(d.mass, prefix + "_mass_lumped");
    // The consistent mass has the same row sums.
    opts.mass = MassKind::Full;
    const Vector sums = discretize(mesh(), "bunge", opts).lumped_mass();
    EXPECT_LT((sums - Vector(d.mass.diagonal())).cwiseAbs().maxCoeff(),
              kAgreement * sums.maxCoeff());
  }
  void expect_diamond(VirtualPoint point, const std::string& prefix) const {
    const Discretization d = discretize(mesh(), "diamond", options(point));
    expect_agreement(d.stiffness, prefix + "_stiffness");
    expect_agreement(d.mass, prefix + "_mass");
  }
};

TEST_P(VolumeReference, prolongation) {
  const PolyhedralMesh m = mesh();
  VirtualCells virtuals;
  update_virtual_cells(m, m.points(), options(VirtualPoint::AreaMinimizer).virtual_vertex, 0,
                       virtuals);
  const SparseMatrix p = prolongation_matrix(m, virtuals);
  expect_agreement(p, "prolongation");
  const Points all = p * m.points();
  EXPECT_LT((all.middleRows(m.n_vertices(), m.n_faces()) - virtuals.face_points).norm(), 1e-13);
  EXPECT_LT((all.bottomRows(m.n_cells()) - virtuals.cell_points).norm(), 1e-13);
}

TEST_P(VolumeReference, diamond) { expect_diamond(VirtualPoint::AreaMinimizer, "diamond"); }

TEST_P(VolumeReference, diamond_with_centroids) {
  expect_diamond(VirtualPoint::Centroid, "diamond_centroid");
}

TEST_P(VolumeReference, bunge) { expect_bunge(VirtualPoint::AreaMinimizer, "bunge"); }

TEST_P(VolumeReference, bunge_with_centroids) {
  expect_bunge(VirtualPoint::Centroid, "bunge_centroid");
}

INSTANTIATE_TEST_SUITE_P(Meshes, VolumeReference,
                         testing::Values("tet_cube", "hex_cube", "pyr_cube", "prism_cube",
                                         "poly_cube"),
                         [](const auto& test) { return std::string(test.param); });

class TetReference : public VolumeReference {};

TEST_P(TetReference, cotan) {
  expect_agreement(discretize(mesh(), "primal_tet").stiffness, "cotan_stiffness");
  const Discretization dual = discretize(mesh(), "dual_tet");
  expect_agreement(dual.stiffness, "dual_tet_stiffness");
  expect_agreement(dual.mass, "dual_tet_mass");
}

INSTANTIATE_TEST_SUITE_P(Meshes, TetReference, testing::Values("tet_cube"),
                         [](const auto& test) { return std::string(test.param); });

class DdfvReference : public VolumeReference {
 protected:
  /// The files number edges as the mesh file does, the library by their vertices.
  std::vector<Index> file_rows(Index n_rows) const {
    const PolyhedralMesh m = mesh();
    std::vector<Index> rows;
    for (Index row = 0; row < n_rows - m.n_edges(); ++row) rows.push_back(row);
    const Index first = static_cast<Index>(rows.size());
    const auto& sorted = m.face_mesh().edges().vertices;
    std::ifstream file(path("mesh.ovm"));
    std::string word;
    while (file >> word && word != "Edges") {
    }
    Index n = 0;
    file >> n;
    for (std::array<Index, 2> e; n > 0 && file >> e[0] >> e[1]; --n) {
      if (e[0] > e[1]) std::swap(e[0], e[1]);
      rows.push_back(first + static_cast<Index>(std::lower_bound(sorted.begin(), sorted.end(), e) -
                                                sorted.begin()));
    }
    return rows;
  }
  /// \param has_edges  the last unknowns are those of the edges
  void expect_tight(const SparseMatrix& matrix, const std::string& name,
                    bool has_edges = false) const {
    const Matrix expected = test::read_dense_mtx(path(name + ".mtx"));
    ASSERT_EQ(matrix.rows(), expected.rows());
    Matrix found(matrix);
    if (has_edges) {
      const std::vector<Index> rows = file_rows(static_cast<Index>(matrix.rows()));
      ASSERT_EQ(static_cast<Eigen::Index>(rows.size()), matrix.rows());
      found = Matrix(found(rows, rows));
    }
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff())
        << name;
  }
};

TEST_P(DdfvReference, ceve) {
  const Discretization d = discretize(mesh(), "ceve");
  expect_tight(d.stiffness, "ceve_stiffness");
  expect_tight(d.mass, "ceve_weights");
  const Discretization kept = discretize(mesh(), "ceve", {.boundary_unknowns = true});
  expect_tight(kept.stiffness, "ceve_bface_stiffness");
  expect_tight(kept.mass, "ceve_bface_weights");
}

TEST_P(DdfvReference, cevefe) {
  const Discretization d = discretize(mesh(), "cevefe");
  // That of the tetrahedra is left out for its size.
  if (GetParam() != std::string("tet_cube")) expect_tight(d.stiffness, "cevefe_stiffness", true);
  expect_tight(d.mass, "cevefe_weights", true);
}

INSTANTIATE_TEST_SUITE_P(Meshes, DdfvReference,
                         testing::Values("hex_cube", "poly_cube", "prism_cube", "tet_cube"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace carat
