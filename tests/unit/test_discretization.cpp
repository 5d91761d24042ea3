#include <gtest/gtest.h>

#include "carat/base/error.h"
#include "carat/operators/registry.h"
#include "support/measures.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

TEST(Registry, unknown_names_list_the_known_ones) {
  try {
    discretize(cube(), "diamant");
    FAIL() << "nothing was thrown";
  } catch (const InvalidOption& e) {
    for (const SurfaceOperator* entry : surface_operators())
      EXPECT_NE(std::string(e.what()).find(entry->name), std::string::npos);
  }
  EXPECT_STREQ(surface_operators().front()->name, "diamond");
}

TEST(Registry, triangle_operators_name_the_other_face) {
  try {
    discretize(slit_face(), "cotan");
    FAIL() << "nothing was thrown";
  } catch (const InvalidMesh& e) {
    EXPECT_EQ(e.elements(), std::vector<Index>{0});
  }
}

TEST(Discretization, an_empty_mesh_gives_empty_matrices) {
  for (const SurfaceOperator* entry : surface_operators()) {
    const Discretization d = discretize(PolygonMesh(), entry->name);
    EXPECT_EQ(d.n_vertices(), 0);
    EXPECT_EQ(d.stiffness.nonZeros(), 0);
    EXPECT_EQ(d.divergence().rows(), 0);
    const PolygonMesh no_faces(Points::Zero(3, 3), Csr());
    for (const auto parts : {DiscretizationParts::Matrices, DiscretizationParts::Gradient})
      EXPECT_EQ(discretize(no_faces, entry->name, {.parts = parts}).stiffness.nonZeros(), 0);
  }
}

TEST(Discretization, parts_are_computed_on_request) {
  const PolygonMesh mesh = cube();
  const Discretization bare = discretize(mesh, "diamond", {.parts = DiscretizationParts::Matrices});
  EXPECT_EQ(bare.gradient.rows(), 0);
  EXPECT_THROW(bare.divergence(), InvalidOption);
  EXPECT_THROW(bare.apply_divergence(Vector::Zero(24)), InvalidOption);
  const Discretization with_gradient = discretize(mesh);
  EXPECT_THROW(with_gradient.element_vectors(Vector::Zero(24), 6), InvalidOption);
  const Discretization all = discretize(mesh, "diamond", {.parts = DiscretizationParts::Frames});
  EXPECT_EQ(all.frames.parts.size(), 24u);
  EXPECT_THROW(all.vertex_vectors(Vector::Zero(5)), InvalidOption);
  EXPECT_TRUE(same_bits(bare.stiffness, all.stiffness));
}

TEST(Discretization, hand_values_of_one_triangle) {
  // Right triangle with legs 1: a lone diamond triangle is covered by three boundary diamonds.
  const PolygonMesh mesh = make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  for (const SurfaceOperator* entry : surface_operators()) {
    const Discretization d = discretize(mesh, entry->name);
    Matrix expected(3, 3);
    expected << 1, -0.5, -0.5, -0.5, 0.5, 0, -0.5, 0, 0.5;
    EXPECT_LT((Matrix(d.stiffness) - expected).cwiseAbs().maxCoeff(), 1e-15) << entry->name;
    EXPECT_NEAR(d.mass.sum(), 0.5, 1e-15);
    EXPECT_LT((d.lumped_mass().array() - 0.5 / 3).abs().maxCoeff(), 1e-15);
  }
}

TEST(Discretization, frames_are_orthonormal_and_cover_the_area) {
  const PolygonMesh mesh = tetrahedron();
  const Discretization d = discretize(mesh, "diamond", {.parts = DiscretizationParts::Frames});
  Vector area = Vector::Zero(d.n_samples());
  ASSERT_EQ(d.frames.axes.size(), d.frames.parts.size());
  for (std::size_t k = 0; k < d.frames.parts.size(); ++k) {
    const GradientFrames::Part& part = d.frames.parts[k];
    const auto& axes = d.frames.axes[k];
    area[part.sample] += part.measure;
    EXPECT_NEAR(axes.col(0).norm(), 1, 1e-14);
    EXPECT_NEAR(axes.col(1).norm(), 1, 1e-14);
    EXPECT_NEAR(axes.col(0).dot(axes.col(1)), 0, 1e-14);
    const auto [v1, v2] = mesh.edges().vertices[part.sample];
    EXPECT_GT(axes.col(0).dot(mesh.point(v2) - mesh.point(v1)), 0)
        << "from the lower-numbered vertex";
  }
  EXPECT_LT((area - d.sample_measure).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace carat::test
