#include <gtest/gtest.h>

#include "carat/apps/mean_curvature.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "support/measures.h"
#include "support/meshes.h"
#include "support/transforms.h"

namespace carat::test {
namespace {

TEST(MeanCurvature, of_a_sphere_is_the_inverse_radius_with_the_sign_of_its_normals) {
  const PolygonMesh unit = generate_mesh("sphere-hexagons", {.level = 2});
  for (const double radius : {0.25, 1.0, 40.0}) {
    const PolygonMesh mesh = unit.with_points(unit.points() * radius);
    const Vector h = mean_curvature(mesh, discretize(mesh), true).values;
    // 1 % is the discretisation error of this level.
    EXPECT_LT((h.array() * radius - 1).abs().maxCoeff(), 0.03);
    const PolygonMesh inside = flip_faces(mesh, 1);
    const Discretization d = discretize(inside);
    EXPECT_LT((mean_curvature(inside, d, true).values + h).cwiseAbs().maxCoeff() * radius, 1e-10);
    EXPECT_LT((mean_curvature(inside, d).values - h).cwiseAbs().maxCoeff() * radius, 1e-10);
  }
}

TEST(MeanCurvature, of_a_plane_is_zero_and_undefined_on_the_boundary) {
  const PolygonMesh mesh = move_rigidly(quad_grid(5, 4));
  const MeanCurvature h = mean_curvature(mesh, discretize(mesh));
  EXPECT_LT(h.values.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(h.undefined_vertices.size(), 18u);
}

TEST(MeanCurvature, does_not_depend_on_the_place) {
  const PolygonMesh mesh = generate_mesh("sphere-quads", {.level = 1});
  const Eigen::RowVector3d shift(2e6, -1e6, 3e6);
  const PolygonMesh far = mesh.with_points(mesh.points().rowwise() + shift);
  const PolygonMesh same = mesh.with_points(far.points().rowwise() - shift);
  const Vector a = mean_curvature(far, discretize(far)).values;
  const Vector b = mean_curvature(same, discretize(same)).values;
  // The mean that centres the distant mesh is rounded to 1e-10; constants are in the kernel.
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(MeanCurvature, loose_vertices_are_listed) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const MeanCurvature h = mean_curvature(mesh, discretize(mesh));
  EXPECT_EQ(h.undefined_vertices.size(), 9u);
  EXPECT_EQ(h.values.cwiseAbs().maxCoeff(), 0);
  EXPECT_THROW(mean_curvature(mesh, discretize(quad_grid(1, 1))), InvalidOption);
}

}  // namespace
}  // namespace carat::test
