#include "carat/prolongation/virtual_vertices.h"

#include <utility>

#include "carat/base/error.h"
#include "carat/base/parallel.h"

namespace carat {

VirtualVertices virtual_vertices(const PolygonMesh& mesh, const Points& points,
                                 const VirtualVertexRule& rule, int threads) {
  VirtualVertices result;
  update_virtual_vertices(mesh, points, rule, threads, result);
  return result;
}

void update_virtual_vertices(const PolygonMesh& mesh, const Points& points,
                             const VirtualVertexRule& rule, int threads, VirtualVertices& result) {
  result.weights.resize(static_cast<std::size_t>(mesh.n_corners()));
  result.triangles.resize(static_cast<std::size_t>(mesh.n_corners()));
  result.status.resize(static_cast<std::size_t>(mesh.n_faces()));
  parallel_blocks(mesh.n_faces(), threads, [&](int, Index begin, Index end) {
    VirtualVertexKernel kernel(rule);
    for (Index f = begin; f < end; ++f) {
      const Index corner = mesh.faces().begin(f);
      result.status[f] = kernel.compute(points, mesh.face(f), result.weights.data() + corner,
                                        result.triangles.data() + corner);
    }
  });
}

Points face_points(const PolygonMesh& mesh, const Points& points, const Array<double>& weights) {
  Points result(mesh.n_faces(), 3);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Eigen::RowVector3d anchor = points.row(mesh.face(f)[0]);
    Eigen::RowVector3d offset = Eigen::RowVector3d::Zero();
    for (Index c = mesh.faces().begin(f); c < mesh.faces().end(f); ++c)
      offset += weights[c] * (points.row(mesh.faces().indices[c]) - anchor);
    result.row(f) = anchor + offset;
  }
  return result;
}

SparseMatrix prolongation_matrix(const PolygonMesh& mesh, const Array<double>& weights) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(static_cast<std::size_t>(mesh.n_vertices()) + weights.size());
  for (Index v = 0; v < mesh.n_vertices(); ++v) entries.emplace_back(v, v, 1.0);
  for (Index f = 0; f < mesh.n_faces(); ++f)
    for (Index c = mesh.faces().begin(f); c < mesh.faces().end(f); ++c)
      entries.emplace_back(mesh.n_vertices() + f, mesh.faces().indices[c], weights[c]);
  SparseMatrix p(mesh.n_vertices() + mesh.n_faces(), mesh.n_vertices());
  p.setFromTriplets(entries.begin(), entries.end());
  return p;
}

void report_virtual_vertices(const VirtualVertices& virtuals, Diagnostics& diagnostics) {
  std::vector<Index> moved, flipped, degenerate;
  for (Index f = 0; f < static_cast<Index>(virtuals.status.size()); ++f) {
    switch (virtuals.status[f]) {
      case VirtualVertexStatus::Regular: break;
      case VirtualVertexStatus::Moved: moved.push_back(f); break;
      case VirtualVertexStatus::Flipped: flipped.push_back(f); break;
      case VirtualVertexStatus::Degenerate: degenerate.push_back(f); break;
    }
  }
  diagnostics.add("moved_virtual_vertices",
                  "faces whose virtual vertex flipped a triangle and was moved to the centroid of "
                  "the face's kernel",
                  std::move(moved));
  diagnostics.add("flipped_virtual_vertices",
                  "faces whose virtual vertex flips a triangle and was left where it is (no kernel, "
                  "or moving was switched off): semidefinite, but linear precision is not promised",
                  std::move(flipped));
  diagnostics.add("degenerate_faces",
                  "faces without area; their virtual vertex is the mean of their vertices",
                  std::move(degenerate));
}

}  // namespace carat
