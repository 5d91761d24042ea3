#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/generators/lattice.h"
#include "carat/generators/zigzag.h"
#include "carat/mesh/statistics.h"

namespace carat {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

std::string domain_of(const std::string& family) {
  for (const FamilyEntry& entry : mesh_families())
    if (entry.name == family) return entry.domain;
  return "";
}

bool has_concave_faces(const std::string& family) {
  return family.ends_with("-concave") || family.ends_with("-lshape");
}

/// Outward unit normal of the family's surface at x.
Vec3 normal_at(const std::string& family, const Vec3& x) {
  if (domain_of(family) == "unit square") return Vec3::UnitZ();
  if (domain_of(family) == "unit sphere") return x.normalized();
  return (x - Vec3(x.x(), x.y(), 0).normalized()).normalized();
}

Vec3 mean_of(const PolygonMesh& mesh, Index f) {
  Vec3 mean = Vec3::Zero();
  for (const Index v : mesh.face(f)) mean += mesh.point(v);
  return mean / static_cast<double>(mesh.face(f).size());
}

/// Least measure over all corners of the face, seen along the surface normal at each.
double least_corner(const std::string& family, const PolygonMesh& mesh, Index f) {
  const auto face = mesh.face(f);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 a = mesh.point(face[i]), b = mesh.point(face[(i + 1) % face.size()]),
               c = mesh.point(face[(i + 2) % face.size()]);
    // On the sphere great circles bound the face, so that the normal is taken at a corner itself.
    const Vec3 at = domain_of(family) == "torus" ? Vec3((a + b + c) / 3) : b;
    least = std::min(least, (b - a).cross(c - a).dot(normal_at(family, at)));
  }
  return least;
}

/// Depth of the deepest point of the face's kernel, by brute force over a grid of candidates in
/// the face's bounding box in the mean plane; positive if the face is star-shaped.
double kernel_depth(const std::string& family, const PolygonMesh& mesh, Index f) {
  const auto face = mesh.face(f);
  const Vec3 mean = mean_of(mesh, f), normal = normal_at(family, mean);
  const Vec3 u = normal.cross(Vec3(normal.y(), normal.z(), normal.x())).norm() > 0.1
                     ? normal.cross(Vec3(normal.y(), normal.z(), normal.x())).normalized()
                     : normal.unitOrthogonal();
  const Vec3 w = normal.cross(u);
  // On the sphere, project from the centre: great circles become lines.
  const double height = mean.dot(normal);
  std::vector<Vec2> x;
  Vec2 lower = Vec2::Constant(1e300), upper = -lower;
  for (const Index v : face) {
    Vec3 p = mesh.point(v);
    if (domain_of(family) == "unit sphere") p *= height / p.dot(normal);
    x.emplace_back((p - mean).dot(u), (p - mean).dot(w));
    lower = lower.cwiseMin(x.back());
    upper = upper.cwiseMax(x.back());
  }
  double deepest = -1e300;
  constexpr int kSteps = 40;
  for (int i = 1; i < kSteps; ++i)
    for (int j = 1; j < kSteps; ++j) {
      const Vec2 p = lower + (upper - lower).cwiseProduct(Vec2(i, j) / kSteps);
      double depth = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Vec2 side = x[(k + 1) % x.size()] - x[k], to = p - x[k];
        depth = std::min(depth, (side.x() * to.y() - side.y() * to.x()) / side.norm());
      }
      deepest = std::max(deepest, depth);
    }
  return deepest / (upper - lower).norm();
}

using Case = std::tuple<std::string, int, double, double>;  // family, level, jitter, anisotropy

class Family : public testing::TestWithParam<Case> {
 protected:
  std::string family() const { return std::get<0>(GetParam()); }
  FamilyOptions options() const {
    return {.level = std::get<1>(GetParam()),
            .jitter = std::get<2>(GetParam()),
            .anisotropy = std::get<3>(GetParam())};
  }
};

TEST_P(Family, IsACleanSurface) {
  const PolygonMesh mesh = generate_mesh(family(), options());
  const MeshStatistics s = mesh_statistics(mesh);
  const bool plane = domain_of(family()) == "unit square";
  EXPECT_EQ(s.euler_characteristic, plane ? 1 : domain_of(family()) == "torus" ? 0 : 2);
  EXPECT_EQ(s.closed, !plane);
  EXPECT_EQ(s.boundary_loops, plane ? 1 : 0);
  EXPECT_EQ(s.components, 1);
  EXPECT_EQ(s.unreferenced_vertices, 0);
  EXPECT_EQ(s.nonmanifold_edges + s.nonmanifold_vertices + s.inconsistent_edges, 0);
  EXPECT_EQ(s.degenerate_faces + s.duplicate_faces + s.dropped_corners, 0);
  if (plane) {
    EXPECT_NEAR(s.area, 1, 1e-13);  // rounding of some 10^3 areas
    EXPECT_EQ(s.nonplanar_faces, 0);
    EXPECT_GT(face_area_vectors(mesh).col(2).minCoeff(), 0);
  } else {
    EXPECT_GT(s.enclosed_volume, 0) << "turned inside out";
  }
}

TEST_P(Family, LiesOnItsSurface) {
  const PolygonMesh mesh = generate_mesh(family(), options());
  const std::vector<bool> boundary = boundary_vertices(mesh);
  Index corners = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 x = mesh.point(v);
    if (domain_of(family()) == "unit square") {
      const bool on_side = x.x() == 0 || x.x() == 1, on_end = x.y() == 0 || x.y() == 1;
      EXPECT_EQ(x.z(), 0);
      EXPECT_EQ(on_side || on_end, boundary[v]) << "vertex " << v << " at " << x.transpose();
      EXPECT_TRUE(x.x() >= 0 && x.x() <= 1 && x.y() >= 0 && x.y() <= 1);
      corners += on_side && on_end ? 1 : 0;
    } else if (domain_of(family()) == "unit sphere") {
      EXPECT_NEAR(x.norm(), 1, 4 * kEps);
    } else {
      const double tube = std::hypot(std::hypot(x.x(), x.y()) - 1, x.z());
      EXPECT_NEAR(tube, 0.4, 8 * kEps);  // differences of numbers up to 1.4
    }
  }
  if (domain_of(family()) == "unit square") {
    EXPECT_EQ(corners, 4);
  }
}

TEST_P(Family, FacesAreConvexOrStarShaped) {
  const PolygonMesh mesh = generate_mesh(family(), options());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    if (has_concave_faces(family())) {
      EXPECT_GT(kernel_depth(family(), mesh, f), 0) << "face " << f << " has no kernel";
    } else {
      EXPECT_GT(least_corner(family(), mesh, f), 0) << "face " << f << " is not convex";
    }
  }
}

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (const FamilyEntry& entry : mesh_families()) names.emplace_back(entry.name);
  return names;
}

std::string case_name(const testing::TestParamInfo<Case>& test) {
  const auto& [family, level, jitter, anisotropy] = test.param;
  std::string name = family;
  name[name.find('-')] = '_';
  return name + "_L" + std::to_string(level) + "_j" + std::to_string(std::lround(10 * jitter)) +
         "_a" + std::to_string(std::lround(anisotropy));
}

INSTANTIATE_TEST_SUITE_P(Plain, Family,
                         testing::Combine(testing::ValuesIn(all_families()),
                                          testing::Values(0, 1, 2, 3),
                                          testing::Values(0.0, 0.3, 0.5), testing::Values(1.0)),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Graded, Family,
                         testing::Combine(testing::ValuesIn(all_families()), testing::Values(0, 2),
                                          testing::Values(0.0, 0.3), testing::Values(4.0)),
                         case_name);

// ---- counts and convergence ----------------------------------------------------------------

TEST(Families, CountsByLevel) {
  const auto counts = [](const char* family, int level) {
    const PolygonMesh mesh = generate_mesh(family, {.level = level});
    return std::array<Index, 3>{mesh.n_vertices(), mesh.n_edges(), mesh.n_faces()};
  };
  using Counts = std::array<Index, 3>;
  for (int level = 0; level < 4; ++level) {
    const Index k = 1 << level;
    EXPECT_EQ(counts("plane-quads", level),
              (Counts{(6 * k + 1) * (6 * k + 1), 12 * k * (6 * k + 1), 36 * k * k}));
    EXPECT_EQ(counts("sphere-triangles", level), (Counts{40 * k * k + 2, 120 * k * k, 80 * k * k}));
    EXPECT_EQ(counts("sphere-hexagons", level), (Counts{80 * k * k, 120 * k * k, 40 * k * k + 2}));
    EXPECT_EQ(counts("sphere-quads", level), (Counts{54 * k * k + 2, 108 * k * k, 54 * k * k}));
    EXPECT_EQ(counts("sphere-concave", level), (Counts{72 * k * k + 2, 96 * k * k, 24 * k * k}));
    EXPECT_EQ(counts("torus-triangles", level), (Counts{72 * k * k, 216 * k * k, 144 * k * k}));
    EXPECT_EQ(counts("plane-voronoi", level)[2], 42 * k * k);
    EXPECT_EQ(counts("plane-concave", level)[2], 16 * k * k);
    EXPECT_EQ(counts("plane-lshape", level)[2], 36 * k * k);
    EXPECT_EQ(counts("plane-triangles", level)[2], 7 * k * (12 * k + 1));
  }
}

TEST(Families, EdgesHalveAndAreasConverge) {
  const double torus_area = 4 * std::numbers::pi * std::numbers::pi * 0.4;
  for (const std::string& family : all_families()) {
    const bool plane = domain_of(family) == "unit square";
    const double exact = domain_of(family) == "torus" ? torus_area : 4 * std::numbers::pi;
    double previous_edge = 0, previous_error = 0;
    for (int level = 0; level < 6; ++level) {
      const MeshStatistics s = mesh_statistics(generate_mesh(family, {.level = level}));
      if (level == 0) {
        EXPECT_GE(s.vertices, 30) << family;
        EXPECT_LE(s.vertices, 100) << family;
      }
      const double error = std::abs(s.area / exact - 1);
      if (level > 2) {
        // The share of longer border edges and the curvature die out with the level.
        EXPECT_NEAR(s.edge_length.mean / previous_edge, 0.5, 0.02) << family << level;
        if (!plane) {
          EXPECT_NEAR(error / previous_error, 0.25, 0.03) << family << level;
        }
      }
      previous_edge = s.edge_length.mean;
      previous_error = error;
    }
  }
}

TEST(Families, Valences) {
  const auto vertex_valences = [](const PolygonMesh& mesh) {
    std::vector<Index> count(16, 0);
    for (Index v = 0; v < mesh.n_vertices(); ++v) ++count[mesh.vertex_corners().size(v)];
    return count;
  };
  const PolygonMesh torus = generate_mesh("torus-triangles", {.level = 2});
  EXPECT_EQ(vertex_valences(torus)[6], torus.n_vertices());
  const PolygonMesh sphere = generate_mesh("sphere-triangles", {.level = 2});
  EXPECT_EQ(vertex_valences(sphere)[5], 12);
  EXPECT_EQ(vertex_valences(sphere)[6], sphere.n_vertices() - 12);
  const PolygonMesh hexagons = generate_mesh("sphere-hexagons", {.level = 2});
  EXPECT_EQ(mesh_statistics(hexagons).faces_of_valence,
            (std::vector<Index>{0, 0, 0, 0, 0, 12, hexagons.n_faces() - 12}));
  EXPECT_EQ(vertex_valences(hexagons)[3], hexagons.n_vertices());
  const PolygonMesh quads = generate_mesh("sphere-quads", {.level = 2});
  EXPECT_EQ(vertex_valences(quads)[3], 8);
  EXPECT_EQ(vertex_valences(quads)[4], quads.n_vertices() - 8);
}

TEST(Families, FacesByShape) {
  for (int level = 0; level < 3; ++level) {
    const MeshStatistics l = mesh_statistics(generate_mesh("plane-lshape", {.level = level}));
    EXPECT_EQ(l.nonconvex_faces, l.faces);
    EXPECT_EQ(l.faces_of_valence[6], l.faces);
    for (const char* family : {"plane-concave", "sphere-concave"}) {
      const MeshStatistics c = mesh_statistics(generate_mesh(family, {.level = level}));
      EXPECT_EQ(c.nonconvex_faces, c.faces) << family;
    }
    const MeshStatistics t = mesh_statistics(generate_mesh("plane-triangles", {.level = level}));
    EXPECT_EQ(t.faces_of_valence[3], t.faces);
  }
  // Jittered sites give cells of every valence from 4 to 8.
  const MeshStatistics v =
      mesh_statistics(generate_mesh("plane-voronoi", {.level = 3, .jitter = 0.4}));
  for (const std::size_t n : {4u, 5u, 6u, 7u, 8u}) EXPECT_GT(v.faces_of_valence.at(n), 0);
}

TEST(Families, VoronoiCellsInsideAreNearlyRegularHexagons) {
  const PolygonMesh mesh = generate_mesh("plane-voronoi", {.level = 3});
  const std::vector<bool> boundary = boundary_vertices(mesh);
  Index inner = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    // Two rows from the border, cells are as in the whole plane.
    const Vec3 mean = mean_of(mesh, f);
    if ((mean.head<2>().array() < 0.06).any() || (mean.head<2>().array() > 0.94).any()) continue;
    ++inner;
    ASSERT_EQ(face.size(), 6u);
    double shortest = 1, longest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double side = (mesh.point(face[(i + 1) % 6]) - mesh.point(face[i])).norm();
      shortest = std::min(shortest, side);
      longest = std::max(longest, side);
    }
    // Rows are 1/7 apart where sqrt(3)/12 would be regular: upright sides are 2.4 % shorter.
    EXPECT_LT(longest / shortest, 1.024);
  }
  EXPECT_GT(inner, mesh.n_faces() / 2);
}

TEST(Families, MeansOfLShapesFlipTriangles) {
  for (const double jitter : {0.0, 0.1}) {
    const PolygonMesh mesh = generate_mesh("plane-lshape", {.level = 1, .jitter = jitter});
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      const auto face = mesh.face(f);
      const Vec3 mean = mean_of(mesh, f);
      double least = 1, winding = 0;
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3 a = mesh.point(face[i]) - mean, b = mesh.point(face[(i + 1) % 6]) - mean;
        least = std::min(least, a.cross(b).z());
        winding += std::atan2(a.cross(b).z(), a.dot(b));
      }
      EXPECT_LT(least, 0) << "face " << f;
      if (jitter == 0) {
        EXPECT_NEAR(winding, 0, 1e-9) << "the mean lies inside face " << f;  // 0 or 2 pi
      }
    }
  }
}

TEST(Families, MeansOfConcaveFacesLieInTheKernelWithoutJitter) {
  const PolygonMesh mesh = generate_mesh("plane-concave", {.level = 1});
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    const Vec3 mean = mean_of(mesh, f);
    for (std::size_t i = 0; i < face.size(); ++i)
      EXPECT_GT(
          (mesh.point(face[i]) - mean).cross(mesh.point(face[(i + 1) % face.size()]) - mean).z(),
          0);
  }
}

TEST(Zigzag, ColoursSayWhichSidesBendInwards) {
  constexpr Index n = 4;
  const ZigzagQuads cells = zigzag_quads(square_quads(n, 1), checkerboard(1, n));
  for (Index j = 1; j + 1 < n; ++j)
    for (Index i = 1; i + 1 < n; ++i) {
      const Index f = j * n + i;
      const auto face = cells.mesh.face(f);
      ASSERT_EQ(face.size(), 8u);
      for (Index side = 0; side < 4; ++side) {
        const Vec3 kink = cells.mesh.point(face[2 * side + 1]);
        const Vec3 centre = cells.centres.row(f).transpose();
        const bool inwards = (kink - centre).norm() < 0.5 / n;
        EXPECT_EQ(inwards, side % 2 == (i + j) % 2) << "face " << f << " side " << side;
      }
    }
}

// ---- jitter, anisotropy, seed --------------------------------------------------------------

TEST(Families, SeedsDetermineTheMesh) {
  for (const std::string& family : all_families()) {
    const auto points = [&](double jitter, std::uint64_t seed) {
      return generate_mesh(family, {.level = 1, .jitter = jitter, .seed = seed}).points();
    };
    EXPECT_EQ(points(0.3, 5), points(0.3, 5)) << family;
    EXPECT_EQ(points(0, 5), points(0, 6)) << family;
    const Points a = points(0.3, 5), b = points(0.3, 6);
    EXPECT_TRUE(a.rows() != b.rows() || (a - b).cwiseAbs().maxCoeff() > 1e-3) << family;
  }
}

TEST(Families, JitterIsTheSameEverywhere) {
  // By an independent script from the definition (SplitMix64, rejection in the disc). A change
  // here changes every jittered mesh that was ever published.
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 0, .jitter = 0.25, .seed = 42});
  EXPECT_DOUBLE_EQ(mesh.point(8).x(), 0.20216444030695724);
  EXPECT_DOUBLE_EQ(mesh.point(8).y(), 0.18504018209159545);
}

TEST(Families, JitterStaysWithinItsReach) {
  for (const std::string& family : all_families()) {
    if (family == "plane-voronoi") continue;  // there it moves the sites
    const PolygonMesh mesh = generate_mesh(family, {.level = 2});
    std::vector<double> shortest(static_cast<std::size_t>(mesh.n_vertices()), 1e300);
    for (const auto& ends : mesh.edges().vertices)
      for (const Index v : ends)
        shortest[v] = std::min(shortest[v], (mesh.point(ends[0]) - mesh.point(ends[1])).norm());
    const PolygonMesh moved = generate_mesh(family, {.level = 2, .jitter = 0.2});
    ASSERT_EQ(moved.n_vertices(), mesh.n_vertices());
    double farthest = 0;
    Index moved_vertices = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const double distance = (moved.point(v) - mesh.point(v)).norm() / shortest[v];
      farthest = std::max(farthest, distance);
      moved_vertices += distance > 0 ? 1 : 0;
    }
    EXPECT_LE(farthest, 0.2 * (1 + 1e-9)) << family;  // projection to the surface shortens
    EXPECT_GT(farthest, 0.15) << family;
    EXPECT_GT(moved_vertices, 0.9 * mesh.n_vertices()) << family;
  }
}

TEST(Families, BoundaryVerticesSlideButCornersStay) {
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 1});
  const PolygonMesh moved = generate_mesh("plane-quads", {.level = 1, .jitter = 0.4});
  Index slid = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 2; ++k)
      if (mesh.point(v)[k] == 0 || mesh.point(v)[k] == 1) {
        EXPECT_EQ(moved.point(v)[k], mesh.point(v)[k]);
        slid += moved.point(v)[1 - k] != mesh.point(v)[1 - k] ? 1 : 0;
      }
  EXPECT_EQ(slid, 4 * 11);
}

TEST(Families, AnisotropyStretches) {
  // plane-quads: widths of the cells at both ends in the ratio of the anisotropy.
  const PolygonMesh quads = generate_mesh("plane-quads", {.level = 5, .anisotropy = 8});
  const Index n = 6 * 32;
  const double first = quads.point(1).x() - quads.point(0).x();
  const double last = quads.point(n).x() - quads.point(n - 1).x();
  EXPECT_NEAR(last / first, std::pow(8.0, 1 - 1.0 / n), 1e-9);
  for (const std::string& family : all_families()) {
    const MeshStatistics plain = mesh_statistics(generate_mesh(family, {.level = 2}));
    const MeshStatistics graded =
        mesh_statistics(generate_mesh(family, {.level = 2, .anisotropy = 6}));
    EXPECT_EQ(graded.faces, plain.faces);
    EXPECT_GT(graded.edge_length.max / graded.edge_length.min,
              2 * plain.edge_length.max / plain.edge_length.min)
        << family;
  }
  // sphere: drawn towards the equator.
  const auto spread = [](double anisotropy) {
    return generate_mesh("sphere-quads", {.level = 2, .anisotropy = anisotropy})
        .points()
        .col(2)
        .cwiseAbs()
        .mean();
  };
  EXPECT_LT(spread(4), 0.6 * spread(1));
}

TEST(Families, VerticesAreNumberedLocally) {
  // Faces next to each other in number share memory: the numbers within a face stay within a few
  // rows. A numbering by corners, sides and patches would span the whole mesh.
  for (const std::string& family : all_families()) {
    const PolygonMesh mesh = generate_mesh(family, {.level = 4});
    double span = 0;
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      const auto [low, high] = std::ranges::minmax(mesh.face(f));
      span += high - low;
    }
    EXPECT_LT(span / mesh.n_faces(), 0.1 * mesh.n_vertices()) << family;
  }
}

// ---- errors --------------------------------------------------------------------------------

std::string message_of(const std::string& family, const FamilyOptions& options) {
  try {
    generate_mesh(family, options);
  } catch (const InvalidOption& error) {
    return error.what();
  }
  return "";
}

TEST(Families, RefuseBadOptions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string unknown = message_of("plane-moebius", {});
  EXPECT_NE(unknown.find("'plane-moebius' is unknown"), std::string::npos);
  for (const std::string& family : all_families()) {
    EXPECT_NE(unknown.find(family), std::string::npos);
    EXPECT_EQ(message_of(family, {.level = -1}), "level -1: a refinement level is 0 or more");
    for (const int level : {16, 31, 64, 1000, std::numeric_limits<int>::max()})
      EXPECT_EQ(message_of(family, {.level = level}),
                "level " + std::to_string(level) +
                    ": the mesh would have more than 2^31 face corners; choose a lower level");
    for (const double jitter : {-0.1, 0.51, nan})
      EXPECT_NE(message_of(family, {.jitter = jitter}).find("must lie between 0 and 0.5"),
                std::string::npos);
    for (const double anisotropy : {0.0, 0.99, -2.0, 1e9, nan})
      EXPECT_NE(message_of(family, {.anisotropy = anisotropy}).find("between 1 (none) and 1000"),
                std::string::npos);
  }
}

TEST(Families, SurviveExtremeOptions) {
  for (const std::string& family : all_families())
    for (int level = 0; level < 3; ++level) {
      const PolygonMesh mesh =
          generate_mesh(family, {.level = level, .jitter = 0.5, .anisotropy = 1000, .seed = 99});
      const MeshStatistics s = mesh_statistics(mesh);
      EXPECT_EQ(s.inconsistent_edges + s.nonmanifold_edges, 0) << family;
      EXPECT_EQ(s.components, 1) << family;
    }
}

}  // namespace
}  // namespace carat
