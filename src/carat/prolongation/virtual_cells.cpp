#include "carat/prolongation/virtual_cells.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "carat/base/parallel.h"
#include "carat/kernels/virtual_cell.h"
#include "carat/kernels/virtual_cell_block.h"

namespace carat {
namespace {

bool is_tetrahedron(const PolyhedralMesh& mesh, Index c) {
  return mesh.cells().size(c) == 4 && mesh.cell_vertices().size(c) == 4;
}

/// Fills in a cell relative to its first vertex.
void load(const PolyhedralMesh& mesh, const Points& points, const Points& face_points,
          const Array<FaceMoment>& moments, Index c, CellGeometry& cell) {
  const std::span<const Index> vertices = mesh.cell_vertices().row(c);
  const std::span<const Index> faces = mesh.cell(c);
  const Vec3 anchor = points.row(vertices[0]).transpose();
  cell.vertices.resize(vertices.size());
  cell.face_points.resize(faces.size());
  cell.moments.resize(faces.size());
  for (std::size_t k = 0; k < vertices.size(); ++k)
    cell.vertices[k] = Vec3(points.row(vertices[k]).transpose()) - anchor;
  std::size_t n_planes = 0;
  for (const Index f : faces) n_planes += mesh.face(f).size();
  cell.virtual_planes.resize(n_planes);
  HalfSpace* plane = cell.virtual_planes.data();
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Index f = faces[k];
    const Vec3 origin = face_points.row(f).transpose();
    const Vec3 xf = origin - anchor;
    cell.face_points[k] = xf;
    cell.moments[k] = moments[f];
    const double sign = mesh.face_cells()[f].below == c ? 0.5 : -0.5;
    const std::span<const Index> face = mesh.face(f);
    Vec3 previous = Vec3(points.row(face.back()).transpose()) - origin;
    for (const Index v : face) {
      const Vec3 next = Vec3(points.row(v).transpose()) - origin;
      plane->normal = sign * previous.cross(next);
      plane->offset = plane->normal.dot(xf);
      ++plane;
      previous = next;
    }
  }
}

bool is_hexahedron(const PolyhedralMesh& mesh, Index c) {
  const std::span<const Index> faces = mesh.cell(c);
  return faces.size() == HexahedronBlock::kFaces &&
         mesh.cell_vertices().size(c) == HexahedronBlock::kVertices &&
         std::all_of(faces.begin(), faces.end(),
                     [&](Index f) { return mesh.face(f).size() == HexahedronBlock::kCorners; });
}

/// As above, into a lane of a block.
void load(const PolyhedralMesh& mesh, const Points& points, const Points& face_points,
          const Array<FaceMoment>& moments, Index c, HexahedronBlock& block, int lane) {
  const std::span<const Index> vertices = mesh.cell_vertices().row(c);
  const std::span<const Index> faces = mesh.cell(c);
  const auto row = [](const Points& of, Index v) {
    return of.data() + 3 * static_cast<std::ptrdiff_t>(v);
  };
  const double* const anchor = row(points, vertices[0]);
  const auto put = [&](double(&to)[3][kBlockCells], const double* x, const double* origin) {
    for (int k = 0; k < 3; ++k) to[k][lane] = x[k] - origin[k];
  };
  for (std::size_t i = 0; i < vertices.size(); ++i)
    put(block.position[i], row(points, vertices[i]), anchor);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Index f = faces[k];
    const double* const origin = row(face_points, f);
    put(block.position[HexahedronBlock::kVertices + k], origin, anchor);
    const FaceMoment& m = moments[f];
    const double values[] = {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz};
    for (int j = 0; j < 6; ++j) block.moment[k][j][lane] = values[j];
    block.sign[k][lane] = mesh.face_cells()[f].below == c ? 0.5 : -0.5;
    const std::span<const Index> face = mesh.face(f);
    for (std::size_t i = 0; i < face.size(); ++i)
      put(block.corner[k][i], row(points, face[i]), origin);
  }
}

}  // namespace

void update_virtual_cells(const PolyhedralMesh& mesh, const Points& points,
                          const VirtualVertexRule& rule, int threads, VirtualCells& result) {
  update_virtual_vertices(mesh.face_mesh(), points, rule, threads, result.faces);
  result.face_points.resize(mesh.n_faces(), 3);
  result.face_moments.resize(static_cast<std::size_t>(mesh.n_faces()));
  const Csr& cell_vertices = mesh.cell_vertices();
  result.cell_weights.resize(cell_vertices.indices.size());
  result.cell_points.resize(mesh.n_cells(), 3);
  result.cell_status.resize(static_cast<std::size_t>(mesh.n_cells()));
  Array<FaceMoment>& moments = result.face_moments;
  parallel_blocks(mesh.n_faces(), threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      // About one vertex, so that no accuracy is lost far from the origin.
      const std::span<const Index> face = mesh.face(f);
      const double* weight = result.faces.weights.data() + mesh.face_mesh().faces().begin(f);
      const Eigen::RowVector3d anchor = points.row(face[0]);
      Eigen::RowVector3d point = Eigen::RowVector3d::Zero();
      for (const Index v : face) point += *weight++ * (points.row(v) - anchor);
      point += anchor;
      result.face_points.row(f) = point;
      moments[f] = face_moment(points, face, point.transpose());
    }
  });
  parallel_blocks(mesh.n_cells(), threads, [&](int, Index begin, Index end) {
    VirtualCellKernel kernel(rule);
    CellGeometry cell;
    std::vector<double> weights;
    Array<Index> place(static_cast<std::size_t>(mesh.n_vertices()));
    /// \param weights  of the vertices and face points, of one after another `stride` apart
    const auto compose = [&](Index c, const double* weight, std::ptrdiff_t stride) {
      // P = P_C P_F     [BBA21 (30)]
      const std::span<const Index> vertices = cell_vertices.row(c);
      double* const composed = result.cell_weights.data() + cell_vertices.begin(c);
      for (std::size_t k = 0; k < vertices.size(); ++k, weight += stride) {
        place[vertices[k]] = static_cast<Index>(k);
        composed[k] = *weight;
      }
      for (const Index f : mesh.cell(c)) {
        const Index first = mesh.face_mesh().faces().begin(f);
        const std::span<const Index> face = mesh.face(f);
        for (std::size_t k = 0; k < face.size(); ++k)
          composed[place[face[k]]] += *weight * result.faces.weights[first + static_cast<Index>(k)];
        weight += stride;
      }
    };
    const auto set_point = [&](Index c) {
      const std::span<const Index> vertices = cell_vertices.row(c);
      const double* const composed = result.cell_weights.data() + cell_vertices.begin(c);
      const Eigen::RowVector3d anchor = points.row(vertices[0]);  // as for faces
      Eigen::RowVector3d offset = Eigen::RowVector3d::Zero();
      for (std::size_t k = 0; k < vertices.size(); ++k)
        offset += composed[k] * (points.row(vertices[k]) - anchor);
      result.cell_points.row(c) = anchor + offset;
    };
    const auto one_cell = [&](Index c) {
      load(mesh, points, result.face_points, moments, c, cell);
      weights.resize(cell.vertices.size() + cell.face_points.size());
      result.cell_status[c] = kernel.compute(cell, weights.data());
      compose(c, weights.data(), 1);
      set_point(c);
    };
    HexahedronBlock block{};
    std::array<Index, kBlockCells> waiting;
    int n_waiting = 0;
    // A block that is not full computes with what is left of the one before.
    const auto flush = [&] {
      const unsigned unsound = virtual_cell_block(block, rule.point == VirtualPoint::Centroid);
      for (int l = 0; l < n_waiting; ++l) {
        const Index c = waiting[static_cast<std::size_t>(l)];
        if ((unsound >> l & 1U) != 0) {
          one_cell(c);
          continue;
        }
        result.cell_status[c] = VirtualVertexStatus::Regular;
        compose(c, &block.weight[0][l], kBlockCells);
        set_point(c);
      }
      n_waiting = 0;
    };
    for (Index c = begin; c < end; ++c) {
      if (is_tetrahedron(mesh, c)) {
        const std::span<const Index> vertices = cell_vertices.row(c);
        std::fill_n(result.cell_weights.data() + cell_vertices.begin(c), 4, 0.25);
        const auto x = [&](std::size_t k) { return Vec3(points.row(vertices[k]).transpose()); };
        result.cell_status[c] = is_flat_tetrahedron(x(0), x(1), x(2), x(3))
                                    ? VirtualVertexStatus::Degenerate
                                    : VirtualVertexStatus::Regular;
        set_point(c);
      } else if (is_hexahedron(mesh, c)) {
        load(mesh, points, result.face_points, moments, c, block, n_waiting);
        waiting[static_cast<std::size_t>(n_waiting++)] = c;
        if (n_waiting == kBlockCells) flush();
      } else {
        one_cell(c);
      }
    }
    if (n_waiting > 0) flush();
  });
}

SparseMatrix prolongation_matrix(const PolyhedralMesh& mesh, const VirtualCells& virtuals) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  const Index n = mesh.n_vertices(), nf = mesh.n_faces();
  const Csr& faces = mesh.face_mesh().faces();
  for (Index v = 0; v < n; ++v) entries.emplace_back(v, v, 1.0);
  for (Index f = 0; f < nf; ++f)
    for (Index k = faces.begin(f); k < faces.end(f); ++k)
      entries.emplace_back(n + f, faces.indices[k], virtuals.faces.weights[k]);
  const Csr& cells = mesh.cell_vertices();
  for (Index c = 0; c < mesh.n_cells(); ++c)
    for (Index k = cells.begin(c); k < cells.end(c); ++k)
      entries.emplace_back(n + nf + c, cells.indices[k], virtuals.cell_weights[k]);
  SparseMatrix p(n + nf + mesh.n_cells(), n);
  p.setFromTriplets(entries.begin(), entries.end());
  return p;
}

void report_virtual_cells(const VirtualCells& virtuals, Diagnostics& diagnostics) {
  report_virtual_vertices(virtuals.faces, diagnostics);
  const auto list = [&](VirtualVertexStatus status) {
    std::vector<Index> cells;
    for (Index c = 0; c < static_cast<Index>(virtuals.cell_status.size()); ++c)
      if (virtuals.cell_status[c] == status) cells.push_back(c);
    return cells;
  };
  diagnostics.add("moved_cell_points",
                  "cells whose virtual vertex flipped a virtual tetrahedron and was moved to the "
                  "centre of the cell's kernel",
                  list(VirtualVertexStatus::Moved));
  diagnostics.add("flipped_cell_points",
                  "cells whose virtual vertex flips a virtual tetrahedron and was left where it is "
                  "(no kernel, or moving was switched off)",
                  list(VirtualVertexStatus::Flipped));
  diagnostics.add("degenerate_cells",
                  "cells without volume; their virtual vertex is the mean of their vertices",
                  list(VirtualVertexStatus::Degenerate));
}

}  // namespace carat
