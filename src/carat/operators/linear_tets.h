#pragma once
// Linear elements on tetrahedra: their values, and the matrices from them. The polygon Laplacian of
// virtual tetrahedra is the same there: linear functions on a tetrahedron are linear on its parts.

#include <algorithm>

#include "carat/assembly/volume_pattern.h"
#include "carat/base/parallel.h"
#include "carat/base/types.h"
#include "carat/kernels/tetrahedron.h"
#include "carat/kernels/tetrahedron_block.h"

namespace carat {

/// Whether all cells are tetrahedra.
bool all_tetrahedra(const VolumeIncidence& mesh);

/// Whether V > limit * (longest edge)^3.
inline bool is_thicker(const LinearTet& tet, double limit) {
  const double l2 = tet.longest2;
  return tet.volume > 0 && tet.volume * tet.volume > limit * limit * (l2 * l2 * l2);
}

/// The tetrahedron of a cell, its vertices in the order of cell_vertices.
Tetrahedron cell_tetrahedron(const Points& points, const VolumeIncidence& mesh, Index c,
                             double eps_rel);

/// \param k  tensor between the gradients
/// \return all 0 for a degenerate tetrahedron
LinearTet linear_tet(const Tetrahedron& tetrahedron, const Eigen::Matrix3d& k);

/// Values of cells [first, last), at most kBlockTets, into tets[first] and on.
void compute_linear_tets(const Points& points, const VolumeIncidence& mesh, Index first, Index last,
                         LinearTet* tets);

/// Values of all cells, which are tetrahedra, with K = 1 and whatever their volume. Then
/// finish(c, tet) may change those of cell c.
template <class Finish>
void compute_linear_tets(const Points& points, const VolumeIncidence& mesh, int threads,
                         Array<LinearTet>& tets, const Finish& finish) {
  tets.resize(static_cast<std::size_t>(mesh.cells.n_rows()));
  parallel_blocks(mesh.cells.n_rows(), threads, [&](int, Index begin, Index end) {
    for (Index first = begin; first < end; first += kBlockTets) {
      const Index last = std::min(first + kBlockTets, end);
      compute_linear_tets(points, mesh, first, last, tets.data());
      for (Index c = first; c < last; ++c) finish(c, tets[c]);
    }
  });
}

/// Fills `stiffness`, whose pattern is cell_pattern(mesh), and `mass`, of the same pattern or
/// diagonal (`lumped`: then with the row sums); nullptr: no mass.
void assemble_linear_tets(SparseMatrix& stiffness, SparseMatrix* mass, bool lumped,
                          const VolumeIncidence& mesh, const Array<LinearTet>& tets, int threads);

}  // namespace carat
