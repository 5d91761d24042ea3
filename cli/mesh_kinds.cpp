#include "cli/mesh_kinds.h"

#include <Eigen/Geometry>

namespace carat::cli {

std::string describe_sizes(const MeshSizes& sizes) {
  return count(sizes.vertices, "vertex") + ", " + count(sizes.edges, "edge") + ", " +
         count(sizes.faces, "face") + (sizes.cells < 0 ? "" : ", " + count(sizes.cells, "cell"));
}

Json sizes_to_json(const MeshSizes& sizes) {
  Json json = {{"vertices", sizes.vertices},
               {"edges", sizes.edges},
               {"faces", sizes.faces},
               {"corners", sizes.corners}};
  if (sizes.cells >= 0) json["cells"] = sizes.cells;
  return json;
}

PolygonMesh underived(const PolygonMesh& mesh) { return PolygonMesh(mesh.points(), mesh.faces()); }

PolyhedralMesh underived(const PolyhedralMesh& mesh) {
  return PolyhedralMesh(mesh.points(), mesh.face_mesh().faces(), mesh.cells());
}

namespace {

double n_entries(const Discretization& d) {
  return static_cast<double>(d.stiffness.nonZeros()) + static_cast<double>(d.mass.nonZeros()) +
         static_cast<double>(d.gradient.nonZeros());
}

double connectivity_bytes(const PolygonMesh& mesh) {
  return static_cast<double>(sizeof(Index)) * mesh.n_corners();
}

double connectivity_bytes(const PolyhedralMesh& mesh) {
  return connectivity_bytes(mesh.face_mesh()) +
         static_cast<double>(sizeof(Index) * mesh.cells().indices.size());
}

template <class Mesh>
double numeric_bytes(const Mesh& mesh, const Discretization& d) {
  constexpr double kPoint = 3 * sizeof(double), kEntry = sizeof(double) + sizeof(Index);
  double bytes = kPoint * mesh.n_vertices() + connectivity_bytes(mesh) + kEntry * n_entries(d);
  for (const auto& product : {d.stiffness_product, d.mass_product})
    if (product) bytes += static_cast<double>(product->bytes());
  return bytes;
}

template <class Mesh>
double pattern_bytes(const Mesh& mesh, const Discretization& d) {
  return connectivity_bytes(mesh) + static_cast<double>(sizeof(Index)) * n_entries(d);
}

}  // namespace

double symbolic_bytes(const PolygonMesh& mesh, const Discretization& discretization) {
  return pattern_bytes(mesh, discretization);
}

double symbolic_bytes(const PolyhedralMesh& mesh, const Discretization& discretization) {
  return pattern_bytes(mesh, discretization);
}

double assembly_bytes(const PolygonMesh& mesh, const Discretization& discretization) {
  return numeric_bytes(mesh, discretization);
}

double assembly_bytes(const PolyhedralMesh& mesh, const Discretization& discretization) {
  return numeric_bytes(mesh, discretization);
}

double setup_bytes(const SolverInfo& solver) {
  return static_cast<double>(sizeof(double) + sizeof(Index)) * static_cast<double>(solver.nonzeros);
}

BoundarySide boundary_side(const PolygonMesh& mesh, Index edge) {
  const std::array<Index, 2>& ends = mesh.edges().vertices[static_cast<std::size_t>(edge)];
  return {edge, ends, mesh.point(ends[0]) / 2 + mesh.point(ends[1]) / 2};
}

BoundarySide boundary_side(const PolyhedralMesh& mesh, Index face) {
  const std::span<const Index> vertices = mesh.face(face);
  const Vec3 origin = mesh.point(vertices[0]);
  Vec3 mean = Vec3::Zero();
  for (const Index v : vertices) mean += mesh.point(v) - origin;
  mean /= static_cast<double>(vertices.size());
  const auto for_triangles = [&](const auto& visit) {
    Vec3 a = mesh.point(vertices.back()) - origin;
    for (const Index v : vertices) {
      const Vec3 b = mesh.point(v) - origin;
      visit((a + b + mean) / 3, (a - mean).cross(b - mean));
      a = b;
    }
  };
  Vec3 normal = Vec3::Zero(), moment = Vec3::Zero();
  for_triangles([&](const Vec3&, const Vec3& area) { normal += area; });
  for_triangles([&](const Vec3& centre, const Vec3& area) { moment += normal.dot(area) * centre; });
  const double total = normal.squaredNorm();
  return {face, vertices, origin + (total > 0 ? Vec3(moment / total) : mean)};
}

std::vector<Index> boundary_sides(const PolygonMesh& mesh) {
  std::vector<Index> sides;
  for (Index e = 0; e < mesh.n_edges(); ++e)
    if (mesh.edges().corners.size(e) == 1) sides.push_back(e);
  return sides;
}

std::vector<Index> boundary_sides(const PolyhedralMesh& mesh) {
  std::vector<Index> sides;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[static_cast<std::size_t>(f)].boundary()) sides.push_back(f);
  return sides;
}

}  // namespace carat::cli
