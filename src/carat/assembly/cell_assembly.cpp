#include "carat/assembly/cell_assembly.h"

namespace carat {

void CellForm::reset(const VolumeIncidence& mesh) {
  side.assign(2 * mesh.faces.indices.size(), 0.0);
  spoke.assign(2 * mesh.faces.indices.size(), 0.0);
  face.assign(2 * static_cast<std::size_t>(mesh.faces.n_rows()), 0.0);
  vertex.assign(mesh.cell_vertices.indices.size(), 0.0);
  tip.assign(mesh.cell_vertices.indices.size(), 0.0);
  cell.assign(static_cast<std::size_t>(mesh.cells.n_rows()), 0.0);
}

void assemble_cell_form(SparseMatrix& matrix, bool lumped, const VolumeIncidence& mesh,
                        const Csr& vertex_corners, const Array<Index>& corner_faces,
                        const Array<double>& face_weights, const Array<double>& cell_weights,
                        const CellForm& form, int threads) {
  const auto both = [](const Array<double>& sides, Index k) {
    return sides[2 * k] + sides[2 * k + 1];
  };
  const Index n_vertices = mesh.n_vertices();
  parallel_blocks(n_vertices, threads, [&](int, Index begin, Index end) {
    Array<Index> position(static_cast<std::size_t>(n_vertices));
    for (Index row = begin; row < end; ++row) {
      const RowWriter writer(matrix, row, position);
      const auto add = [&](Index column, double value) {
        writer.add(lumped ? row : column, value);
      };
      if (mesh.vertex_cell_corners.size(row) == 0) continue;
      double diagonal = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = mesh.corner_cells[corner];
        const double weight = cell_weights[corner], tip = form.tip[corner];
        const double own = weight * form.cell[c] + tip;
        diagonal += form.vertex[corner];
        for (Index k = mesh.cell_vertices.begin(c); k < mesh.cell_vertices.end(c); ++k)
          add(mesh.cell_vertices.indices[k], own * cell_weights[k] + weight * form.tip[k]);
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
        add(mesh.faces.indices[next], both(form.side, corner));
        add(mesh.faces.indices[previous], both(form.side, previous));
        for (Index k = first; k < last; ++k)
          add(mesh.faces.indices[k], own * face_weights[k] + weight * both(form.spoke, k));
      }
      add(row, diagonal);
    }
  });
}

}  // namespace carat
