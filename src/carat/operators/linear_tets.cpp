#include "carat/operators/linear_tets.h"

#include <algorithm>
#include <utility>

#include "carat/base/parallel.h"

namespace carat {
namespace {

/// Position of a pair of a tetrahedron's vertices in LinearTet::pair.
constexpr unsigned char kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

}  // namespace

bool all_tetrahedra(const VolumeIncidence& mesh) {
  const Index n = mesh.cells.n_rows();
  Index c = 0;
  while (c < n && mesh.cells.size(c) == 4 && mesh.cell_vertices.size(c) == 4) ++c;
  return c == n;
}

Tetrahedron cell_tetrahedron(const Points& points, const VolumeIncidence& mesh, Index c,
                             double eps_rel) {
  const std::span<const Index> v = mesh.cell_vertices.row(c);
  const auto x = [&](std::size_t k) -> Vec3 { return points.row(v[k]).transpose(); };
  // The vertices are those of the first face, then the fourth.
  if (mesh.face_cells[mesh.cells.row(c)[0]].below == c)
    return tetrahedron(x(0), x(1), x(2), x(3), eps_rel);
  Tetrahedron turned = tetrahedron(x(1), x(0), x(2), x(3), eps_rel);
  std::swap(turned.normal[0], turned.normal[1]);
  return turned;
}

LinearTet linear_tet(const Tetrahedron& tetrahedron, const Eigen::Matrix3d& k) {
  LinearTet tet{};
  if (!(tetrahedron.determinant > 0)) return tet;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < a; ++b) tet.pair[kPair[a][b]] = -tetrahedron.coupling(a, b, k);
  tet.volume = tetrahedron.volume();
  return tet;
}

void compute_linear_tets(const Points& points, const VolumeIncidence& mesh, Index first, Index last,
                         LinearTet* tets) {
  const Index* vertices[kBlockTets];
  double sign[kBlockTets];
  LinearTet* out[kBlockTets];
  for (Index l = 0; l < kBlockTets; ++l) {
    // A block that is not full repeats its last cell.
    const Index c = std::min(first + l, last - 1);
    vertices[l] = mesh.cell_vertices.indices.data() + mesh.cell_vertices.begin(c);
    const Index first_face = mesh.cells.indices[mesh.cells.begin(c)];
    sign[l] = mesh.face_cells[first_face].below == c ? 1.0 : -1.0;
    out[l] = tets + c;
  }
  linear_tet_block(points.data(), vertices, sign, out);
}

void assemble_linear_tets(SparseMatrix& stiffness, SparseMatrix* mass, bool lumped,
                          const VolumeIncidence& mesh, const Array<LinearTet>& tets, int threads) {
  const Index* const offsets = stiffness.outerIndexPtr();
  const Index* const columns = stiffness.innerIndexPtr();
  double* const values = stiffness.valuePtr();
  double* const masses = mass != nullptr ? mass->valuePtr() : nullptr;
  const bool full = masses != nullptr && !lumped;
  parallel_blocks(mesh.n_vertices(), threads, [&](int, Index first, Index last) {
    Array<Index> position(static_cast<std::size_t>(mesh.n_vertices()));
    for (Index row = first; row < last; ++row) {
      const Index begin = offsets[row], end = offsets[row + 1];
      for (Index k = begin; k < end; ++k) position[columns[k]] = k;
      std::fill(values + begin, values + end, 0.0);
      if (full) std::fill(masses + begin, masses + end, 0.0);
      double diagonal = 0, volume = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = mesh.corner_cells[corner];
        const Index* const vertices = mesh.cell_vertices.indices.data() + 4 * std::ptrdiff_t{c};
        const auto own = static_cast<std::size_t>(corner) % 4;
        const LinearTet& tet = tets[c];
        volume += tet.volume;
        for (std::size_t step = 1; step < 4; ++step) {
          const std::size_t other = own ^ step;
          const double pair = tet.pair[kPair[own][other]];
          const Index at = position[vertices[other]];
          values[at] -= pair;
          diagonal += pair;
          if (full) masses[at] += tet.volume / 20;
        }
      }
      if (begin < end) values[position[row]] = diagonal;
      if (full && begin < end) masses[position[row]] = volume / 10;
      if (lumped && masses != nullptr) masses[row] = volume / 4;
    }
  });
}

}  // namespace carat
