#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carat/mesh/hanging_vertices.h"
#include "carat/mesh/volume_statistics.h"

namespace carat {
namespace {

using Faces = std::vector<std::vector<Index>>;
constexpr double kEps = std::numeric_limits<double>::epsilon();

Points make_points(const std::vector<std::array<double, 3>>& x) {
  Points points(static_cast<Eigen::Index>(x.size()), 3);
  for (std::size_t i = 0; i < x.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) << x[i][0], x[i][1], x[i][2];
  return points;
}

PolyhedralMesh make_cells(const Points& points, const std::vector<Faces>& cells) {
  CellCollector collector;
  for (const Faces& faces : cells) {
    for (const auto& face : faces) collector.add_face(face);
    collector.end_cell();
  }
  return std::move(collector).build(points);
}

const std::vector<Index>& ids(const VolumeStatistics& s, const char* name) {
  const Finding* const finding = s.findings.find(name);
  EXPECT_NE(finding, nullptr) << name;
  static const std::vector<Index> none;
  return finding == nullptr ? none : finding->elements;
}

std::vector<std::string> kinds_of_findings(const VolumeStatistics& s) {
  std::vector<std::string> found;
  for (const Finding& finding : s.findings.findings())
    if (!finding.elements.empty()) found.push_back(finding.name);
  return found;
}

/// n x n x n cubes in the unit cube; vertex (i, j, k) is i + (n + 1) (j + (n + 1) k).
PolyhedralMesh grid(Index n) {
  const Index m = n + 1;
  Points points(m * m * m, 3);
  for (Index v = 0; v < points.rows(); ++v)
    points.row(v) << static_cast<double>(v % m) / n, static_cast<double>(v / m % m) / n,
        static_cast<double>(v / m / m) / n;
  Eigen::Matrix<Index, Eigen::Dynamic, 8, Eigen::RowMajor> cells(n * n * n, 8);
  for (Index c = 0; c < cells.rows(); ++c) {
    const Index v = c % n + m * (c / n % n + m * (c / n / n));
    cells.row(c) << v, v + 1, v + 1 + m, v + m, v + m * m, v + 1 + m * m, v + 1 + m + m * m,
        v + m + m * m;
  }
  return PolyhedralMesh::from_hexes(points, cells);
}

const Points kTetrahedron = make_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
const Faces kTetrahedronFaces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

TEST(VolumeStatistics, EmptyMesh) {
  const VolumeStatistics s = volume_statistics(PolyhedralMesh());
  EXPECT_EQ(s.cells + s.inner_faces + s.boundary_faces + s.components + s.vertex_components, 0);
  EXPECT_EQ(s.volume, 0);
  EXPECT_EQ(s.cell_quality.max, 0);
  EXPECT_TRUE(s.hanging_vertices_complete);
  EXPECT_EQ(kinds_of_findings(s), std::vector<std::string>());
}

TEST(VolumeStatistics, GridOfCubes) {
  const VolumeStatistics s = volume_statistics(grid(3));
  EXPECT_EQ(s.cells, 27);
  EXPECT_EQ(s.all_faces.vertices, 64);
  EXPECT_EQ(s.all_faces.edges, 3 * 3 * 16);
  EXPECT_EQ(s.all_faces.faces, 108);
  EXPECT_EQ(s.boundary_faces, 54);
  EXPECT_EQ(s.inner_faces, 54);
  EXPECT_EQ(s.cells_of_size, (std::vector<Index>{0, 0, 0, 0, 0, 0, 27}));
  EXPECT_EQ(s.cells_of_kind, (std::array<Index, 5>{0, 27, 0, 0, 0}));
  EXPECT_EQ(s.all_faces.faces_of_valence, (std::vector<Index>{0, 0, 0, 0, 108}));
  EXPECT_EQ(s.components, 1);
  EXPECT_EQ(s.vertex_components, 1);
  EXPECT_EQ(s.boundary.components, 1);
  EXPECT_EQ(s.boundary.euler_characteristic, 2);
  EXPECT_EQ(s.boundary.nonmanifold_edges, 0);
  EXPECT_NEAR(s.volume, 1, 27 * kEps);
  EXPECT_NEAR(s.boundary.enclosed_volume, 1, 54 * kEps);
  EXPECT_NEAR(s.boundary.area, 6, 54 * kEps);
  EXPECT_NEAR(s.cell_volume.min, 1.0 / 27, 8 * kEps);
  EXPECT_NEAR(s.cell_volume.max, 1.0 / 27, 8 * kEps);
  EXPECT_NEAR(s.cell_quality.min, 1, 32 * kEps);
  EXPECT_EQ(kinds_of_findings(s), std::vector<std::string>());
}

TEST(VolumeStatistics, RegularSolidsHaveQualityOne) {
  const double phi = (1 + std::sqrt(5)) / 2;
  const PolyhedralMesh tetrahedron = make_cells(
      make_points({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}), {kTetrahedronFaces});
  EXPECT_NEAR(volume_statistics(tetrahedron).cell_quality.mean, 1, 32 * kEps);
  EXPECT_NEAR(volume_statistics(tetrahedron).volume, 8.0 / 3, 32 * kEps);
  const double a = 1 / phi, b = phi;
  const PolyhedralMesh dodecahedron =
      make_cells(make_points({{1, 1, 1},   {1, 1, -1},  {1, -1, 1},   {1, -1, -1}, {-1, 1, 1},
                              {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}, {0, a, b},   {0, a, -b},
                              {0, -a, b},  {0, -a, -b}, {a, b, 0},    {a, -b, 0},  {-a, b, 0},
                              {-a, -b, 0}, {b, 0, a},   {b, 0, -a},   {-b, 0, a},  {-b, 0, -a}}),
                 {{{0, 8, 10, 2, 16},
                   {0, 16, 17, 1, 12},
                   {0, 12, 14, 4, 8},
                   {1, 17, 3, 11, 9},
                   {1, 9, 5, 14, 12},
                   {2, 10, 6, 15, 13},
                   {2, 13, 3, 17, 16},
                   {3, 13, 15, 7, 11},
                   {4, 14, 5, 19, 18},
                   {4, 18, 6, 10, 8},
                   {5, 9, 11, 7, 19},
                   {6, 18, 19, 7, 15}}});
  EXPECT_NEAR(volume_statistics(dodecahedron).cell_quality.mean, 1, 128 * kEps);
  const double corner = volume_statistics(make_cells(kTetrahedron, {kTetrahedronFaces}))
                            .cell_quality.mean;  // V = 1/6, A = (3 + sqrt 3)/2
  EXPECT_NEAR(corner, 216 * std::sqrt(3) / 36 / std::pow((3 + std::sqrt(3)) / 2, 3), 32 * kEps);
}

TEST(VolumeStatistics, PartsAndPinches) {
  // Two tetrahedra that share vertex 0 alone, a third one that shares edge (0, 1) with the first,
  // and a fourth one apart.
  const Points points = make_points({{0, 0, 0},
                                     {1, 0, 0},
                                     {0, 1, 0},
                                     {0, 0, 1},
                                     {-1, 0, 0},
                                     {0, -1, 0},
                                     {0, 0, -1},
                                     {0.5, -1, 0},
                                     {0.5, 0, -1},
                                     {9, 9, 9},
                                     {10, 9, 9},
                                     {9, 10, 9},
                                     {9, 9, 10},
                                     {7, 7, 7}});
  const auto tetrahedron = [](Index a, Index b, Index c, Index d) {
    return Faces{{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
  };
  const VolumeStatistics s =
      volume_statistics(make_cells(points, {tetrahedron(0, 1, 2, 3), tetrahedron(0, 4, 5, 6),
                                            tetrahedron(0, 1, 7, 8), tetrahedron(9, 10, 11, 12)}));
  EXPECT_EQ(s.components, 4);
  EXPECT_EQ(s.vertex_components, 2);
  EXPECT_EQ(s.boundary.components, 2);
  EXPECT_EQ(s.boundary.nonmanifold_edges, 1);
  EXPECT_EQ(s.boundary.nonmanifold_vertices, 1);
  EXPECT_EQ(ids(s, "unreferenced_vertices"), (std::vector<Index>{13}));
}

TEST(VolumeStatistics, NamesBadCells) {
  // Vertex 13 is the middle of 3 x 3 x 3: cell 0 is turned inside out by it, others overlap.
  PolyhedralMesh mesh = grid(2);
  Points points = mesh.points();
  points.row(13) << -0.9, -0.9, -0.9;
  const VolumeStatistics inverted = volume_statistics(mesh.with_points(points));
  EXPECT_EQ(ids(inverted, "inverted_cells"), (std::vector<Index>{0}));
  EXPECT_LT(inverted.cell_volume.min, 0);
  EXPECT_EQ(inverted.cell_quality.min, 0);
  EXPECT_NEAR(inverted.volume, 1, 100 * kEps);  // inner faces cancel, wherever they are
  EXPECT_GT(inverted.all_faces.nonplanar_faces, 0);

  points = kTetrahedron;
  points(3, 2) = 1e-15;
  const VolumeStatistics flat = volume_statistics(make_cells(points, {kTetrahedronFaces}));
  EXPECT_EQ(ids(flat, "flat_cells"), (std::vector<Index>{0}));
  EXPECT_EQ(flat.cell_quality.max, 0);
  points(3, 2) = 1e-5;  // thin, but a cell
  const VolumeStatistics thin = volume_statistics(make_cells(points, {kTetrahedronFaces}));
  EXPECT_EQ(ids(thin, "flat_cells"), std::vector<Index>());
  EXPECT_EQ(ids(thin, "short_edges"), (std::vector<Index>{2}));  // (0, 3)
  EXPECT_EQ(ids(thin, "tiny_faces"), std::vector<Index>());
  points.row(2) << 0, 1e-5, 0;
  EXPECT_EQ(ids(volume_statistics(make_cells(points, {kTetrahedronFaces})), "tiny_faces").size(),
            1u);
}

TEST(VolumeStatistics, RepairsAndLeftOvers) {
  // A tetrahedron in VTK's order with two vertices exchanged.
  CellCollector turned;
  turned.add(CellType::Tetrahedron, std::array<Index, 4>{0, 2, 1, 3});
  EXPECT_EQ(ids(volume_statistics(std::move(turned).build(kTetrahedron)), "turned_cells").size(),
            1u);

  // Faces 4 repeats face 0 and is of no cell; face 5 is of no cell either.
  Csr faces, cells;
  for (const auto& face : Faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 2, 0}, {0, 1, 4}}) {
    faces.indices.insert(faces.indices.end(), face.begin(), face.end());
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  cells.indices = {0, 1, 2, 3};
  cells.offsets.push_back(4);
  Points points(5, 3);
  points << kTetrahedron, 5, 5, 5;
  const VolumeStatistics s = volume_statistics(PolyhedralMesh(points, faces, cells));
  EXPECT_EQ(ids(s, "merged_faces"), (std::vector<Index>{0}));
  EXPECT_EQ(ids(s, "faces_without_cells"), (std::vector<Index>{4}));
  EXPECT_EQ(ids(s, "unreferenced_vertices"), (std::vector<Index>{4}));
  EXPECT_EQ(s.boundary_faces, 4);
}

TEST(VolumeStatistics, BafflesAreDuplicateFaces) {
  // Two cubes side by side that do not share the face between them: both have their own.
  const PolyhedralMesh whole = grid(1);
  Points points(12, 3);
  points << whole.points(), 2, 0, 0, 2, 1, 0, 2, 0, 1, 2, 1, 1;
  Csr faces;
  for (const auto& face : Faces{{0, 4, 6, 2},
                                {0, 1, 5, 4},
                                {2, 6, 7, 3},
                                {0, 2, 3, 1},
                                {4, 5, 7, 6},
                                {1, 3, 7, 5},
                                {1, 5, 7, 3},
                                {8, 9, 11, 10},
                                {1, 8, 10, 5},
                                {3, 7, 11, 9},
                                {1, 3, 9, 8},
                                {5, 10, 11, 7}}) {
    faces.indices.insert(faces.indices.end(), face.begin(), face.end());
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  const std::vector<Index> owner{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  const VolumeStatistics s =
      volume_statistics(PolyhedralMesh::from_owner_neighbour(points, faces, owner, {}));
  EXPECT_EQ(s.all_faces.duplicate_faces, 1);
  EXPECT_EQ(s.boundary_faces, 12);
  EXPECT_EQ(s.components, 2);
  EXPECT_EQ(s.vertex_components, 1);
  EXPECT_EQ(ids(s, "hanging_vertices"), std::vector<Index>());
  EXPECT_NEAR(s.volume, 2, 16 * kEps);
}

/// A coarse cube beside 2 x 2 x 2 fine ones, at x = 1. Named: the coarse cell has the four fine
/// faces instead of one, and its other faces the vertices on their edges.
PolyhedralMesh coarse_and_fine(bool named) {
  const PolyhedralMesh fine = grid(2);
  Points points(27 + 4, 3);
  points << fine.points().array().rowwise() + Eigen::RowVector3d(1, 0, 0).array(), 0, 0, 0, 0, 1, 0,
      0, 0, 1, 0, 1, 1;
  std::vector<Faces> cells;
  for (Index c = 0; c < 8; ++c) {
    Faces faces;
    for (const Index f : fine.cell(c)) faces.emplace_back(fine.face(f).begin(), fine.face(f).end());
    cells.push_back(faces);
  }
  if (named) {
    cells.push_back({{27, 28, 30, 29},
                     {27, 29, 18, 9, 0},
                     {28, 6, 15, 24, 30},
                     {27, 0, 3, 6, 28},
                     {29, 30, 24, 21, 18},
                     {0, 9, 12, 3},
                     {3, 12, 15, 6},
                     {9, 18, 21, 12},
                     {12, 21, 24, 15}});
  } else {
    cells.push_back({{27, 28, 30, 29},
                     {27, 29, 18, 0},
                     {28, 6, 24, 30},
                     {27, 0, 6, 28},
                     {29, 30, 24, 18},
                     {0, 18, 24, 6}});
  }
  return make_cells(points, cells);
}

TEST(VolumeStatistics, HangingVertices) {
  const VolumeStatistics loose = volume_statistics(coarse_and_fine(false));
  EXPECT_EQ(ids(loose, "hanging_vertices"), (std::vector<Index>{3, 9, 12, 15, 21}));
  EXPECT_EQ(ids(loose, "subdividing_vertices"), std::vector<Index>());
  EXPECT_EQ(loose.components, 2);
  EXPECT_EQ(loose.vertex_components, 1);
  const VolumeStatistics joined = volume_statistics(coarse_and_fine(true));
  EXPECT_EQ(ids(joined, "hanging_vertices"), std::vector<Index>());
  EXPECT_EQ(joined.components, 1);
  EXPECT_EQ(joined.cells_of_size, (std::vector<Index>{0, 0, 0, 0, 0, 0, 8, 0, 0, 1}));
  EXPECT_NEAR(joined.volume, 2, 64 * kEps);
}

TEST(VolumeStatistics, SubdividingVertices) {
  Points points(5, 3);
  points << kTetrahedron, 0.5, 0, 0;
  const VolumeStatistics s =
      volume_statistics(make_cells(points, {{{0, 2, 1, 4}, {0, 4, 1, 3}, {1, 2, 3}, {2, 0, 3}}}));
  EXPECT_EQ(ids(s, "subdividing_vertices"), (std::vector<Index>{4}));
  EXPECT_EQ(ids(s, "hanging_vertices"), std::vector<Index>());
}

TEST(VolumeStatistics, HangingVerticesFollowTheMesh) {
  const PolyhedralMesh mesh = coarse_and_fine(false);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()));
  const std::vector<Index> expected{3, 9, 12, 15, 21};
  for (const double scale : {1e-9, 1.0, 1e9}) {
    const Points turned = scale * (mesh.points() * turn.transpose());
    EXPECT_EQ(hanging_vertices(mesh.with_points(turned)).vertices, expected) << scale;
    Points far = turned;  // where coordinates are rounded to 1e-12 of the mesh
    far.rowwise() += scale * Eigen::RowVector3d(1e4, -1e4, 1e4);
    EXPECT_EQ(hanging_vertices(mesh.with_points(far)).vertices, expected) << scale;
  }
  // 1e-3 off the plane, the vertices of the fine side are a crack and no longer touch.
  Points apart = mesh.points();
  for (const Index v : expected) apart(v, 0) += 1e-3;
  EXPECT_EQ(hanging_vertices(mesh.with_points(apart)).vertices, std::vector<Index>());
}

TEST(VolumeStatistics, SearchForHangingVerticesIsGivenUpBeforeItIsQuadratic) {
  // Tetrahedra through each other: every vertex lies in the box of every face.
  const Index n = 3000;
  Points points(4 * n, 3);
  Eigen::Matrix<Index, Eigen::Dynamic, 4, Eigen::RowMajor> tets(n, 4);
  for (Index c = 0; c < n; ++c) {
    const double s = 1 + 1e-3 * c / n;
    points.middleRows(4 * c, 4) =
        s * make_points({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}});
    tets.row(c) << 4 * c, 4 * c + 1, 4 * c + 2, 4 * c + 3;
  }
  const HangingVertices found = hanging_vertices(PolyhedralMesh::from_tets(points, tets));
  EXPECT_FALSE(found.complete);
  EXPECT_TRUE(hanging_vertices(grid(6)).complete);
}

TEST(VolumeStatistics, FollowScaleAndTranslation) {
  const PolyhedralMesh mesh = coarse_and_fine(true);
  const VolumeStatistics reference = volume_statistics(mesh);
  for (const double scale : {1e-9, 1e-3, 1e9}) {
    const VolumeStatistics s = volume_statistics(mesh.with_points(scale * mesh.points()));
    EXPECT_NEAR(s.volume / (scale * scale * scale), reference.volume, 1e-13);
    EXPECT_NEAR(s.cell_quality.min, reference.cell_quality.min, 1e-13);
    EXPECT_EQ(kinds_of_findings(s), kinds_of_findings(reference));
  }
  // 1e6 diameters away coordinates are rounded to 1e6 eps, edges of 1/2 with them.
  Points far = mesh.points();
  far.rowwise() += Eigen::RowVector3d(2.5e6, -1.5e6, 1e6);
  const VolumeStatistics s = volume_statistics(mesh.with_points(far));
  EXPECT_NEAR(s.volume, reference.volume, 1e-8);
  EXPECT_NEAR(s.cell_quality.min, reference.cell_quality.min, 1e-8);
  EXPECT_EQ(kinds_of_findings(s), kinds_of_findings(reference));
}

}  // namespace
}  // namespace carat
