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
        own[*place++] += (is_above ? out.tips[corner].above : out.tips[corner].below) +
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

/// Sums of one row at the places of its columns, in the cache while cells and faces are added.
struct RowSums {
  std::vector<double> stiffness, mass;
};

void fill_rows(SparseMatrix& stiffness_matrix, SparseMatrix& mass_matrix, bool lumped_mass,
               const VolumeIncidence& mesh, const CellRings& rings, const Csr& vertex_corners,
               const Array<Index>& corner_faces, const Array<double>& face_weights,
               const Array<double>& cell_weights, Index begin, Index end,
               const VolumeDiamondWorkspace& values, Array<Index>& places) {
  RowSums sums;
  Index* const place = places.data();
  const Index* const cell_vertices = mesh.cell_vertices.indices.data();
  const Index* const face_vertices = mesh.faces.indices.data();
  const Corner* const corners = values.corners.data();
  const double* const of_face = face_weights.data();
  for (Index row = begin; row < end; ++row) {
    const Index row_begin = stiffness_matrix.outerIndexPtr()[row];
    const Index size = stiffness_matrix.outerIndexPtr()[row + 1] - row_begin;
    const Index* const columns = stiffness_matrix.innerIndexPtr() + row_begin;
    for (Index k = 0; k < size; ++k) place[columns[k]] = k;
    sums.stiffness.assign(static_cast<std::size_t>(size), 0.0);
    sums.mass.assign(static_cast<std::size_t>(size), 0.0);
    double* const stiffness = sums.stiffness.data();
    double* const mass = sums.mass.data();
    double diagonal = 0, diagonal_mass = 0;
    if (row + kFarRows < end)
      for (const Index corner : vertex_corners.row(row + kFarRows)) {
        prefetch(corners + corner);
        prefetch(corners + std::max(corner - 2, 0));
        prefetch(of_face + corner);
        prefetch(face_vertices + corner);
        prefetch(corner_faces.data() + corner);
      }
    if (row + kNearRows < end)
      for (const Index corner : vertex_corners.row(row + kNearRows)) {
        const Index f = corner_faces[corner];
        prefetch(values.faces.data() + f);
        prefetch(mesh.face_cells.data() + f);
        prefetch(mesh.faces.offsets.data() + f);
      }
    for (const Index cell_corner : mesh.vertex_cell_corners.row(row)) {
      const Index c = mesh.corner_cells[cell_corner];
      const Index first = mesh.cell_vertices.begin(c), n = mesh.cell_vertices.size(c);
      const Index* const vertices = cell_vertices + first;
      const Index* const ring = rings.ring.data() + rings.ring_offsets[c];
      const double* const coupling = values.coupling.data() + first + rings.ring_offsets[c];
      const double* const weights = cell_weights.data() + first;
      const double weight = cell_weights[cell_corner], own = values.own[cell_corner];
      const double mass_weight = weight * values.cell_mass[c];
      if (lumped_mass) {
        diagonal_mass += mass_weight;  // the weights of a cell sum to one
        for (Index k = 0; k < n; ++k)
          stiffness[place[vertices[k]]] += weight * coupling[k] + own * weights[k];
      } else {
        for (Index k = 0; k < n; ++k) {
          const Index at = place[vertices[k]];
          stiffness[at] += weight * coupling[k] + own * weights[k];
          mass[at] += mass_weight * weights[k];
        }
      }
      const double* const across = coupling + n;
      const Index n_ring = rings.ring_size(c);
      for (Index k = 0; k < n_ring; ++k) stiffness[place[ring[k]]] += weight * across[k];
    }
    for (const Index corner : vertex_corners.row(row)) {
      const Index f = corner_faces[corner];
      const FaceCells cells = mesh.face_cells[f];
      if (cells.below < 0 && cells.above < 0) continue;
      const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
      const Index next = corner + 1 == last ? first : corner + 1;
      const Index previous = corner == first ? last - 1 : corner - 1;
      const Corner& own = corners[corner];
      const Face& face = values.faces[f];
      const double weight = of_face[corner];
      const double face_weight = face.spokes * weight - own.spoke;
      const double mass_weight = weight * face.mass;
      diagonal += own.diagonal;
      diagonal_mass += own.mass;
      if (lumped_mass) diagonal_mass += mass_weight;
      stiffness[place[face_vertices[next]]] -= own.side;
      stiffness[place[face_vertices[previous]]] -= corners[previous].side;
      for (Index k = first; k < last; ++k) {
        const Index at = place[face_vertices[k]];
        stiffness[at] += face_weight * of_face[k] - weight * corners[k].spoke;
        mass[at] += mass_weight * of_face[k];
      }
    }
    if (size > 0) {
      stiffness[place[row]] += diagonal;
      mass[place[row]] += diagonal_mass;
      std::copy(stiffness, stiffness + size, stiffness_matrix.valuePtr() + row_begin);
    }
    if (lumped_mass) {
      mass_matrix.valuePtr()[row] = diagonal_mass;
    } else {
      for (Index k = mass_matrix.outerIndexPtr()[row]; k < mass_matrix.outerIndexPtr()[row + 1];
           ++k)
        mass_matrix.valuePtr()[k] = mass[place[mass_matrix.innerIndexPtr()[k]]];
    }
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
  workspace.places.resize(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n_cells, threads, [&](int, Index begin, Index end) {
    fill_cells(mesh, rings, face_weights, cell_weights, begin, end, workspace);
  });
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    Array<Index>& places = workspace.places[static_cast<std::size_t>(block)];
    places.resize(static_cast<std::size_t>(n_vertices));
    fill_rows(stiffness, mass, lumped_mass, mesh, rings, vertex_corners, corner_faces, face_weights,
              cell_weights, begin, end, workspace, places);
  });
}

}  // namespace carat
