#pragma once
// The numeric phase: every thread owns rows and adds their contributions in an order that depends
// on the connectivity alone, so that the values are the same bits for any number of threads.

#include <algorithm>

#include "carat/assembly/pattern.h"
#include "carat/base/parallel.h"
#include "carat/base/types.h"

namespace carat {

/// Rows ahead of the one at hand whose faces are asked for: by corner, and by the face that is then
/// known. Faces are not numbered like vertices, so what they hold is seldom in the cache.
inline constexpr Index kFarRows = 4, kNearRows = 2;

/// Starts to load what lies there, where the compiler can say so. No result depends on it.
inline void prefetch([[maybe_unused]] const void* at) {
#ifdef __GNUC__
  __builtin_prefetch(at);
#endif
}

/// Adds to one row of a matrix with a known pattern.
class RowWriter {
 public:
  /// Zeroes the row. \param position  one place a column; only those of the row are set and read
  RowWriter(SparseMatrix& matrix, Index row, Array<Index>& position) : position_(position.data()) {
    const Index begin = matrix.outerIndexPtr()[row], end = matrix.outerIndexPtr()[row + 1];
    values_ = matrix.valuePtr();
    const Index* const columns = matrix.innerIndexPtr();
    for (Index k = begin; k < end; ++k) position_[columns[k]] = k;
    std::fill(values_ + begin, values_ + end, 0.0);
  }
  void add(Index column, double value) const { values_[position_[column]] += value; }

 private:
  Index* position_;
  double* values_;
};

/// Sum over faces of dense local matrices: entry (row, column) of every face is
/// local(f, a, b), a and b the positions of the two corners in the face. Into a diagonal pattern
/// (`lumped`) go the row sums.
template <class Local>
void assemble_face_blocks(SparseMatrix& matrix, const SurfaceIncidence& mesh, bool lumped,
                          int threads, const Local& local) {
  parallel_blocks(static_cast<Index>(matrix.rows()), threads, [&](int, Index first, Index last) {
    Array<Index> position(static_cast<std::size_t>(matrix.cols()));
    for (Index row = first; row < last; ++row) {
      const RowWriter writer(matrix, row, position);
      for (const Index corner : mesh.vertex_corners.row(row)) {
        const Index f = mesh.corner_faces[corner];
        const Index begin = mesh.faces.begin(f), size = mesh.faces.size(f);
        for (Index b = 0; b < size; ++b)
          writer.add(lumped ? row : mesh.faces.indices[begin + b], local(f, corner - begin, b));
      }
    }
  });
}

}  // namespace carat
