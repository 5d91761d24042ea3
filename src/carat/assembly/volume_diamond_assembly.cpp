#include "carat/assembly/volume_diamond_assembly.h"

#include <algorithm>

#include "carat/assembly/row_assembly.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

using Corner = VolumeDiamondWorkspace::Corner;
using Face = VolumeDiamondWorkspace::Face;

/// Own values, the bracket and the mass of cells [begin, end).
void fill_cells(const VolumeIncidence& mesh, const CellRings& rings,
                const Array<double>& face_weights, const Array<double>& cell_weights, Index begin,
                Index end, VolumeDiamondWorkspace& out) {
  for (Index c = begin; c < end; ++c) {
    const Index first = mesh.cell_vertices.begin(c), n = mesh.cell_vertices.size(c);
    const double* const weights = cell_weights.data() + first;
    double* const own = out.own.data() + first;
    double* const coupling = out.coupling.data() + first + rings.ring_offsets[c];
    std::fill(own, own + n, 0.0);
    std::fill(coupling, coupling + n + rings.ring_size(c), 0.0);
    const Index* place = rings.places.data() + rings.place_offsets[c];
    double gamma = 0, mass = 0;
    for (const Index f : mesh.cells.row(c)) {
      const FaceCells cells = mesh.face_cells[f];
      const Face& face = out.faces[f];
      const bool is_above = cells.above == c;
      const double of_face = is_above ? face.above : face.below;
      for (Index corner = mesh.faces.begin(f); corner < mesh.faces.end(f); ++corner)
        own[*place++] += (is_above ? out.corners[corner].above : out.corners[corner].below) +
                         of_face * face_weights[corner];
      gamma += is_above ? face.gamma_above : face.gamma_below;
      mass += is_above ? face.mass_above : face.mass_below;
      const Index other = cells.other(c);
      if (other < 0) continue;
      for (Index k = mesh.cell_vertices.begin(other); k < mesh.cell_vertices.end(other); ++k)
        coupling[*place++] -= face.gamma_across * cell_weights[k];
    }
    for (Index k = 0; k < n; ++k) coupling[k] += own[k] + gamma * weights[k];
    out.cell_mass[c] = mass;
  }
}

void fill_rows(SparseMatrix& stiffness_matrix, SparseMatrix& mass_matrix, bool lumped_mass,
               const VolumeIncidence& mesh, const CellRings& rings, const Csr& vertex_corners,
               const Array<Index>& corner_faces, const Array<double>& face_weights,
               const Array<double>& cell_weights, Index begin, Index end,
               const VolumeDiamondWorkspace& values, VolumeDiamondWorkspace::Thread& scratch) {
  for (Index row = begin; row < end; ++row) {
    const RowWriter stiffness(stiffness_matrix, row, scratch.stiffness_position);
    const RowWriter mass(mass_matrix, row, scratch.mass_position);
    double diagonal = 0, diagonal_mass = 0;
    for (const Index cell_corner : mesh.vertex_cell_corners.row(row)) {
      const Index c = mesh.corner_cells[cell_corner];
      const Index first = mesh.cell_vertices.begin(c), n = mesh.cell_vertices.size(c);
      const Index* const vertices = mesh.cell_vertices.indices.data() + first;
      const Index* const ring = rings.ring.data() + rings.ring_offsets[c];
      const double* const coupling = values.coupling.data() + first + rings.ring_offsets[c];
      const double* const weights = cell_weights.data() + first;
      const double weight = cell_weights[cell_corner], own = values.own[cell_corner];
      for (Index k = 0; k < n; ++k)
        stiffness.add(vertices[k], weight * coupling[k] + own * weights[k]);
      const Index n_ring = rings.ring_size(c);
      for (Index k = 0; k < n_ring; ++k) stiffness.add(ring[k], weight * coupling[n + k]);
      const double mass_weight = weight * values.cell_mass[c];
      if (lumped_mass)
        diagonal_mass += mass_weight;  // the weights of a cell sum to one
      else
        for (Index k = 0; k < n; ++k) mass.add(vertices[k], mass_weight * weights[k]);
    }
    for (const Index corner : vertex_corners.row(row)) {
      const Index f = corner_faces[corner];
      const FaceCells cells = mesh.face_cells[f];
      if (cells.below < 0 && cells.above < 0) continue;
      const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
      const Index next = corner + 1 == last ? first : corner + 1;
      const Index previous = corner == first ? last - 1 : corner - 1;
      const Index* const vertices = mesh.faces.indices.data();
      const Corner& own = values.corners[corner];
      const Face& face = values.faces[f];
      const double weight = face_weights[corner];
      const double face_weight = face.spokes * weight - own.spoke;
      diagonal += own.diagonal;
      diagonal_mass += own.mass;
      stiffness.add(vertices[next], -own.side);
      stiffness.add(vertices[previous], -values.corners[previous].side);
      for (Index k = first; k < last; ++k)
        stiffness.add(vertices[k],
                      face_weight * face_weights[k] - weight * values.corners[k].spoke);
      const double mass_weight = weight * face.mass;
      if (lumped_mass)
        diagonal_mass += mass_weight;
      else
        for (Index k = first; k < last; ++k) mass.add(vertices[k], mass_weight * face_weights[k]);
    }
    const bool referenced = mesh.vertex_cell_corners.size(row) > 0;
    if (referenced) stiffness.add(row, diagonal);
    if (referenced || lumped_mass) mass.add(row, diagonal_mass);
  }
}

}  // namespace

void assemble_volume_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                              const VolumeIncidence& mesh, const CellRings& rings,
                              const Csr& vertex_corners, const Array<Index>& corner_faces,
                              const Array<double>& face_weights, const Array<double>& cell_weights,
                              int threads, VolumeDiamondWorkspace& workspace) {
  const Index n_vertices = mesh.n_vertices(), n_cells = mesh.cells.n_rows();
  workspace.own.resize(cell_weights.size());
  workspace.coupling.resize(cell_weights.size() + rings.ring.size());
  workspace.cell_mass.resize(static_cast<std::size_t>(n_cells));
  workspace.threads.resize(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n_cells, threads, [&](int, Index begin, Index end) {
    fill_cells(mesh, rings, face_weights, cell_weights, begin, end, workspace);
  });
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    VolumeDiamondWorkspace::Thread& scratch = workspace.threads[static_cast<std::size_t>(block)];
    scratch.stiffness_position.resize(static_cast<std::size_t>(n_vertices));
    scratch.mass_position.resize(static_cast<std::size_t>(n_vertices));
    fill_rows(stiffness, mass, lumped_mass, mesh, rings, vertex_corners, corner_faces, face_weights,
              cell_weights, begin, end, workspace, scratch);
  });
}

}  // namespace carat
