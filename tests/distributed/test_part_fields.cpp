#include "carat/distributed/part_fields.h"
#include "carat/operators/part_discretization.h"
#include "parts.h"

namespace carat::test {
namespace {

constexpr double kTolerance = 1e-12;  // of sums in another order

Vector wave(const Points& points) {
  Vector u(points.rows());
  for (Index v = 0; v < u.size(); ++v) u[v] = std::sin(3 * points(v, 0)) + points.row(v).sum();
  return u;
}

double distance(const Points& own, const Points& whole, const Array<Index>& numbers,
                const std::vector<bool>& counts) {
  double worst = 0;
  for (Index k = 0; k < own.rows(); ++k)
    if (counts[static_cast<std::size_t>(k)])
      worst = std::max(worst, (own.row(k) - whole.row(numbers[k])).cwiseAbs().maxCoeff());
  return worst / std::max(1.0, whole.cwiseAbs().maxCoeff());
}

template <class Mesh>
void check(const Mesh& mesh, const std::vector<Index>& element_part, const std::string& name) {
  const DiscretizationOptions options{.parts = DiscretizationParts::Frames};
  const Discretization whole = discretize(mesh, name, options);
  const MeshPart<Mesh> part = own_part(mesh, element_part);
  const PartNumbers& numbers = part.numbers;
  const Discretization own = discretize_part(part, name, options);
  const PartFields fields(numbers, own);
  const Vector of_whole = whole.gradient * wave(mesh.points()),
               of_part = own.gradient * wave(part.mesh.points());
  EXPECT_LT(distance(fields.vertex_vectors(of_part), whole.vertex_vectors(of_whole),
                     numbers.vertices, std::vector<bool>(numbers.vertices.size(), true)),
            kTolerance);
  EXPECT_LT(
      distance(fields.element_vectors(of_part), whole.element_vectors(of_whole, n_elements(mesh)),
               numbers.elements, numbers.own_elements),
      kTolerance);
}

TEST(PartFields, are_those_of_the_whole_mesh) {
  for (const auto& [mesh_name, mesh] : surfaces_to_divide())
    for (const char* name : {"diamond", "stabilized_diamond", "bunge", "de_goes"}) {
      SCOPED_TRACE(mesh_name + " " + name);
      check(mesh, scattered(mesh.n_faces(), n_processes()), name);
    }
  for (const char* family : {"cube-tets", "ball-voronoi", "cube-hexahedra"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 0, .jitter = 0.2});
    for (const char* name : {"diamond", "bunge"}) {
      SCOPED_TRACE(std::string(family) + " " + name);
      check(mesh, scattered(mesh.n_cells(), n_processes()), name);
    }
  }
}

TEST(PartFields, directions_of_elements_have_the_same_divergence) {
  const PolygonMesh mesh = generate_mesh("plane-concave", {.level = 1});
  const DiscretizationOptions options{.parts = DiscretizationParts::Frames};
  for (const char* name : {"stabilized_diamond", "bunge"}) {
    SCOPED_TRACE(name);
    const Discretization whole = discretize(mesh, name, options);
    const auto part = own_part(mesh, scattered(mesh.n_faces(), n_processes()));
    const Discretization own = discretize_part(part, name, options);
    const Vector expected =
        whole.apply_divergence(whole.element_directions(whole.gradient * wave(mesh.points())));
    const Vector brought = own.apply_divergence(
        PartFields(part.numbers, own).element_directions(own.gradient * wave(part.mesh.points())));
    const Matrix sum = NumberExchange(part.numbers.vertices).sum(brought);
    EXPECT_LT(difference(sum.col(0), expected, part.numbers), kTolerance);
  }
  const auto part = own_block(mesh);
  const Discretization own = discretize_part(part, "diamond", options);
  EXPECT_THROW(
      PartFields(part.numbers, own).element_directions(own.gradient * wave(part.mesh.points())),
      Shared<InvalidOption>);
}

EdgeLengths lengths_of(const PolygonMesh& mesh) {
  EdgeLengths edges;
  for (const auto& [a, b] : mesh.edges().vertices) {
    const double length = (mesh.point(b) - mesh.point(a)).norm();
    edges.sum += length;
    edges.longest = std::max(edges.longest, length);
    ++edges.count;
  }
  return edges;
}

template <class Mesh>
void check_edges(const MeshPart<Mesh>& part, const EdgeLengths& expected) {
  const EdgeLengths edges = edge_lengths(part);
  EXPECT_EQ(edges.count, expected.count);
  EXPECT_NEAR(edges.sum, expected.sum, kTolerance * expected.sum);
  EXPECT_EQ(edges.longest, expected.longest);
}

TEST(EdgeLengths, count_every_edge_once) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    check_edges(own_part(mesh, scattered(mesh.n_faces(), n_processes())), lengths_of(mesh));
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    // Edges that no cell has are not counted.
    std::vector<bool> used(static_cast<std::size_t>(mesh.n_faces()));
    for (Index f = 0; f < mesh.n_faces(); ++f)
      used[f] = mesh.face_cells()[f].below >= 0 || mesh.face_cells()[f].above >= 0;
    if (std::find(used.begin(), used.end(), false) != used.end()) continue;
    check_edges(own_part(mesh, scattered(mesh.n_cells(), n_processes())),
                lengths_of(mesh.face_mesh()));
    check_edges(own_block(mesh), lengths_of(mesh.face_mesh()));
  }
}

}  // namespace
}  // namespace carat::test
