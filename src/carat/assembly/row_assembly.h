#pragma once
// The numeric phase: every thread owns rows and adds their contributions in an order that depends
// on the connectivity alone, so that the values are the same bits for any number of threads.

#include <algorithm>

#include "carat/assembly/pattern.h"
#include "carat/base/parallel.h"
#include "carat/base/types.h"

namespace carat {

/// Adds to one row of a matrix with a known pattern.
class RowWriter {
 public:
  explicit RowWriter(Index n_cols) : position_(static_cast<std::size_t>(n_cols)) {}

  void open(SparseMatrix& matrix, Index row) {
    const Index begin = matrix.outerIndexPtr()[row], end = matrix.outerIndexPtr()[row + 1];
    values_ = matrix.valuePtr() + begin;
    const Index* const columns = matrix.innerIndexPtr() + begin;
    const Index size = end - begin;
    for (Index k = 0; k < size; ++k) position_[columns[k]] = k;
    std::fill(values_, values_ + size, 0.0);
  }
  void add(Index column, double value) { values_[position_[column]] += value; }

 private:
  Array<Index> position_;  // column -> place in the open row; set for the row's columns only
  double* values_ = nullptr;
};

/// Fills a matrix row by row: fill(row, writer, scratch) adds the contributions of a row to
/// `writer`. Each thread makes its own `scratch` by make_scratch().
template <class MakeScratch, class Fill>
void assemble_rows(SparseMatrix& matrix, int threads, const MakeScratch& make_scratch,
                   const Fill& fill) {
  parallel_blocks(static_cast<Index>(matrix.rows()), threads, [&](int, Index begin, Index end) {
    RowWriter writer(static_cast<Index>(matrix.cols()));
    auto scratch = make_scratch();
    for (Index row = begin; row < end; ++row) {
      writer.open(matrix, row);
      fill(row, writer, scratch);
    }
  });
}

/// Sum over faces of dense local matrices: entry (row, column) of every face is
/// local(f, a, b), a and b the positions of the two corners in the face. Into a diagonal pattern
/// (`lumped`) go the row sums.
template <class Local>
void assemble_face_blocks(SparseMatrix& matrix, const SurfaceIncidence& mesh, bool lumped,
                          int threads, const Local& local) {
  struct NoScratch {};
  assemble_rows(
      matrix, threads, [] { return NoScratch{}; },
      [&](Index row, RowWriter& writer, NoScratch&) {
        for (const Index corner : mesh.vertex_corners.row(row)) {
          const Index f = mesh.corner_faces[corner];
          const Index begin = mesh.faces.begin(f), size = mesh.faces.size(f);
          for (Index b = 0; b < size; ++b)
            writer.add(lumped ? row : mesh.faces.indices[begin + b], local(f, corner - begin, b));
        }
      });
}

}  // namespace carat
