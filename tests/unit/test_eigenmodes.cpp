#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "carat/apps/eigenmodes.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/operators/registry.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

const DiscretizationOptions kMatrices{.parts = DiscretizationParts::Matrices};

std::vector<Index> where(const std::vector<bool>& flags) {
  std::vector<Index> result;
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) result.push_back(static_cast<Index>(i));
  return result;
}

/// Sizes of the runs of values that differ by at most `gap`, relatively.
std::vector<Index> multiplicities(const Vector& values, double gap) {
  std::vector<Index> sizes{1};
  for (Index k = 1; k < values.size(); ++k) {
    if (values[k] - values[k - 1] > gap * values[k]) sizes.push_back(0);
    ++sizes.back();
  }
  return sizes;
}

TEST(Eigenmodes, sphere_has_odd_multiplicities) {
  const PolygonMesh mesh = generate_mesh("sphere-triangles", {.level = 3});
  const EigenPairs modes = eigenmodes(discretize(mesh, "diamond", kMatrices), 49);
  EXPECT_EQ(multiplicities(modes.values, 0.05), (std::vector<Index>{1, 3, 5, 7, 9, 11, 13}));
  EXPECT_EQ(modes.values[0], 0);
  for (Index l = 1, k = 1; l < 7; ++l)
    for (Index i = 0; i < 2 * l + 1; ++i, ++k)
      // Second order: the edges are 0.14 long, the waves 2 pi / l.
      EXPECT_NEAR(modes.values[k] / (l * (l + 1)), 1, 2e-3 * l) << k;
  EXPECT_LT(modes.residuals.maxCoeff(), 1e-9);
}

TEST(Eigenmodes, fixed_and_loose_vertices_stay_zero) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  const Discretization d = discretize(mesh);
  const EigenPairs modes = eigenmodes(d, 6, {5});
  EXPECT_EQ(modes.zero_modes, 1) << "the triangle's; the square is held";
  for (const Index v : {3, 4, 5}) EXPECT_EQ(modes.vectors.row(v).cwiseAbs().maxCoeff(), 0);
  EXPECT_THROW(eigenmodes(d, 7, {5}), InvalidOption);
  EXPECT_THROW(eigenmodes(d, 1, {9}), InvalidOption);
  EXPECT_THROW(eigenmodes(d, 1, {-1}), InvalidOption);
}

TEST(Eigenmodes, cube_with_fixed_walls_has_the_multiplicities_of_three_waves) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 2});
  const Discretization d = discretize(mesh, "diamond", kMatrices);
  const EigenPairs modes = eigenmodes(d, 17, where(boundary_vertices(mesh)));
  // 3, 6, 9, 11, 12, 14 times pi^2 have 1, 3, 3, 3, 1, 6 functions. The grid keeps the symmetry of
  // the cube, which alone does not tie 11's three and 14's six together: 2 + 1 and 3 + 3.
  EXPECT_EQ(multiplicities(modes.values, 1e-8), (std::vector<Index>{1, 3, 3, 2, 1, 1, 3, 3}));
  EXPECT_EQ(modes.zero_modes, 0);
  EXPECT_LT(modes.residuals.maxCoeff(), 1e-9);
}

TEST(Eigenmodes, free_cube_has_the_constant_and_three_equal_waves) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 2});
  const EigenPairs modes = eigenmodes(discretize(mesh, "diamond", kMatrices), 8);
  EXPECT_EQ(modes.zero_modes, 1);
  EXPECT_EQ(modes.values[0], 0);
  EXPECT_EQ(multiplicities(modes.values, 1e-8), (std::vector<Index>{1, 3, 3, 1}));
  const double square = std::numbers::pi * std::numbers::pi;
  for (Index k = 1; k < 4; ++k) EXPECT_NEAR(modes.values[k] / square, 1, 0.02);
}

TEST(Eigenmodes, ball_approaches_the_zeros_of_spherical_bessel_functions) {
  // Least zeros of j_0, j_1, j_2 (Abramowitz and Stegun, table 10.6), with 1, 3 and 5 functions.
  const double exact[] = {std::numbers::pi, 4.493409458, 5.763459197};
  double before = 1;
  for (const int level : {1, 2}) {
    const PolyhedralMesh mesh = generate_volume("ball-hexahedra", {.level = level});
    const EigenPairs modes =
        eigenmodes(discretize(mesh, "diamond", kMatrices), 9, where(boundary_vertices(mesh)));
    double worst = 0;
    for (Index k = 0; k < 9; ++k) {
      const double zero = exact[k == 0 ? 0 : k < 4 ? 1 : 2];
      worst = std::max(worst, std::abs(modes.values[k] / (zero * zero) - 1));
    }
    RecordProperty("relative_error_" + std::to_string(level), std::to_string(worst));
    EXPECT_LT(worst, before / (level == 1 ? 1 : 2.5));
    before = worst;
  }
  EXPECT_LT(before, 0.1);
}

TEST(Eigenmodes, iteration_finds_all_waves_of_a_cube) {
  const PolyhedralMesh mesh = generate_volume("cube-hexahedra", {.level = 2});
  const Discretization d = discretize(mesh, "diamond", kMatrices);
  const EigenOptions options{
      .method = EigenMethod::Iterative, .dimension = 3, .sparser = sparser_stiffness(mesh, d)};
  for (const Index count : {4, 11, 30}) {
    const EigenPairs few = eigenmodes(d, count, {}, options);
    const EigenPairs direct = eigenmodes(d, count, {}, {.method = EigenMethod::Cholesky});
    EXPECT_EQ(few.method, EigenMethod::Iterative);
    EXPECT_LT((few.values - direct.values).cwiseAbs().maxCoeff(), 1e-11 * few.values[count - 1]);
    EXPECT_LT(few.residuals.maxCoeff(), 1e-10);
  }
}

TEST(Eigenmodes, torus_and_sphere_by_iteration_have_their_clusters) {
  for (const std::string family : {"sphere-triangles", "torus-triangles"}) {
    SCOPED_TRACE(family);
    const PolygonMesh mesh = generate_mesh(family, {.level = 3});
    const Discretization d = discretize(mesh, "diamond", kMatrices);
    const EigenPairs iterated = eigenmodes(d, 26, {}, {.method = EigenMethod::Iterative});
    const EigenPairs lanczos = eigenmodes(d, 26, {}, {.method = EigenMethod::Cholesky});
    EXPECT_LT((iterated.values - lanczos.values).cwiseAbs().maxCoeff(),
              1e-11 * iterated.values[25]);
    EXPECT_EQ(multiplicities(iterated.values, 1e-6), multiplicities(lanczos.values, 1e-6));
  }
}

TEST(Eigenmodes, a_lumped_mass_with_a_negative_entry_is_refused) {
  Discretization d = discretize(quad_grid(5, 5));
  d.mass.setIdentity();
  d.mass.coeffRef(3, 3) = -1;
  EXPECT_THROW(eigenmodes(d, 2), SolverFailure);
}

}  // namespace
}  // namespace carat::test
