#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>
#include <string>
#include <tuple>
#include <vector>

#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/mesh/volume_statistics.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kBallVolume = 4 * std::numbers::pi / 3;

bool is_ball(const std::string& family) { return family.starts_with("ball-"); }
bool is_voronoi(const std::string& family) { return family.ends_with("-voronoi"); }
bool depends_on_seed(const std::string& family) {
  return is_voronoi(family) || family.ends_with("-random-hex");
}

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (const VolumeFamilyEntry& entry : volume_families()) names.emplace_back(entry.name);
  return names;
}

/// Walls of the cube that x lies on, as bits; or 1 on the sphere.
unsigned walls(const std::string& family, const Vec3& x) {
  if (is_ball(family)) return std::abs(x.norm() - 1) <= 4 * kEps ? 1 : 0;
  unsigned bits = 0;
  for (int k = 0; k < 3; ++k) {
    if (x[k] == 0) bits |= 1u << (2 * k);
    if (x[k] == 1) bits |= 2u << (2 * k);
  }
  return bits;
}

/// The virtual tetrahedra of a mesh, by the definitions.
struct VirtualTets {
  double volume = 0;         ///< of all
  double least_quality = 1;  ///< volume over cubed edge length (root mean square); 1 is regular
  Index count = 0, inverted = 0;
  Index moved_face_points = 0;
};

VirtualTets measure_virtual_tets(const PolyhedralMesh& mesh) {
  const VirtualVertices faces = virtual_vertices(mesh.face_mesh(), mesh.points(), {}, 1);
  const Points x_f = face_points(mesh.face_mesh(), mesh.points(), faces.weights);
  VirtualTets result;
  for (const VirtualVertexStatus status : faces.status)
    result.moved_face_points += status == VirtualVertexStatus::Regular ? 0 : 1;
  std::vector<std::array<Vec3, 3>> triangles;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    triangles.clear();
    Vec3 mean = Vec3::Zero();
    for (const Index f : mesh.cell(c)) {
      const auto face = mesh.face(f);
      for (std::size_t i = 0; i < face.size(); ++i) {
        Vec3 a = mesh.point(face[i]), b = mesh.point(face[(i + 1) % face.size()]);
        if (mesh.face_cells()[f].above == c) std::swap(a, b);
        triangles.push_back({a, b, x_f.row(f).transpose()});
        mean += a;
      }
    }
    mean /= static_cast<double>(triangles.size());
    // Least squares for all planes through x_c, each weighed by its triangle's area.
    Eigen::MatrixXd normals(triangles.size(), 3);
    Vector offsets(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, f] = triangles[t];
      const Vec3 area = (a - f).cross(b - f);
      normals.row(static_cast<Eigen::Index>(t)) = area.transpose();
      offsets[static_cast<Eigen::Index>(t)] = area.dot(f - mean);
    }
    const Vec3 x_c = mean + Vec3(normals.colPivHouseholderQr().solve(offsets));
    for (const auto& [a, b, f] : triangles) {
      const double volume = (a - x_c).cross(b - x_c).dot(f - x_c) / 6;
      const double squared_edges = (a - x_c).squaredNorm() + (b - x_c).squaredNorm() +
                                   (f - x_c).squaredNorm() + (a - b).squaredNorm() +
                                   (b - f).squaredNorm() + (f - a).squaredNorm();
      result.volume += volume;
      ++result.count;
      result.inverted += volume > 0 ? 0 : 1;
      result.least_quality = std::min(result.least_quality, 6 * std::numbers::sqrt2 * volume /
                                                                std::pow(squared_edges / 6, 1.5));
    }
  }
  return result;
}

// family, level, jitter, anisotropy
using Case = std::tuple<std::string, int, double, double>;

class VolumeFamily : public testing::TestWithParam<Case> {
 protected:
  std::string family() const { return std::get<0>(GetParam()); }
  FamilyOptions options() const {
    return {.level = std::get<1>(GetParam()),
            .jitter = std::get<2>(GetParam()),
            .anisotropy = std::get<3>(GetParam())};
  }
};

TEST_P(VolumeFamily, IsACleanMesh) {
  const PolyhedralMesh mesh = generate_volume(family(), options());
  const VolumeStatistics s = volume_statistics(mesh);
  EXPECT_EQ(s.components, 1);
  EXPECT_EQ(s.all_faces.unreferenced_vertices, 0);
  EXPECT_EQ(s.all_faces.duplicate_faces + s.all_faces.dropped_corners, 0);
  for (const char* finding : {"inverted_cells", "flat_cells", "faces_without_cells", "merged_faces",
                              "hanging_vertices", "unreferenced_vertices"})
    EXPECT_EQ(s.findings.count(finding), 0) << finding;
  // Merging short edges may leave two faces of a cell with two edges in common.
  if (!is_voronoi(family())) {
    EXPECT_EQ(s.findings.count("subdividing_vertices"), 0);
  }
  EXPECT_TRUE(s.boundary.closed);
  EXPECT_EQ(s.boundary.euler_characteristic, 2);
  EXPECT_EQ(s.boundary.components, 1);
  EXPECT_EQ(s.boundary.nonmanifold_edges + s.boundary.nonmanifold_vertices +
                s.boundary.inconsistent_edges,
            0);
}

TEST_P(VolumeFamily, VirtualTetrahedraArePositiveAndFillTheDomain) {
  const PolyhedralMesh mesh = generate_volume(family(), options());
  const VirtualTets tets = measure_virtual_tets(mesh);
  EXPECT_EQ(tets.inverted, 0);
  if (std::get<3>(GetParam()) == 1) {
    EXPECT_EQ(tets.moved_face_points, 0);
    // Some 1/10 without jitter; with the most jitter each keeps a tenth of its volume.
    EXPECT_GT(tets.least_quality, std::get<2>(GetParam()) == 0 ? 0.01 : 0.003);
  }
  if (is_ball(family())) {
    // The boundary's inscribed polygons lie inside the sphere.
    EXPECT_LT(tets.volume, kBallVolume);
  } else {
    EXPECT_NEAR(tets.volume, 1, tets.count * kEps);  // equal volumes round alike
  }
}

TEST_P(VolumeFamily, BoundaryLiesExactlyOnTheDomain) {
  const PolyhedralMesh mesh = generate_volume(family(), options());
  const std::vector<bool> boundary = boundary_vertices(mesh);
  Index corners = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3 x = mesh.point(v);
    EXPECT_EQ(walls(family(), x) != 0, boundary[v]) << "vertex " << v << " at " << x.transpose();
    if (is_ball(family())) {
      EXPECT_LE(x.norm(), 1 + 4 * kEps);
    } else {
      EXPECT_TRUE((x.array() >= 0).all() && (x.array() <= 1).all());
      corners += std::popcount(walls(family(), x)) == 3 ? 1 : 0;
    }
  }
  if (is_ball(family())) return;
  EXPECT_EQ(corners, 8);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    if (!mesh.face_cells()[f].boundary()) continue;
    unsigned common = ~0u;
    for (const Index v : mesh.face(f)) common &= walls(family(), mesh.point(v));
    EXPECT_EQ(std::popcount(common), 1) << "face " << f << " does not lie on one side of the cube";
  }
}

std::string case_name(const testing::TestParamInfo<Case>& test) {
  const auto& [family, level, jitter, anisotropy] = test.param;
  std::string name = family;
  std::replace(name.begin(), name.end(), '-', '_');
  return name + "_L" + std::to_string(level) + "_j" + std::to_string(std::lround(10 * jitter)) +
         "_a" + std::to_string(std::lround(anisotropy));
}

INSTANTIATE_TEST_SUITE_P(Plain, VolumeFamily,
                         testing::Combine(testing::ValuesIn(all_families()), testing::Values(0, 1),
                                          testing::Values(0.0, 0.3, 0.5), testing::Values(1.0)),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Fine, VolumeFamily,
                         testing::Combine(testing::ValuesIn(all_families()), testing::Values(2),
                                          testing::Values(0.0), testing::Values(1.0)),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Graded, VolumeFamily,
                         testing::Combine(testing::ValuesIn(all_families()), testing::Values(0, 1),
                                          testing::Values(0.0, 0.3), testing::Values(4.0)),
                         case_name);

// ---- counts and convergence ----------------------------------------------------------------

Index cells_of(const VolumeStatistics& s, CellKind kind) {
  return s.cells_of_kind[static_cast<std::size_t>(kind)];
}

TEST(VolumeFamilies, AreSixteen) {
  std::vector<std::string> expected;
  for (const char* domain : {"cube-", "ball-"})
    for (const char* shape : {"hexahedra", "pyramids", "truncated", "voronoi", "tets",
                              "tets-adaptive", "prisms", "random-hex"})
      expected.push_back(std::string(domain) + shape);
  EXPECT_EQ(all_families(), expected);
  for (const VolumeFamilyEntry& entry : volume_families())
    EXPECT_STREQ(entry.domain, is_ball(entry.name) ? "unit ball" : "unit cube");
}

TEST(VolumeFamilies, CountsByLevel) {
  for (const std::string domain : {"cube-", "ball-"})
    for (int level = 0; level < 3; ++level) {
      const Index k = 1 << level;
      const auto statistics = [&](const char* shape) {
        return volume_statistics(generate_volume(domain + shape, {.level = level}));
      };
      const auto cube = [](Index n) { return n * n * n; };
      for (const char* shape : {"hexahedra", "random-hex"}) {
        const VolumeStatistics s = statistics(shape);
        EXPECT_EQ(s.all_faces.vertices, cube(4 * k + 1));
        EXPECT_EQ(s.cells, cube(4 * k));
        EXPECT_EQ(cells_of(s, CellKind::Hexahedron), s.cells);
      }
      const VolumeStatistics pyramids = statistics("pyramids");
      EXPECT_EQ(pyramids.all_faces.vertices, cube(3 * k + 1) + cube(3 * k));
      EXPECT_EQ(pyramids.cells, 6 * cube(3 * k));
      EXPECT_EQ(cells_of(pyramids, CellKind::Pyramid), pyramids.cells);

      const VolumeStatistics tets = statistics("tets");
      EXPECT_EQ(tets.all_faces.vertices, cube(3 * k + 1) + cube(3 * k));
      EXPECT_EQ(tets.cells, 12 * cube(3 * k));
      EXPECT_EQ(cells_of(tets, CellKind::Tetrahedron), tets.cells);

      const VolumeStatistics adaptive = statistics("tets-adaptive");
      EXPECT_EQ(cells_of(adaptive, CellKind::Tetrahedron), adaptive.cells);

      const VolumeStatistics prisms = statistics("prisms");
      EXPECT_EQ(prisms.all_faces.vertices, cube(4 * k + 1));
      EXPECT_EQ(prisms.cells, 2 * cube(4 * k));
      EXPECT_EQ(cells_of(prisms, CellKind::Wedge), prisms.cells);

      // All points but those on the twelve edges are cut off: octahedra inside, pyramids on the
      // sides. A cube keeps its six sides and has one more for every corner that was cut off.
      const Index n = 2 * k;
      const VolumeStatistics truncated = statistics("truncated");
      EXPECT_EQ(truncated.cells, cube(n) + cube(n - 1) + 6 * (n - 1) * (n - 1));
      EXPECT_EQ(cells_of(truncated, CellKind::Pyramid), 6 * (n - 1) * (n - 1));
      if (n > 2) {
        EXPECT_EQ(truncated.cells_of_size[14], cube(n - 2) + 6 * (n - 2) * (n - 2));
        EXPECT_EQ(truncated.cells_of_size[12], 12 * (n - 2));
        EXPECT_EQ(truncated.cells_of_size[10], 8);
        EXPECT_EQ(truncated.cells_of_size[8], cube(n - 1));
      }
      EXPECT_EQ(statistics("voronoi").cells, cube(3 * k) + cube(3 * k - 1));
    }
}

TEST(VolumeFamilies, EdgesHalveAndVolumesConverge) {
  for (const std::string& family : all_families()) {
    double previous_edge = 0, previous_error = 0;
    Index previous_vertices = 0;
    const int last = is_voronoi(family) ? 2 : 3;  // those meshes are large
    for (int level = 0; level <= last; ++level) {
      const PolyhedralMesh mesh = generate_volume(family, {.level = level});
      if (level == 0) {
        EXPECT_GE(mesh.n_vertices(), 50) << family;
        EXPECT_LE(mesh.n_vertices(), 200) << family;
      }
      const MeshStatistics s = mesh_statistics(mesh.face_mesh());
      const double error =
          std::abs(mesh_statistics(boundary_surface(mesh).mesh).enclosed_volume / kBallVolume - 1);
      if (level == last) {
        // Coarse balls have short chords where the cells are largest, and Voronoi cells and random
        // hexahedra differ by chance.
        EXPECT_NEAR(s.edge_length.max / previous_edge, 0.5, depends_on_seed(family) ? 0.08 : 0.04)
            << family;
        EXPECT_NEAR(double(mesh.n_vertices()) / previous_vertices, 8, 1.6) << family;
        if (is_ball(family)) {
          EXPECT_NEAR(error / previous_error, 0.25, is_voronoi(family) ? 0.05 : 0.02) << family;
        }
      }
      previous_edge = s.edge_length.max;
      previous_error = error;
      previous_vertices = mesh.n_vertices();
    }
  }
}

TEST(VolumeFamilies, AdaptiveSizesDifferEightfold) {
  for (int level = 0; level < 3; ++level) {
    const PolyhedralMesh mesh = generate_volume("cube-tets-adaptive", {.level = level});
    // Of the cells at two opposite corners of the cube.
    double longest_near = 0, longest_far = 0;
    const auto touches = [&](Index c, const Vec3& x) {
      return std::ranges::any_of(mesh.cell_vertices().row(c),
                                 [&](Index v) { return mesh.point(v) == x; });
    };
    for (Index c = 0; c < mesh.n_cells(); ++c)
      for (const Index a : mesh.cell_vertices().row(c))
        for (const Index b : mesh.cell_vertices().row(c)) {
          const double length = (mesh.point(a) - mesh.point(b)).norm();
          if (touches(c, Vec3::Zero())) longest_near = std::max(longest_near, length);
          if (touches(c, Vec3::Ones())) longest_far = std::max(longest_far, length);
        }
    EXPECT_GE(longest_far / longest_near, 4) << "level " << level;
    const auto lengths = mesh_statistics(mesh.face_mesh()).edge_length;
    EXPECT_GE(lengths.max / lengths.min, 8);
  }
}

TEST(VolumeFamilies, TetrahedraAreGood) {
  for (int level = 0; level < 3; ++level) {
    // Quality of volume_statistics: 1 is regular. The lattice's own is 0.9; those on the border
    // are a quarter of a pyramid.
    EXPECT_GT(volume_statistics(generate_volume("cube-tets", {.level = level})).cell_quality.min,
              0.4);
    EXPECT_GT(
        volume_statistics(generate_volume("cube-tets-adaptive", {.level = level})).cell_quality.min,
        0.4);
    EXPECT_GT(volume_statistics(generate_volume("ball-tets", {.level = level})).cell_quality.min,
              0.2);
  }
}

TEST(VolumeFamilies, TruncatedEdgesAreOfOneLength) {
  const PolyhedralMesh mesh = generate_volume("cube-truncated", {.level = 2});
  Index inner = 0;
  for (const auto& [a, b] : mesh.face_mesh().edges().vertices) {
    const Vec3 x = mesh.point(a), y = mesh.point(b);
    // Edges of the unit cube are not cut.
    if (std::popcount(walls("cube-", x)) > 1 || std::popcount(walls("cube-", y)) > 1) continue;
    EXPECT_NEAR((x - y).norm(), (std::numbers::sqrt2 - 1) / 8, 8 * kEps);
    ++inner;
  }
  EXPECT_GT(inner, 5000);
}

TEST(VolumeFamilies, VoronoiCellsDifferAndHaveNoShortEdges) {
  for (const std::string family : {"cube-voronoi", "ball-voronoi"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 2});
    const VolumeStatistics s = volume_statistics(mesh);
    for (const std::size_t n : {9u, 10u, 11u, 12u, 13u, 14u})
      EXPECT_GT(s.cells_of_size.at(n), 20) << family;
    // 0.1 of a cube, of which there are 12 along a side; a merged vertex may come closer.
    const double size = is_ball(family) ? std::cbrt(kBallVolume) : 1;
    EXPECT_GT(s.all_faces.edge_length.min, 0.07 * size / 12) << family;
  }
}

TEST(VolumeFamilies, RandomHexahedraHaveBentFaces) {
  for (const std::string family : {"cube-random-hex", "ball-random-hex"}) {
    const MeshStatistics s = volume_statistics(generate_volume(family, {.level = 2})).all_faces;
    EXPECT_GT(s.nonplanar_faces, 0.85 * s.faces) << family;
    const MeshStatistics regular =
        volume_statistics(generate_volume("cube-hexahedra", {.level = 2})).all_faces;
    EXPECT_EQ(regular.nonplanar_faces, 0);
  }
}

// ---- jitter, anisotropy, seed, numbers -----------------------------------------------------

TEST(VolumeFamilies, SeedsDetermineTheMesh) {
  for (const std::string& family : all_families()) {
    const auto points = [&](double jitter, std::uint64_t seed) {
      return generate_volume(family, {.level = 1, .jitter = jitter, .seed = seed}).points();
    };
    const auto differ = [](const Points& a, const Points& b) {
      return a.rows() != b.rows() || (a - b).cwiseAbs().maxCoeff() > 1e-3;
    };
    EXPECT_EQ(points(0.3, 5), points(0.3, 5)) << family;
    EXPECT_EQ(points(0, 5), points(0, 5)) << family;
    EXPECT_EQ(differ(points(0, 5), points(0, 6)), depends_on_seed(family)) << family;
    EXPECT_TRUE(differ(points(0.3, 5), points(0.3, 6))) << family;
  }
}

TEST(VolumeFamilies, JitterIsTheSameEverywhere) {
  // By an independent script from the definition (SplitMix64, rejection in the ball). A change
  // here changes every jittered mesh that was ever published.
  const PolyhedralMesh mesh =
      generate_volume("cube-hexahedra", {.level = 0, .jitter = 0.25, .seed = 42});
  EXPECT_DOUBLE_EQ(mesh.point(62).x(), 0.5252376923792756);
  EXPECT_DOUBLE_EQ(mesh.point(62).y(), 0.4742263172709123);
  EXPECT_DOUBLE_EQ(mesh.point(62).z(), 0.5399571437163524);
}

TEST(VolumeFamilies, JitterStaysWithinItsReachAndItsWall) {
  for (const std::string& family : all_families()) {
    if (is_voronoi(family)) continue;  // there it moves the sites
    const PolyhedralMesh mesh = generate_volume(family, {.level = 1});
    std::vector<double> shortest(static_cast<std::size_t>(mesh.n_vertices()), 1e300);
    for (const auto& ends : mesh.face_mesh().edges().vertices)
      for (const Index v : ends)
        shortest[v] = std::min(shortest[v], (mesh.point(ends[0]) - mesh.point(ends[1])).norm());
    const PolyhedralMesh moved = generate_volume(family, {.level = 1, .jitter = 0.2});
    ASSERT_EQ(moved.n_vertices(), mesh.n_vertices());
    double farthest = 0;
    Index free = 0, moved_vertices = 0, slid = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const double distance = (moved.point(v) - mesh.point(v)).norm() / shortest[v];
      const unsigned on = walls(family, mesh.point(v));
      EXPECT_EQ(walls(family, moved.point(v)), on) << family << " vertex " << v;
      farthest = std::max(farthest, distance);
      free += std::popcount(on) < 3 ? 1 : 0;
      moved_vertices += distance > 0 ? 1 : 0;
      slid += on != 0 && distance > 0 ? 1 : 0;
    }
    EXPECT_LE(farthest, 0.2 * (1 + 1e-9)) << family;
    EXPECT_GT(farthest, 0.15) << family;
    EXPECT_EQ(moved_vertices, free) << family;
    EXPECT_GT(slid, 90) << family;
  }
}

TEST(VolumeFamilies, AnisotropyStretches) {
  // Widths of the cells at both ends in the ratio of the anisotropy.
  const PolyhedralMesh cubes = generate_volume("cube-hexahedra", {.level = 3, .anisotropy = 8});
  const Index n = 32;
  std::vector<double> x(cubes.points().col(0).begin(), cubes.points().col(0).end());
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  ASSERT_EQ(static_cast<Index>(x.size()), n + 1);
  EXPECT_NEAR((x[n] - x[n - 1]) / (x[1] - x[0]), std::pow(8.0, 1 - 1.0 / n), 1e-9);
  for (const std::string& family : all_families()) {
    const PolyhedralMesh plain = generate_volume(family, {.level = 1});
    const PolyhedralMesh graded = generate_volume(family, {.level = 1, .anisotropy = 4});
    EXPECT_EQ(graded.face_mesh().faces().indices, plain.face_mesh().faces().indices) << family;
    const int axis = is_ball(family) ? 2 : 0;
    const auto spread = [&](const PolyhedralMesh& mesh) {
      return mesh.points().col(axis).cwiseAbs().mean();
    };
    EXPECT_LT(spread(graded), 0.85 * spread(plain)) << family;
  }
}

TEST(VolumeFamilies, VerticesAreNumberedLocally) {
  for (const std::string& family : all_families()) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 2});
    double span = 0;
    for (Index c = 0; c < mesh.n_cells(); ++c) {
      const auto [low, high] = std::ranges::minmax(mesh.cell_vertices().row(c));
      span += high - low;
    }
    // Numbers within a cell stay within about two layers of 8 to 16.
    EXPECT_LT(span / mesh.n_cells(), 0.2 * mesh.n_vertices()) << family;
  }
}

// ---- errors --------------------------------------------------------------------------------

std::string message_of(const std::string& family, const FamilyOptions& options) {
  try {
    generate_volume(family, options);
  } catch (const InvalidOption& error) {
    return error.what();
  }
  return "";
}

TEST(VolumeFamilies, RefuseBadOptions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string unknown = message_of("cube-moebius", {});
  EXPECT_NE(unknown.find("'cube-moebius' is unknown"), std::string::npos);
  for (const std::string& family : all_families()) {
    EXPECT_NE(unknown.find(family), std::string::npos);
    EXPECT_EQ(message_of(family, {.level = -1}), "level -1: a refinement level is 0 or more");
    for (const int level : {10, 31, 64, 1000, std::numeric_limits<int>::max()})
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

TEST(VolumeFamilies, SurviveExtremeOptionsOrRefuseThem) {
  Index refused = 0;
  for (const std::string& family : all_families())
    for (int level = 0; level < 2; ++level) {
      const FamilyOptions options{.level = level, .jitter = 0.5, .anisotropy = 1000, .seed = 99};
      const std::string message = message_of(family, options);
      if (message.empty()) {
        EXPECT_EQ(measure_virtual_tets(generate_volume(family, options)).inverted, 0) << family;
        continue;
      }
      ++refused;
      EXPECT_TRUE(is_ball(family)) << family << ": " << message;
      EXPECT_TRUE(message.starts_with("anisotropy 1000")) << message;
      EXPECT_NE(message.find("would be inverted; choose a smaller one, or a higher level"),
                std::string::npos);
    }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace carat
