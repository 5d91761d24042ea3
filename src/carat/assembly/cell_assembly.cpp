#include "carat/assembly/cell_assembly.h"

namespace carat {

void CellForm::reset(const VolumeIncidence& mesh, bool lumped) {
  face.assign(2 * static_cast<std::size_t>(mesh.faces.n_rows()), 0.0);
  vertex.assign(mesh.cell_vertices.indices.size(), 0.0);
  cell.assign(static_cast<std::size_t>(mesh.cells.n_rows()), 0.0);
  if (lumped) return;
  side.assign(2 * mesh.faces.indices.size(), 0.0);
  spoke.assign(2 * mesh.faces.indices.size(), 0.0);
  tip.assign(mesh.cell_vertices.indices.size(), 0.0);
}

namespace {

double both(const Array<double>& sides, Index k) { return sides[2 * k] + sides[2 * k + 1]; }

/// P^T A P 1 = P^T A 1, as weights sum to one.
void assemble_row_sums(SparseMatrix& matrix, const VolumeIncidence& mesh, const Csr& vertex_corners,
                       const Array<Index>& corner_faces, const Array<double>& face_weights,
                       const Array<double>& cell_weights, const CellForm& form, int threads) {
  parallel_blocks(mesh.n_vertices(), threads, [&](int, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      double sum = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row))
        sum += form.vertex[corner] + cell_weights[corner] * form.cell[mesh.corner_cells[corner]];
      for (const Index corner : vertex_corners.row(row))
        sum += face_weights[corner] * both(form.face, corner_faces[corner]);
      matrix.valuePtr()[row] = sum;
    }
  });
}

}  // namespace

void assemble_cell_form(SparseMatrix& matrix, bool lumped, const VolumeIncidence& mesh,
                        const Csr& vertex_corners, const Array<Index>& corner_faces,
                        const Array<double>& face_weights, const Array<double>& cell_weights,
                        const CellForm& form, int threads) {
  if (lumped) {
    assemble_row_sums(matrix, mesh, vertex_corners, corner_faces, face_weights, cell_weights, form,
                      threads);
    return;
  }
  const Index n_vertices = mesh.n_vertices();
  parallel_blocks(n_vertices, threads, [&](int, Index begin, Index end) {
    Array<Index> position(static_cast<std::size_t>(n_vertices));
    for (Index row = begin; row < end; ++row) {
      if (row + kFarRows < end)
        for (const Index corner : vertex_corners.row(row + kFarRows)) {
          prefetch(form.spoke.data() + 2 * corner);
          prefetch(form.side.data() + 2 * corner);
          prefetch(face_weights.data() + corner);
          prefetch(mesh.faces.indices.data() + corner);
          prefetch(corner_faces.data() + corner);
        }
      if (row + kNearRows < end)
        for (const Index corner : vertex_corners.row(row + kNearRows)) {
          const Index f = corner_faces[corner];
          prefetch(form.face.data() + 2 * f);
          prefetch(mesh.face_cells.data() + f);
          prefetch(mesh.faces.offsets.data() + f);
        }
      const RowWriter writer(matrix, row, position);
      if (mesh.vertex_cell_corners.size(row) == 0) continue;
      double diagonal = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = mesh.corner_cells[corner];
        const double weight = cell_weights[corner], tip = form.tip[corner];
        const double own = weight * form.cell[c] + tip;
        diagonal += form.vertex[corner];
        for (Index k = mesh.cell_vertices.begin(c); k < mesh.cell_vertices.end(c); ++k)
          writer.add(mesh.cell_vertices.indices[k], own * cell_weights[k] + weight * form.tip[k]);
      }
      for (const Index corner : vertex_corners.row(row)) {
        const Index f = corner_faces[corner];
        const FaceCells cells = mesh.face_cells[f];
        if (cells.below < 0 && cells.above < 0) continue;  // its vertices may share no cell
        const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
        const Index next = corner + 1 == last ? first : corner + 1;
        const Index previous = corner == first ? last - 1 : corner - 1;
        const double weight = face_weights[corner];
        const double own = weight * both(form.face, f) + both(form.spoke, corner);
        writer.add(mesh.faces.indices[next], both(form.side, corner));
        writer.add(mesh.faces.indices[previous], both(form.side, previous));
        for (Index k = first; k < last; ++k)
          writer.add(mesh.faces.indices[k], own * face_weights[k] + weight * both(form.spoke, k));
      }
      writer.add(row, diagonal);
    }
  });
}

}  // namespace carat
