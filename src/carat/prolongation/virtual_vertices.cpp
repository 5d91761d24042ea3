#include "carat/prolongation/virtual_vertices.h"

#include <algorithm>
#include <array>
#include <utility>

#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/virtual_vertex_block.h"

namespace carat {
namespace {

/// Faces of one valence that wait until a block is full.
struct FaceBlock {
  std::array<Index, kBlockFaces> faces;
  int size = 0;
};

/// Computes the waiting faces. A block that is not full repeats its last face, so that every face
/// gets the same bits wherever it stands.
template <class OneFace>
void flush(FaceBlock& block, Index valence, const PolygonMesh& mesh, const Points& points,
           const VirtualVertexRule& rule, VirtualVertices& result, const OneFace& one_face) {
  if (block.size == 0) return;
  std::array<const Index*, kBlockFaces> vertices;
  std::array<double*, kBlockFaces> weights;
  std::array<VirtualTriangle*, kBlockFaces> triangles;
  for (int l = 0; l < kBlockFaces; ++l) {
    const Index corner = mesh.faces().begin(block.faces[std::min(l, block.size - 1)]);
    vertices[l] = mesh.faces().indices.data() + corner;
    weights[l] = result.weights.data() + corner;
    triangles[l] = result.triangles.data() + corner;
  }
  const unsigned unsound =
      virtual_vertex_block(valence, points.data(), vertices.data(),
                           rule.point == VirtualPoint::Centroid, weights.data(), triangles.data());
  for (int l = 0; l < block.size; ++l) {
    if ((unsound >> l & 1U) != 0)
      one_face(block.faces[l]);
    else
      result.status[block.faces[l]] = VirtualVertexStatus::Regular;
  }
  block.size = 0;
}

}  // namespace

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
  const bool blocks =
      rule.weights == AffineWeights::InPlane && rule.point != VirtualPoint::TraceMinimizer;
  parallel_blocks(mesh.n_faces(), threads, [&](int, Index begin, Index end) {
    VirtualVertexKernel kernel(rule);
    const auto one_face = [&](Index f) {
      const Index corner = mesh.faces().begin(f);
      result.status[f] = kernel.compute(points, mesh.face(f), result.weights.data() + corner,
                                        result.triangles.data() + corner);
    };
    std::array<FaceBlock, 3> waiting;  // by valence
    for (Index f = begin; f < end; ++f) {
      const Index valence = mesh.faces().size(f);
      if (!blocks || !has_block_kernel(valence)) {
        one_face(f);
        continue;
      }
      FaceBlock& block = waiting[static_cast<std::size_t>(valence - 4)];
      block.faces[block.size++] = f;
      if (block.size == kBlockFaces) flush(block, valence, mesh, points, rule, result, one_face);
    }
    for (Index valence = 4; valence <= 6; ++valence)
      flush(waiting[static_cast<std::size_t>(valence - 4)], valence, mesh, points, rule, result,
            one_face);
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
      case VirtualVertexStatus::Regular:
        break;
      case VirtualVertexStatus::Moved:
        moved.push_back(f);
        break;
      case VirtualVertexStatus::Flipped:
        flipped.push_back(f);
        break;
      case VirtualVertexStatus::Degenerate:
        degenerate.push_back(f);
        break;
    }
  }
  report_virtual_vertices(std::move(moved), std::move(flipped), std::move(degenerate), diagnostics);
}

void report_virtual_vertices(std::vector<Index> moved, std::vector<Index> flipped,
                             std::vector<Index> degenerate, Diagnostics& diagnostics) {
  diagnostics.add("moved_virtual_vertices",
                  "faces whose virtual vertex flipped a triangle and was moved to the centroid of "
                  "the face's kernel",
                  std::move(moved));
  diagnostics.add(
      "flipped_virtual_vertices",
      "faces whose virtual vertex flips a triangle and was left where it is (no kernel, "
      "or moving was switched off): semidefinite, but linear precision is not promised",
      std::move(flipped));
  diagnostics.add("degenerate_faces",
                  "faces without area; their virtual vertex is the mean of their vertices",
                  std::move(degenerate));
}

}  // namespace carat
