// The closed form for triangles against the general assembly of polygons.

#include <gtest/gtest.h>

#include <string>

#include "carat/generators/families.h"
#include "carat/operators/diamond/triangle_diamond.h"
#include "carat/operators/registry.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

/// Faces on the same vertices, glued back to back: opposite vertices are the same.
PolygonMesh pillow() {
  return make_mesh({{0, 0, 0}, {2, 0.1, 0}, {0.7, 1, 0}}, {{0, 1, 2}, {0, 2, 1}});
}

/// Eight faces; every opposite pair is coupled by four edges.
PolygonMesh octahedron() {
  return make_mesh(
      {{1, 0, 0}, {-1, 0.1, 0}, {0, 1.2, 0}, {0, -1, 0.2}, {0.1, 0, 0.9}, {0, 0.2, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

/// A fan of n triangles around vertex 0, closed.
PolygonMesh fan(Index n) {
  std::vector<Vec3> points{{0, 0, 0.3}};
  Faces faces;
  for (Index i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.3 * std::sin(5.0 * i)) / n;
    points.emplace_back((1 + 0.2 * std::cos(3.0 * i)) * std::cos(angle), std::sin(angle), 0);
    faces.push_back({0, i + 1, (i + 1) % n + 1});
  }
  return make_mesh(points, faces);
}

/// A curved and jittered sheet with numbers in disorder; larger than one block of rows.
PolygonMesh sheet(Index n) {
  std::vector<Vec3> points(static_cast<std::size_t>(n * n));
  const auto number = [n](Index i, Index j) { return (n * j + i) * 7919 % (n * n); };
  Faces faces;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      points[number(i, j)] = {i + 0.2 * std::sin(7.0 * i + j), j + 0.2 * std::cos(5.0 * j + i),
                              std::sin(0.1 * i) * j};
      if (i + 1 == n || j + 1 == n) continue;
      const Index a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1),
                  d = number(i, j + 1);
      faces.push_back({a, b, c});
      faces.push_back({c, d, a});
    }
  return make_mesh(points, faces);
}

std::vector<NamedMesh> triangle_meshes() {
  return {{"single_triangle", single_triangle()},
          {"pillow", pillow()},
          {"tetrahedron", tetrahedron()},
          {"octahedron", octahedron()},
          {"fan_of_3", fan(3)},
          {"fan_of_4", fan(4)},
          {"fan_of_12", fan(12)},
          {"sheet", sheet(60)},
          {"loose_vertices",
           make_mesh({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {8, 8, 8}}, {{1, 2, 3}})},
          {"thin_and_flat",
           make_mesh({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}, {0.5, -1, 0}, {2, 0, 0}, {3, 0, 0}},
                     {{0, 1, 2}, {1, 0, 3}, {1, 4, 5}})}};
}

/// The largest difference, relative to the largest entry; infinite if the patterns differ.
double difference(const SparseMatrix& a, const SparseMatrix& b) {
  if (a.rows() != b.rows() || a.nonZeros() != b.nonZeros() ||
      !std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.rows() + 1, b.outerIndexPtr()) ||
      !std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()))
    return std::numeric_limits<double>::infinity();
  if (a.nonZeros() == 0) return 0;
  return (a.coeffs() - b.coeffs()).abs().maxCoeff() / a.coeffs().abs().maxCoeff();
}

TEST(TriangleDiamond, equals_the_general_assembly) {
  for (const NamedMesh& named : triangle_meshes())
    for (const MassKind mass : {MassKind::Full, MassKind::Lumped})
      for (const bool weighted : {false, true}) {
        SCOPED_TRACE(named.name + std::string(weighted ? ", weighted" : ""));
        DiscretizationOptions options;
        options.mass = mass;
        if (weighted) options.coefficient = [](const Vec3& x) { return 2 + std::sin(x.x()); };
        const Discretization general = discretize(named.mesh, "diamond", options);
        options.parts = DiscretizationParts::Matrices;
        ASSERT_NE(make_triangle_diamond("diamond", named.mesh, options), nullptr);
        const Discretization closed = discretize(named.mesh, "diamond", options);
        EXPECT_LT(difference(general.stiffness, closed.stiffness), 1e-14);
        EXPECT_LT(difference(general.mass, closed.mass), 1e-14);
        EXPECT_LT((general.sample_measure - closed.sample_measure).cwiseAbs().maxCoeff(),
                  1e-15 * general.sample_measure.maxCoeff());
        for (const Finding& finding : general.diagnostics.findings()) {
          const Finding* const same = closed.diagnostics.find(finding.name);
          ASSERT_NE(same, nullptr) << finding.name;
          EXPECT_EQ(same->elements, finding.elements) << finding.name;
        }
      }
}

TEST(TriangleDiamond, stabilised_equals_the_general_assembly) {
  std::vector<NamedMesh> meshes = triangle_meshes();
  meshes.push_back({"plane", generate_mesh("plane-triangles", {.level = 2, .jitter = 0.4})});
  meshes.push_back({"torus", generate_mesh("torus-triangles", {.level = 1, .jitter = 0.3})});
  for (const NamedMesh& named : meshes)
    for (const MassKind mass : {MassKind::Full, MassKind::MomentExact, MassKind::Lumped})
      for (const double theta : {0.0, 0.75, 1.0})
        for (const bool weighted : {false, true}) {
          SCOPED_TRACE(std::string(named.name) + ", theta " + std::to_string(theta) +
                       (weighted ? ", weighted" : ""));
          DiscretizationOptions options{.mass = mass, .theta = theta};
          if (mass == MassKind::MomentExact) options.tau = 0.6;
          if (weighted) options.coefficient = [](const Vec3& x) { return 2 + std::sin(x.x()); };
          const Discretization general = discretize(named.mesh, "stabilized_diamond", options);
          options.parts = DiscretizationParts::Matrices;
          const Discretization closed = discretize(named.mesh, "stabilized_diamond", options);
          // Of a triangle of height 1e-9, the crossing's place is known to 1e-16 / 1e-9.
          EXPECT_LT(difference(general.stiffness, closed.stiffness), 1e-12);
          EXPECT_LT(difference(general.mass, closed.mass), 1e-12);
          EXPECT_LT((general.sample_measure - closed.sample_measure).cwiseAbs().maxCoeff(),
                    1e-15 * general.sample_measure.maxCoeff());
          EXPECT_EQ(SparseMatrix(closed.stiffness.transpose()).coeffs().matrix(),
                    closed.stiffness.coeffs().matrix());
        }
}

TEST(TriangleDiamond, same_bits_for_any_number_of_threads) {
  const PolygonMesh mesh = sheet(70);
  for (const char* const name : {"diamond", "stabilized_diamond"})
    for (const MassKind mass : {MassKind::Full, MassKind::MomentExact}) {
      DiscretizationOptions options{.mass = mass};
      options.parts = DiscretizationParts::Matrices;
      options.threads = 1;
      const Discretization one = discretize(mesh, name, options);
      for (const int threads : {2, 3, 7}) {
        options.threads = threads;
        const PolygonMesh bare(mesh.points(), mesh.faces());
        const Discretization many = discretize(bare, name, options);
        EXPECT_EQ(difference(one.stiffness, many.stiffness), 0);
        EXPECT_EQ(difference(one.mass, many.mass), 0);
        EXPECT_EQ(mesh.edges().vertices, bare.edges().vertices);
        EXPECT_EQ(mesh.edges().corners.indices, bare.edges().corners.indices);
        EXPECT_EQ(mesh.edges().of_corner, bare.edges().of_corner);
      }
    }
}

TEST(TriangleDiamond, leaves_other_meshes_to_the_general_assembly) {
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}};
  const NamedMesh others[] = {
      {"quads", quad_grid(2, 2)},
      {"several sizes", make_mesh(points, {{0, 1, 2}, {0, 1, 3, 2}, {0, 1, 3, 2, 4}})},
      {"three triangles at an edge", make_mesh(points, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})},
      {"turned against each other", make_mesh(points, {{0, 1, 2}, {1, 2, 3}})}};
  for (const NamedMesh& named : others)
    EXPECT_EQ(make_triangle_diamond("diamond", named.mesh, options), nullptr) << named.name;
}

}  // namespace
}  // namespace carat::test
