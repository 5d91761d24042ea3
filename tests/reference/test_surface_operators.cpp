// Matrices of independent implementations on eight small meshes; data/README.md gives their
// provenance. Agreement is max |A - B| / max |B| over all entries; the values are good to 1e-12.

#include <gtest/gtest.h>

#include "carat/operators/registry.h"
#include "carat/prolongation/virtual_vertices.h"
#include "support/reference_files.h"

namespace carat {
namespace {

constexpr double kAgreement = 1e-10;

class SurfaceReference : public testing::TestWithParam<const char*> {
 protected:
  std::string path(const std::string& file) const {
    return std::string(CARAT_REFERENCE_DATA) + "/" + GetParam() + "/" + file;
  }
  PolygonMesh mesh() const { return test::read_plain_obj(path("mesh.obj")); }
  Matrix reference(const std::string& name) const {
    return test::read_dense_mtx(path(name + ".mtx"));
  }

  static double difference(const Matrix& a, const Matrix& b) {
    EXPECT_EQ(a.rows(), b.rows());
    EXPECT_EQ(a.cols(), b.cols());
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
  }
  static DiscretizationOptions options(VirtualPoint point) {
    DiscretizationOptions result;
    result.virtual_vertex = {point, AffineWeights::MinimumNorm, true};
    return result;
  }
};

TEST_P(SurfaceReference, prolongation) {
  const PolygonMesh m = mesh();
  const VirtualVertices v =
      virtual_vertices(m, m.points(), {VirtualPoint::AreaMinimizer, AffineWeights::MinimumNorm});
  EXPECT_LT(difference(prolongation_matrix(m, v.weights), reference("prolongation")), kAgreement);
}

TEST_P(SurfaceReference, diamond) {
  const PolygonMesh m = mesh();
  const Discretization d = discretize(m, "diamond", options(VirtualPoint::AreaMinimizer));
  EXPECT_LT(difference(d.stiffness, reference("diamond_stiffness")), kAgreement);
  EXPECT_LT(difference(d.mass, reference("diamond_mass")), kAgreement);
  EXPECT_LT(difference(d.gradient, reference("diamond_gradient")), kAgreement);
  const auto rows = test::read_csv(path("diamonds.csv"));
  ASSERT_EQ(static_cast<Index>(rows.size()), d.n_samples());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(m.edges().vertices[k][0] + 1, rows[k][0]);
    EXPECT_EQ(m.edges().vertices[k][1] + 1, rows[k][1]);
    EXPECT_NEAR(d.sample_measure[static_cast<Index>(k)], rows[k][2], kAgreement * rows[k][2]);
  }
}

TEST_P(SurfaceReference, diamond_with_centroids) {
  const Discretization d = discretize(mesh(), "diamond", options(VirtualPoint::Centroid));
  EXPECT_LT(difference(d.stiffness, reference("diamond_centroid_stiffness")), kAgreement);
  EXPECT_LT(difference(d.mass, reference("diamond_centroid_mass")), kAgreement);
}

TEST_P(SurfaceReference, bunge) {
  DiscretizationOptions opts = options(VirtualPoint::AreaMinimizer);
  const Discretization d = discretize(mesh(), "bunge", opts);
  EXPECT_LT(difference(d.stiffness, reference("bunge_stiffness")), kAgreement);
  EXPECT_LT(difference(d.mass, reference("bunge_mass")), kAgreement);
  opts.mass = MassKind::Lumped;
  EXPECT_LT(difference(discretize(mesh(), "bunge", opts).mass, reference("bunge_mass_lumped")),
            kAgreement);
}

TEST_P(SurfaceReference, alexa_wardetzky) {
  const Discretization d = discretize(mesh(), "alexa_wardetzky");
  EXPECT_LT(difference(d.stiffness, reference("alexa_wardetzky_stiffness")), kAgreement);
  EXPECT_LT(difference(d.mass, reference("alexa_wardetzky_mass")), kAgreement);
}

TEST_P(SurfaceReference, de_goes) {
  const Discretization d = discretize(mesh(), "de_goes");
  EXPECT_LT(difference(d.stiffness, reference("de_goes_stiffness")), kAgreement);
  EXPECT_LT(difference(d.mass, reference("de_goes_mass")), kAgreement);
}

INSTANTIATE_TEST_SUITE_P(Meshes, SurfaceReference,
                         testing::Values("tri_plane", "quad_plane", "poly_plane", "concave_plane",
                                         "tri_sphere", "quad_sphere", "hex_sphere", "saddle"),
                         [](const auto& test) { return std::string(test.param); });

class TriangleReference : public SurfaceReference {};

TEST_P(TriangleReference, cotan) {
  const Discretization d = discretize(mesh(), "cotan");
  EXPECT_LT(difference(d.stiffness, reference("cotan_stiffness")), kAgreement);
}

INSTANTIATE_TEST_SUITE_P(Meshes, TriangleReference, testing::Values("tri_plane", "tri_sphere"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace carat
