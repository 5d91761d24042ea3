#include "carat/generators/zigzag.h"

#include <utility>

#include "carat/generators/lattice.h"

namespace carat {

ZigzagQuads zigzag_quads(const PolygonMesh& quads, const std::vector<bool>& colour) {
  const EdgeTopology& edges = quads.edges();
  const Csr& old = quads.faces();
  ZigzagQuads result;
  result.centres.resize(quads.n_faces(), 3);
  for (Index f = 0; f < quads.n_faces(); ++f) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : quads.face(f)) sum += quads.point(v);
    result.centres.row(f) = sum.transpose() / 4;
  }

  Array<Index> kink(static_cast<std::size_t>(edges.size()), -1);
  Index n_vertices = quads.n_vertices();
  Points points(static_cast<Eigen::Index>(n_vertices) + edges.size(), 3);
  points.topRows(n_vertices) = quads.points();
  const auto bends_inwards = [&](Index corner) {
    const Index f = corner / 4;
    return (corner % 2 == 1) == colour[f];
  };
  Csr faces;
  faces.indices.reserve(2 * old.indices.size());
  faces.offsets.reserve(old.offsets.size());
  for (Index f = 0; f < quads.n_faces(); ++f) {
    for (Index corner = old.begin(f); corner < old.end(f); ++corner) {
      faces.indices.push_back(old.indices[corner]);
      const Index e = edges.of_corner[corner];
      const auto sides = edges.corners.row(e);
      if (sides.size() != 2) continue;
      if (kink[e] < 0) {
        const bool second = !bends_inwards(sides[0]) && bends_inwards(sides[1]);
        const Vec3 middle =
            (quads.point(edges.vertices[e][0]) + quads.point(edges.vertices[e][1])) / 2;
        points.row(n_vertices) =
            (middle.transpose() + result.centres.row(sides[second ? 1 : 0] / 4)) / 2;
        kink[e] = n_vertices++;
      }
      faces.indices.push_back(kink[e]);
    }
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  points.conservativeResize(n_vertices, 3);
  result.mesh = number_by_first_use(points, std::move(faces));
  return result;
}

std::vector<bool> checkerboard(Index patches, Index n) {
  std::vector<bool> colour;
  colour.reserve(static_cast<std::size_t>(patches) * static_cast<std::size_t>(n) *
                 static_cast<std::size_t>(n));
  for (Index patch = 0; patch < patches; ++patch)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) colour.push_back((i + j) % 2 == 1);
  return colour;
}

}  // namespace carat
