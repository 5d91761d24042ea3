#include "carat/assembly/tet_diamond_assembly.h"

#include <algorithm>

#include "carat/assembly/row_assembly.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

/// Position of a pair of a tetrahedron's vertices in TetTerm::pair.
constexpr unsigned char kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

}  // namespace

void TetTerm::add_face(std::size_t k, const std::array<unsigned char, 4>& place, bool boundary,
                       double ab, double ac, double bc, const std::array<double, 3>& alpha,
                       double gamma, double volume) {
  // Both cells of a face add half of what lies within it. w = (u_own - u_across) / 4.
  const double share = boundary ? 1.0 : 0.5;
  double within[3] = {share * ab, share * ac, share * bc};
  double to_own = 0;
  if (boundary) {
    // u_f, the mean of the face's vertices, stands for u_across.
    within[0] += (alpha[0] + alpha[1]) / 12 - gamma / 144;
    within[1] += (alpha[0] + alpha[2]) / 12 - gamma / 144;
    within[2] += (alpha[1] + alpha[2]) / 12 - gamma / 144;
    to_own = gamma / 48;
  }
  pair[kPair[place[0]][place[1]]] += within[0];
  pair[kPair[place[0]][place[2]]] += within[1];
  pair[kPair[place[1]][place[2]]] += within[2];
  for (std::size_t j = 0; j < 3; ++j) pair[kPair[place[j]][place[3]]] += to_own - alpha[j] / 4;
  across[k] = boundary ? 0.0 : gamma / 16;
  // Each minimal diamond: 1/6 to a vertex, 1/4 to a tip; 1/4 throughout at the boundary. The face
  // point's part has weights 1/9 over the pairs.
  face_mass[k] = volume * (boundary ? 1.0 / 12 : 1.0 / 36);
  cell_mass += 3 * volume / 64;
}

TetTopology tet_topology(const VolumeIncidence& mesh, int threads) {
  const Index n = mesh.cells.n_rows();
  TetTopology tets;
  tets.across.resize(static_cast<std::size_t>(n));
  tets.places.resize(static_cast<std::size_t>(n));
  const auto place_of = [&](Index c, Index v) {
    const std::span<const Index> vertices = mesh.cell_vertices.row(c);
    std::size_t place = 0;
    while (vertices[place] != v) ++place;
    return place;
  };
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (std::size_t k = 0; k < 4; ++k) {
        const Index f = mesh.cells.indices[mesh.cells.begin(c) + static_cast<Index>(k)];
        std::size_t opposite = 6;
        for (std::size_t j = 0; j < 3; ++j) {
          const std::size_t place = place_of(c, mesh.faces.row(f)[j]);
          tets.places[c][k][j] = static_cast<unsigned char>(place);
          opposite -= place;
        }
        tets.places[c][k][3] = static_cast<unsigned char>(opposite);
        const Index other = mesh.face_cells[f].other(c);
        tets.across[c][k] = -1;
        if (other < 0) continue;
        std::size_t across = 6;
        for (std::size_t j = 0; j < 3; ++j) across -= place_of(other, mesh.faces.row(f)[j]);
        tets.across[c][k] = mesh.cell_vertices.row(other)[across];
      }
  });
  return tets;
}

VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const TetTopology& tets,
                                       int threads) {
  return diamond_patterns(mesh, threads, [&](Index c, auto&& visit) {
    for (const Index v : tets.across[c])
      if (v >= 0) visit(v);
  });
}

void assemble_tet_diamonds(SparseMatrix& stiffness_matrix, SparseMatrix& mass_matrix,
                           bool lumped_mass, const VolumeIncidence& mesh, const TetTopology& tets,
                           int threads, TetDiamondWorkspace& workspace) {
  const Index n_vertices = mesh.n_vertices();
  workspace.threads.resize(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    TetDiamondWorkspace::Thread& scratch = workspace.threads[static_cast<std::size_t>(block)];
    scratch.stiffness_position.resize(static_cast<std::size_t>(n_vertices));
    scratch.mass_position.resize(static_cast<std::size_t>(n_vertices));
    for (Index row = begin; row < end; ++row) {
      const RowWriter stiffness(stiffness_matrix, row, scratch.stiffness_position);
      const RowWriter mass(mass_matrix, row, scratch.mass_position);
      double diagonal = 0, diagonal_mass = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = mesh.corner_cells[corner];
        const Index first = mesh.cell_vertices.begin(c);
        const Index* const vertices = mesh.cell_vertices.indices.data() + first;
        const auto own = static_cast<std::size_t>(corner - first);
        const TetTerm& term = workspace.terms[c];
        std::size_t opposite = 0;
        while (tets.places[c][opposite][3] != own) ++opposite;
        // Of the faces at this vertex.
        const double around = (term.face_mass[0] + term.face_mass[1]) +
                              (term.face_mass[2] + term.face_mass[3]) - term.face_mass[opposite];
        // A vertex of a face has 6 times its pairs' mass by itself, and once more by the face
        // point.
        diagonal_mass += term.cell_mass + 7 * around;
        for (std::size_t k = 0; k < 4; ++k) {
          if (k == opposite) continue;
          const std::size_t j = tets.places[c][k][3];  // the other vertex, opposite face k
          const double pair = term.pair[kPair[own][j]];
          stiffness.add(vertices[j], -pair);
          diagonal += pair;
          const double pair_mass = term.cell_mass + around - term.face_mass[k];
          if (lumped_mass)
            diagonal_mass += pair_mass;
          else
            mass.add(vertices[j], pair_mass);
        }
        if (tets.across[c][opposite] >= 0) {
          stiffness.add(tets.across[c][opposite], -term.across[opposite]);
          diagonal += term.across[opposite];
        }
      }
      const bool referenced = mesh.vertex_cell_corners.size(row) > 0;
      if (referenced) stiffness.add(row, diagonal);
      if (referenced || lumped_mass) mass.add(row, diagonal_mass);
    }
  });
}

}  // namespace carat
