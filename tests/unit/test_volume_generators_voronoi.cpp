#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "carat/generators/short_edges.h"
#include "carat/generators/volume_domain.h"
#include "carat/generators/volume_lattice.h"
#include "carat/generators/voronoi_cell.h"
#include "carat/mesh/volume_statistics.h"

namespace carat {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

std::set<Index> surfaces_of(const VoronoiCell& cell) {
  std::set<Index> surfaces;
  for (const auto& corner : cell.corners())
    surfaces.insert(corner.surfaces.begin(), corner.surfaces.end());
  return surfaces;
}

/// Sites of a body-centred lattice about the one at the origin, those farther off first.
std::vector<Vec3> body_centred_sites() {
  std::vector<Vec3> sites;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j)
      for (int k = -4; k <= 4; ++k)
        if ((i + j) % 2 == 0 && (j + k) % 2 == 0 && (i != 0 || j != 0 || k != 0))
          sites.push_back(Vec3(i, j, k) / 10);
  std::sort(sites.begin(), sites.end(),
            [](const Vec3& a, const Vec3& b) { return a.squaredNorm() > b.squaredNorm(); });
  return sites;
}

// ---- one cell ------------------------------------------------------------------------------

TEST(VoronoiCell, StartsAsACubeWithSurfacesCounterClockwise) {
  VoronoiCell cell;
  cell.start(Vec3(0.5, 0.5, 0.5), 0, 1);
  ASSERT_EQ(cell.corners().size(), 8u);
  EXPECT_TRUE(cell.is_sound());
  EXPECT_NEAR(cell.influence(), std::sqrt(3.0), 4 * kEps);
  for (const auto& corner : cell.corners()) {
    Eigen::Matrix3d normals;
    for (int m = 0; m < 3; ++m) {
      const Index name = corner.surfaces[m];
      const int axis = (-name - 1) / 2;
      const double at = name % 2 == 0 ? 1 : 0;
      EXPECT_EQ(corner.x[axis], at);
      normals.row(m) = (2 * at - 1) * Vec3::Unit(axis).transpose();
    }
    EXPECT_GT(normals.row(0).cross(normals.row(1)).dot(normals.row(2)), 0);
  }
}

TEST(VoronoiCell, OfTheBodyCentredLatticeIsATruncatedOctahedron) {
  VoronoiCell cell;
  cell.start(Vec3::Zero(), -1, 1);
  const std::vector<Vec3> sites = body_centred_sites();
  for (std::size_t s = 0; s < sites.size(); ++s) cell.cut_by_site(static_cast<Index>(s), sites[s]);
  EXPECT_TRUE(cell.is_sound());
  EXPECT_EQ(cell.corners().size(), 24u);
  EXPECT_EQ(surfaces_of(cell).size(), 14u);
  for (const auto& corner : cell.corners()) {
    // (0, 1/2, 1) of a cube of side 0.2, in any order and with any signs.
    Vec3 x = corner.x.cwiseAbs();
    std::sort(x.data(), x.data() + 3);
    EXPECT_NEAR((x - Vec3(0, 0.05, 0.1)).norm(), 0, 8 * kEps);
    for (const Index s : corner.surfaces)
      EXPECT_NEAR((corner.x - sites[s]).norm(), corner.x.norm(), 8 * kEps);
  }
}

TEST(VoronoiCell, DoesNotDependOnTheOrderOfCuts) {
  std::vector<Vec3> sites = body_centred_sites();
  const auto corners = [&] {
    VoronoiCell cell;
    cell.start(Vec3(0.01, 0.02, -0.01), -1, 1);
    for (std::size_t s = 0; s < sites.size(); ++s)
      cell.cut_by_site(static_cast<Index>(s), sites[s]);
    return cell.corners();
  };
  const auto far_first = corners();
  std::reverse(sites.begin(), sites.end());
  const auto near_first = corners();
  ASSERT_EQ(far_first.size(), near_first.size());
  for (const auto& corner : far_first)
    EXPECT_EQ(
        std::ranges::count_if(
            near_first, [&](const auto& other) { return (other.x - corner.x).norm() < 16 * kEps; }),
        1);
}

TEST(VoronoiCell, IsCutByTheSphere) {
  VoronoiCell cell;
  cell.start(Vec3(0, 0, 0.9), -1.5, 1.5);
  const std::vector<Vec3> sites{
      {0.2, 0, 0.9}, {-0.2, 0, 0.9}, {0, 0.2, 0.9}, {0, -0.2, 0.9}, {0, 0, 0.7}};
  cell.cut_by_tangent_plane();
  for (std::size_t s = 0; s < sites.size(); ++s) cell.cut_by_site(static_cast<Index>(s), sites[s]);
  cell.cut_by_sphere();
  EXPECT_TRUE(cell.is_sound());
  EXPECT_EQ(surfaces_of(cell), (std::set<Index>{VoronoiCell::kSphere, 0, 1, 2, 3, 4}));
  ASSERT_EQ(cell.corners().size(), 8u);
  for (const auto& corner : cell.corners()) {
    EXPECT_NEAR(std::abs(corner.x.x()), 0.1, 2 * kEps);
    EXPECT_NEAR(std::abs(corner.x.y()), 0.1, 2 * kEps);
    const bool outer = std::ranges::count(corner.surfaces, VoronoiCell::kSphere) == 1;
    EXPECT_NEAR(corner.x.z(), outer ? std::sqrt(0.98) : 0.8, 4 * kEps);
  }
}

TEST(VoronoiCell, ReportsWhatASphereCutsInTwo) {
  // Without neighbours nothing of the cube is inside of the sphere but its middle.
  VoronoiCell cell;
  cell.start(Vec3::Zero(), -0.8, 0.8);
  cell.cut_by_sphere();
  EXPECT_FALSE(cell.is_sound());
}

// ---- short edges ---------------------------------------------------------------------------

/// 4^3 cubes of the unit cube, with a vertex pulled towards another.
PolyhedralMesh pulled_cubes(const Vec3& from, const Vec3& to, double distance) {
  const CubeLattice lattice{4};
  Points points = lattice.points();
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    if (points.row(v).transpose() == from)
      points.row(v) = (to + distance * (from - to).normalized()).transpose();
  return hexahedra(lattice, points);
}

bool has_vertex(const PolyhedralMesh& mesh, const Vec3& x) {
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if ((mesh.point(v) - x).norm() < 1e-12) return true;  // against distances of 1/4
  return false;
}

TEST(ShortEdges, MergeInside) {
  const PolyhedralMesh mesh = pulled_cubes({0.25, 0.5, 0.5}, {0.5, 0.5, 0.5}, 0.02);
  const PolyhedralMesh merged = merge_short_edges(mesh, kCube, 0.05);
  EXPECT_EQ(merged.n_vertices(), mesh.n_vertices() - 1);
  EXPECT_EQ(merged.n_cells(), mesh.n_cells());
  EXPECT_EQ(merged.n_faces(), mesh.n_faces());  // squares with one side gone are triangles
  EXPECT_TRUE(has_vertex(merged, {0.49, 0.5, 0.5}));
  const VolumeStatistics s = volume_statistics(merged);
  EXPECT_NEAR(s.volume, 1, 100 * kEps);  // the sum of 64
  EXPECT_EQ(s.all_faces.faces_of_valence[3], 4);
  EXPECT_TRUE(inverted_cells(merged).empty());
}

TEST(ShortEdges, StayOnTheBorder) {
  // An inner vertex next to one on a side, and one on a side next to one on an edge of the cube.
  const PolyhedralMesh inner =
      merge_short_edges(pulled_cubes({0.25, 0.5, 0.5}, {0, 0.5, 0.5}, 0.02), kCube, 0.05);
  EXPECT_EQ(inner.n_vertices(), 124);
  EXPECT_TRUE(has_vertex(inner, {0, 0.5, 0.5}));
  const PolyhedralMesh side =
      merge_short_edges(pulled_cubes({0.25, 0, 0.5}, {0, 0, 0.5}, 0.02), kCube, 0.05);
  EXPECT_EQ(side.n_vertices(), 124);
  EXPECT_TRUE(has_vertex(side, {0, 0, 0.5}));
  // Along an edge of the cube, to the middle.
  const PolyhedralMesh edge =
      merge_short_edges(pulled_cubes({0, 0, 0.5}, {0, 0, 0.25}, 0.02), kCube, 0.05);
  EXPECT_EQ(edge.n_vertices(), 124);
  EXPECT_TRUE(has_vertex(edge, {0, 0, 0.26}));
  EXPECT_NEAR(volume_statistics(edge).volume, 1, 100 * kEps);
}

TEST(ShortEdges, DoNotMergeWhatWouldLeaveTheDomain) {
  // A cell as thin as the limit between two opposite sides: no vertex lies on both.
  const CubeLattice lattice{1};
  const PolyhedralMesh cube = hexahedra(lattice, lattice.points());
  EXPECT_EQ(merge_short_edges(cube, kCube, 2).n_vertices(), 8);
}

TEST(ShortEdges, DoNotFlattenCells) {
  // All edges along x of one layer are short: merging them would leave cells without volume.
  const CubeLattice lattice{4};
  Points points = lattice.points();
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    if (points(v, 0) == 0.5) points(v, 0) = 0.26;
  const PolyhedralMesh mesh = hexahedra(lattice, points);
  const PolyhedralMesh merged = merge_short_edges(mesh, kCube, 0.05);
  EXPECT_EQ(merged.n_vertices(), mesh.n_vertices());
  EXPECT_EQ(merged.n_cells(), mesh.n_cells());
  EXPECT_NEAR(volume_statistics(merged).volume, 1, 100 * kEps);
}

TEST(ShortEdges, LeaveOtherMeshesAlone) {
  const CubeLattice lattice{3};
  const PolyhedralMesh mesh = hexahedra(lattice, lattice.points());
  const PolyhedralMesh same = merge_short_edges(mesh, kCube, 0.3);
  EXPECT_EQ(same.n_vertices(), mesh.n_vertices());
  EXPECT_EQ(same.n_faces(), mesh.n_faces());
  for (Index c = 0; c < mesh.n_cells(); ++c) EXPECT_EQ(same.cell(c).size(), 6u);
}

}  // namespace
}  // namespace carat
