#pragma once
// Matrices on virtual tetrahedra (x_i, x_j, x_f, x_c), with the virtual vertices prolonged from the
// cells' own: P^T A P.
//
// A has entries along the edges of the virtual tetrahedra only. With a_f the weights of a face and
// p_c those of a cell, d the diagonal entries of their virtual vertices, s the entries between
// these and the vertices,
//   P^T A P = sum over faces of  d_f a_f a_f^T + s_f a_f^T + a_f s_f^T
//           + sum over cells of  d_c p_c p_c^T + s_c p_c^T + p_c s_c^T
//           + entries between the vertices themselves,
// where s_c also holds the entries between cell and face points, by the faces' weights.

#include "carat/assembly/row_assembly.h"
#include "carat/assembly/volume_pattern.h"
#include "carat/base/parallel.h"
#include "carat/base/types.h"

namespace carat {

/// The matrix of one virtual tetrahedron.
struct VirtualTetMatrix {
  double ii, jj, ff, cc, ij, fi, fj, ci, cj, cf;
};

/// The matrix A, kept between calls for its memory. A *side corner* is 2 * corner, + 1 on the side
/// of the cell above the face.
struct CellForm {
  Array<double> side;    ///< side corner -> between its vertex and the next
  Array<double> spoke;   ///< side corner -> s_f
  Array<double> face;    ///< 2 * face, + 1 above -> d_f
  Array<double> vertex;  ///< cell corner -> diagonal entry of its vertex
  Array<double> tip;     ///< cell corner -> s_c
  Array<double> cell;    ///< cell -> d_c

  /// All entries 0. \param lumped  only row sums of A are wanted: in vertex, face and cell
  void reset(const VolumeIncidence& mesh, bool lumped);
};

/// Adds the virtual tetrahedra of one cell, face by face. Cells can be filled in parallel.
class CellFormFiller {
 public:
  CellFormFiller(CellForm& form, const VolumeIncidence& mesh, const Array<double>& face_weights,
                 Index cell)
      : form_(form),
        mesh_(mesh),
        face_weights_(face_weights),
        cell_(cell),
        first_(mesh.cell_vertices.begin(cell)) {}

  /// \param corner, next              of the face, with vertices i and j
  /// \param place_i, place_j          positions of these in the cell
  void add(Index face, Index corner, Index next, Index place_i, Index place_j,
           const VirtualTetMatrix& a) {
    const Index above = mesh_.face_cells[face].above == cell_ ? 1 : 0;
    form_.side[2 * corner + above] += a.ij;
    form_.spoke[2 * corner + above] += a.fi;
    form_.spoke[2 * next + above] += a.fj;
    form_.face[2 * face + above] += a.ff;
    form_.vertex[first_ + place_i] += a.ii;
    form_.vertex[first_ + place_j] += a.jj;
    form_.tip[first_ + place_i] += a.ci;
    form_.tip[first_ + place_j] += a.cj;
    form_.cell[cell_] += a.cc;
    face_tip_ += a.cf;
  }
  /// Row sums instead of a matrix: `share` at each of its vertices.
  void add_lumped(Index face, Index place_i, Index place_j, double share) {
    form_.vertex[first_ + place_i] += share;
    form_.vertex[first_ + place_j] += share;
    form_.face[2 * face + (mesh_.face_cells[face].above == cell_ ? 1 : 0)] += share;
    form_.cell[cell_] += share;
  }
  /// After the last tetrahedron over a face. \param place  place(k) of its corner k in the cell
  template <class Place>
  void end_face(Index face, const Place& place) {
    const Index first = mesh_.faces.begin(face), size = mesh_.faces.size(face);
    for (Index k = 0; k < size; ++k)
      form_.tip[first_ + place(k)] += face_tip_ * face_weights_[first + k];
    face_tip_ = 0;
  }

 private:
  CellForm& form_;
  const VolumeIncidence& mesh_;
  const Array<double>& face_weights_;
  Index cell_, first_;
  double face_tip_ = 0;
};

/// Fills `matrix`, whose pattern is cell_pattern(mesh), with P^T A P; into a diagonal pattern
/// (`lumped`) go the row sums, from those of A.
/// \param vertex_corners  vertex -> corners of faces; \param corner_faces  corner -> face
/// \param face_weights  corner -> affine weight; \param cell_weights  cell corner -> affine weight
void assemble_cell_form(SparseMatrix& matrix, bool lumped, const VolumeIncidence& mesh,
                        const Csr& vertex_corners, const Array<Index>& corner_faces,
                        const Array<double>& face_weights, const Array<double>& cell_weights,
                        const CellForm& form, int threads);

/// Sum over cells of dense local matrices: entry (row, column) of every cell is local(c, a, b), a
/// and b positions in the cell. Into a diagonal pattern (`lumped`) go the row sums.
template <class Local>
void assemble_cell_blocks(SparseMatrix& matrix, bool lumped, const VolumeIncidence& mesh,
                          int threads, const Local& local) {
  parallel_blocks(mesh.n_vertices(), threads, [&](int, Index first, Index last) {
    Array<Index> position(static_cast<std::size_t>(mesh.n_vertices()));
    for (Index row = first; row < last; ++row) {
      const RowWriter writer(matrix, row, position);
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = mesh.corner_cells[corner];
        const Index begin = mesh.cell_vertices.begin(c), size = mesh.cell_vertices.size(c);
        for (Index b = 0; b < size; ++b)
          writer.add(lumped ? row : mesh.cell_vertices.indices[begin + b],
                     local(c, corner - begin, b));
      }
    }
  });
}

}  // namespace carat
