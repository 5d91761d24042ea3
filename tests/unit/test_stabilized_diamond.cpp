#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "carat/base/error.h"
#include "carat/kernels/diamond_split.h"
#include "support/claim_cases.h"
#include "support/measures.h"
#include "support/volume_claim_cases.h"

namespace carat::test {
namespace {

constexpr double kEpsRel = 1e-14;

TEST(DiamondCrossing, of_a_kite_and_of_a_sheared_diamond) {
  // Hinge of length 2, tips at heights 1 and 3 over its middle: areas 1 and 3.
  const DiamondCrossing<2> kite = diamond_crossing(4, {0.5, 2}, {0.5, 6}, kEpsRel);
  EXPECT_DOUBLE_EQ(kite.left, 0.75);
  EXPECT_DOUBLE_EQ(kite.right, 0.25);
  EXPECT_DOUBLE_EQ(kite.base[1], 0.5);
  EXPECT_DOUBLE_EQ(kite.left_fraction, 0.25);
  // |D_l| |D_r| / |D| (1/h_l + 1/h_r)^2
  EXPECT_DOUBLE_EQ(kite.stiffness, 3.0 / 4 * (16.0 / 9));
  // Hinge (0,0)-(1,0), l = (1,1), r = (0,-1): the axis crosses at (1/2, 0).
  EXPECT_DOUBLE_EQ(diamond_crossing(1, {1, 1}, {0, 1}, kEpsRel).base[1], 0.5);
  // l = (0,1), r = (0,-3).
  EXPECT_DOUBLE_EQ(diamond_crossing(1, {0, 1}, {0, 3}, kEpsRel).base[0], 1.0);
  EXPECT_EQ(diamond_crossing(1, {0, 1}, {0, 1e-15}, kEpsRel).stiffness, 0);
}

TEST(DiamondCrossing, in_space) {
  const Vec3 x1(0, 0, 0), x2(1, 0, 0), xf(0, 1, 0), xl(0.1, 0.4, -1), xr(0.5, 0.2, 3);
  const Diamond3d d = diamond_3d(x1, x2, xf, xl, xr, kEpsRel);
  const DiamondCrossing<3> c = diamond_crossing(d, x1, x2, xf, xl, xr, kEpsRel);
  EXPECT_DOUBLE_EQ(c.left_fraction, 0.25);
  EXPECT_DOUBLE_EQ(c.left, 0.75);
  EXPECT_NEAR(c.base[1], 0.2, 1e-15);   // 3/4 of 0.1 and 1/4 of 0.5
  EXPECT_NEAR(c.base[2], 0.35, 1e-15);  // 3/4 of 0.4 and 1/4 of 0.2
  EXPECT_NEAR(c.base[0], 0.45, 1e-15);
  // Areas of the base 1/2: |D_l| = 1/6, |D_r| = 1/2; (1 + 1/3)^2
  EXPECT_NEAR(c.stiffness, (1.0 / 6 * 0.5) / (2.0 / 3) * (16.0 / 9), 1e-15);
}

/// The first moment of the masses and the exact one, of a diamond with halves (base, l), (base, r).
template <std::size_t kBase>
double moment_defect(const DiamondMass<kBase>& mass, const std::array<Vec3, kBase>& base,
                     const Vec3& l, const Vec3& r, double left_fraction) {
  Vec3 moment = mass.left * l + mass.right * r, of_base = Vec3::Zero();
  for (std::size_t i = 0; i < kBase; ++i) {
    moment += mass.base[i] * base[i];
    of_base += base[i];
  }
  const Vec3 exact = (of_base + left_fraction * l + (1 - left_fraction) * r) / double(kBase + 1);
  return (moment - exact).norm();
}

TEST(MomentExactMass, integrates_linear_functions_and_is_never_negative) {
  const std::array<Vec3, 2> hinge{Vec3(0, 0, 0), Vec3(1, 0, 0)};
  const std::array<Vec3, 3> base{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double tau : {0.0, 0.5, 0.75, 1.0})
    for (const double x : {-2.0, -0.3, 0.2, 0.9, 3.0})
      for (const double height : {0.1, 1.0, 5.0}) {
        const DiamondCrossing<2> c2 = diamond_crossing(1, {x, 1}, {0.4, height}, kEpsRel);
        const DiamondMass<2> m2 = moment_exact_mass(c2, tau);
        EXPECT_LT(moment_defect(m2, hinge, Vec3(x, 1, 0), Vec3(0.4, -height, 0), c2.left_fraction),
                  1e-14);
        const Vec3 l(x, 0.3, -1), r(0.2, 0.4, height);
        const Diamond3d d = diamond_3d(base[0], base[1], base[2], l, r, kEpsRel);
        const DiamondCrossing<3> c3 = diamond_crossing(d, base[0], base[1], base[2], l, r, kEpsRel);
        const DiamondMass<3> m3 = moment_exact_mass(c3, tau);
        EXPECT_LT(moment_defect(m3, base, l, r, c3.left_fraction), 1e-14);
        EXPECT_GE(std::min({m2.base[0], m2.base[1], m2.left, m2.right}), 0);
        EXPECT_GE(std::min({m3.base[0], m3.base[1], m3.base[2], m3.left, m3.right}), 0);
        EXPECT_NEAR(m3.base[0] + m3.base[1] + m3.base[2] + m3.left + m3.right, 1, 1e-15);
      }
}

TEST(MomentExactMass, halves_of_the_paper_are_a_symmetric_case) {
  // [BBA21 (23)]: quarters, where the diagonals bisect each other.
  const DiamondMass<2> m = moment_exact_mass(diamond_crossing(4, {0.5, 2}, {0.5, 2}, kEpsRel), 0.5);
  for (const double share : {m.base[0], m.base[1], m.left, m.right}) EXPECT_DOUBLE_EQ(share, 0.25);
}

TEST(MomentExactMass, tips_on_the_wrong_side_get_equal_masses_where_no_split_fits) {
  const DiamondCrossing<3> c{1.5, -0.5, {4, -1.5, -1.5}, 0, -0.5};
  const DiamondMass<3> m = moment_exact_mass(c, 1);
  for (const double share : {m.base[0], m.base[1], m.base[2], m.left, m.right})
    EXPECT_DOUBLE_EQ(share, 0.2);
}

template <class Mesh>
void expect_mixture(const Mesh& mesh, const std::string& what) {
  SCOPED_TRACE(what);
  const auto make = [&](const char* name, const DiscretizationOptions& options) {
    return discretize(mesh, name, options);
  };
  const DiscretizationOptions full{.mass = MassKind::Full};
  const Discretization diamond = make("diamond", full), bunge = make("bunge", full);
  for (const double theta : {0.0, 0.3, 0.75, 1.0}) {
    const Discretization d = make("stabilized_diamond", {.mass = MassKind::Full, .theta = theta});
    const SparseMatrix expected = theta * diamond.stiffness + (1 - theta) * bunge.stiffness;
    EXPECT_LT(difference(d.stiffness, expected), 1e-13);
    EXPECT_LT(difference(d.mass, diamond.mass), 1e-13);
    EXPECT_LT(factorisation_defect(d.stiffness, d.divergence(), d.gradient), 1e-12);
  }
  // The moment-exact mass belongs to both.
  const Discretization plain = make("diamond", {.mass = MassKind::MomentExact, .tau = 0.4});
  const Discretization stable =
      make("stabilized_diamond", {.mass = MassKind::MomentExact, .tau = 0.4});
  EXPECT_LT(difference(plain.mass, stable.mass), 1e-13);
  // It integrates coordinates as the virtual refinement does, whose consistent mass is bunge's;
  // where the diamonds of a surface are folded, those of the unfolded diamond.
  if (std::is_same_v<Mesh, PolygonMesh> && what.rfind("plane-", 0) != 0) return;
  const Vector ones = Vector::Ones(mesh.n_vertices());
  EXPECT_LT((mesh.points().transpose() * (plain.mass * ones - bunge.mass * ones)).norm(),
            1e-12 * bunge.mass.sum());
}

TEST(StabilizedDiamond, is_between_diamond_and_bunge_on_every_surface) {
  for (const FamilyEntry& family : mesh_families()) {
    expect_mixture(family.generate({.level = 1}), family.name);
    expect_mixture(family.generate({.level = 1, .jitter = 0.2}), family.name);
  }
}

TEST(StabilizedDiamond, is_between_diamond_and_bunge_on_every_volume) {
  for (const VolumeFamilyEntry& family : volume_families()) {
    expect_mixture(family.generate({.level = 0}), family.name);
    expect_mixture(family.generate({.level = 0, .jitter = 0.2}), family.name);
  }
}

/// How far -S p = M laplacian(p) is from exact for polynomials of degree 4 at the vertex nearest to
/// the middle of a lattice: the leading term of the error, over the mass. Lengths are in units of
/// the reach of the vertex's row.
template <class Mesh>
double fourth_order_defect(const Mesh& mesh, const Discretization& d, int dimension) {
  const Eigen::RowVector3d middle(0.5, 0.5, dimension == 3 ? 0.5 : 0.0);
  Index centre = 0;
  (mesh.points().rowwise() - middle).rowwise().squaredNorm().minCoeff(&centre);
  const auto offset = [&](Index v) { return mesh.points().row(v) - mesh.points().row(centre); };
  double reach = 0;
  for (SparseMatrix::InnerIterator entry(d.stiffness, centre); entry; ++entry)
    reach = std::max(reach, offset(static_cast<Index>(entry.col())).norm());
  const auto apply = [&](const SparseMatrix& matrix, const std::array<int, 3>& power) {
    double sum = 0;
    for (SparseMatrix::InnerIterator entry(matrix, centre); entry; ++entry) {
      const Eigen::RowVector3d x = offset(static_cast<Index>(entry.col())) / reach;
      sum += entry.value() * std::pow(x[0], power[0]) * std::pow(x[1], power[1]) *
             std::pow(x[2], power[2]);
    }
    return sum;
  };
  const double mass = apply(d.mass, {0, 0, 0});
  double worst = 0;
  for (int a = 0; a <= 4; ++a)
    for (int b = 0; a + b <= 4; ++b) {
      const std::array<int, 3> p{a, b, 4 - a - b};
      if (dimension == 2 && p[2] > 0) continue;
      double defect = apply(d.stiffness, p) * reach * reach;
      for (std::size_t k = 0; k < 3; ++k) {
        if (p[k] < 2) continue;
        std::array<int, 3> q = p;
        q[k] -= 2;
        defect += p[k] * (p[k] - 1) * apply(d.mass, q);
      }
      worst = std::max(worst, std::abs(defect) / mass);
    }
  return worst;
}

TEST(StabilizedDiamond, is_of_fourth_order_inside_square_and_cubic_lattices) {
  const auto options = [](double theta, double tau) {
    return DiscretizationOptions{.mass = MassKind::MomentExact, .theta = theta, .tau = tau};
  };
  const PolygonMesh squares = generate_mesh("plane-quads", {.level = 1});
  const PolyhedralMesh cubes = generate_volume("cube-hexahedra", {.level = 1});
  EXPECT_LT(fourth_order_defect(
                squares, discretize(squares, "stabilized_diamond", options(1.0 / 3, 0.5)), 2),
            1e-12);
  EXPECT_LT(
      fourth_order_defect(cubes, discretize(cubes, "stabilized_diamond", options(0.5, 1.0)), 3),
      1e-12);
  // The paper's operator is not.
  EXPECT_GT(fourth_order_defect(squares, discretize(squares, "diamond"), 2), 0.1);
  EXPECT_GT(fourth_order_defect(cubes, discretize(cubes, "diamond"), 3), 0.05);
}

TEST(StabilizedDiamond, options_are_checked) {
  const PolygonMesh mesh = generate_mesh("plane-quads");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-0.1, 1.1, nan}) {
    EXPECT_THROW(discretize(mesh, "stabilized_diamond", {.theta = bad}), InvalidOption);
    EXPECT_THROW(discretize(mesh, "stabilized_diamond", {.tau = bad}), InvalidOption);
  }
  EXPECT_THROW(discretize(mesh, "diamond", {.theta = 0.5}), InvalidOption);
  EXPECT_THROW(discretize(mesh, "bunge", {.tau = 0.5}), InvalidOption);
  EXPECT_THROW(discretize(mesh, "diamond", {.mass = MassKind::Full, .tau = 0.5}), InvalidOption);
  EXPECT_THROW(discretize(mesh, "de_goes", {.mass = MassKind::MomentExact}), InvalidOption);
}

}  // namespace
}  // namespace carat::test
