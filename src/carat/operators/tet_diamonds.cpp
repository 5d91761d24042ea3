#include "carat/operators/tet_diamonds.h"

#include <algorithm>
#include <atomic>

#include "carat/base/parallel.h"

namespace carat {
namespace {

/// Position of a pair of a tetrahedron's vertices in TetDiamonds::pair.
constexpr unsigned char kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

/// Numbers of vertices cancel in sums and differences, whatever overflows.
std::uint32_t sum(std::span<const Index> vertices) {
  std::uint32_t total = 0;
  for (const Index v : vertices) total += static_cast<std::uint32_t>(v);
  return total;
}

void sort_four(Index* v) {
  const auto order = [&](int a, int b) {
    const Index low = std::min(v[a], v[b]), high = std::max(v[a], v[b]);
    v[a] = low;
    v[b] = high;
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);
}

/// Sums of one row at the places of its columns.
struct Sums {
  double stiffness, mass;
};

}  // namespace

TetTopology tet_topology(const VolumeIncidence& mesh, const std::vector<bool>& own_faces,
                         int threads) {
  const Index n = mesh.cells.n_rows();
  TetTopology tets;
  tets.vertices.resize(static_cast<std::size_t>(n));
  tets.measured_faces.resize(static_cast<std::size_t>(n));
  tets.signs.resize(static_cast<std::size_t>(n));
  tets.left_out.resize(own_faces.empty() ? 0 : static_cast<std::size_t>(n));
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      std::array<Index, 8>& vertices = tets.vertices[c];
      const std::span<const Index> own = mesh.cell_vertices.row(c);
      std::copy(own.begin(), own.end(), vertices.begin());
      sort_four(vertices.data());
      const std::uint32_t total = sum(own);
      std::size_t opposite = 0;
      unsigned left_out = 0;
      for (std::size_t k = 4; k-- > 0;) {  // the first face comes last: the sign is taken from it
        const Index f = mesh.cells.indices[mesh.cells.begin(c) + static_cast<Index>(k)];
        const std::uint32_t of_face = sum(mesh.faces.row(f));
        const auto v = static_cast<Index>(total - of_face);
        opposite = 0;
        while (opposite < 3 && vertices[opposite] != v) ++opposite;
        const FaceCells sides = mesh.face_cells[f];
        const Index other = sides.other(c);
        vertices[4 + opposite] =
            other < 0 ? -1 : static_cast<Index>(sum(mesh.cell_vertices.row(other)) - of_face);
        tets.measured_faces[c][opposite] = sides.below == c || sides.below < 0 ? f : -1;
        if (!own_faces.empty() && !own_faces[static_cast<std::size_t>(f)])
          left_out |= 1U << opposite;
      }
      if (!own_faces.empty()) tets.left_out[c] = static_cast<unsigned char>(left_out);
      const Index f = mesh.cells.indices[mesh.cells.begin(c)];
      const std::span<const Index> face = mesh.faces.row(f);
      const bool ascending = (face[0] < face[1]) == ((face[1] < face[2]) == (face[0] < face[2]));
      const bool above = mesh.face_cells[f].above == c;
      tets.signs[c] =
          static_cast<signed char>((ascending == above) == (opposite % 2 == 1) ? 1 : -1);
    }
  });
  return tets;
}

VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const TetTopology& tets,
                                       int threads) {
  return diamond_patterns(mesh, threads, [&](Index c, auto&& visit) {
    for (std::size_t k = 4; k < 8; ++k)
      if (tets.vertices[c][k] >= 0) visit(tets.vertices[c][k]);
  });
}

bool compute_tet_diamonds(const Points& points, const VolumeIncidence& mesh,
                          const TetTopology& tets, double eps_rel, const TetHalves* halves,
                          int threads, TetDiamondTerms& terms, Vector& measures) {
  std::atomic<bool> sound = true;
  terms.tets.resize(tets.vertices.size());
  terms.vertex_masses.resize(halves ? tets.vertices.size() : 0);
  parallel_blocks(mesh.cells.n_rows(), threads, [&](int, Index begin, Index end) {
    for (Index first = begin; first < end; first += kBlockTets) {
      TetDiamondInput input[kBlockTets];
      TetDiamonds* out[kBlockTets];
      double* vertex_masses[kBlockTets];
      double volumes[kBlockTets][4];
      for (Index l = 0; l < kBlockTets; ++l) {
        // A block that is not full repeats its last cell.
        const Index c = std::min(first + l, end - 1);
        input[l] = {tets.vertices[c].data(), static_cast<double>(tets.signs[c]),
                    tets.left_out.empty() ? 0U : tets.left_out[c]};
        out[l] = &terms.tets[c];
        if (halves) vertex_masses[l] = terms.vertex_masses[c].data();
      }
      if (!(halves ? tet_diamond_block(points.data(), input, eps_rel, *halves, out, vertex_masses,
                                       volumes)
                   : tet_diamond_block(points.data(), input, eps_rel, out, volumes)))
        sound = false;
      for (Index c = first; c < std::min(first + kBlockTets, end); ++c)
        for (std::size_t k = 0; k < 4; ++k)
          if (const Index f = tets.measured_faces[c][k]; f >= 0)
            measures.segment<3>(mesh.faces.begin(f)).setConstant(volumes[c - first][k]);
    }
  });
  return sound;
}

void assemble_tet_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                           const VolumeIncidence& mesh, const TetTopology& tets,
                           const TetDiamondTerms& terms, int threads) {
  const bool halves = !terms.vertex_masses.empty();
  const Index n_vertices = mesh.n_vertices();
  const Index* const offsets = stiffness.outerIndexPtr();
  const Index* const columns = stiffness.innerIndexPtr();
  const Index* const mass_offsets = mass.outerIndexPtr();
  const Index* const mass_columns = mass.innerIndexPtr();
  parallel_blocks(n_vertices, threads, [&](int, Index first, Index last) {
    Array<Index> place(static_cast<std::size_t>(n_vertices));
    std::vector<Sums> sums;
    for (Index row = first; row < last; ++row) {
      const Index begin = offsets[row], size = offsets[row + 1] - begin;
      if (size == 0) {
        if (lumped_mass) mass.valuePtr()[row] = 0;
        continue;
      }
      for (Index k = 0; k < size; ++k) place[columns[begin + k]] = k;
      sums.assign(static_cast<std::size_t>(size), Sums{0, 0});
      double diagonal = 0, diagonal_mass = 0, row_mass = 0;
      for (const Index corner : mesh.vertex_cell_corners.row(row)) {
        const Index c = corner / 4;
        const std::array<Index, 8>& vertices = tets.vertices[c];
        const TetDiamonds& term = terms.tets[c];
        const std::size_t own = (vertices[1] == row ? 1U : 0U) + (vertices[2] == row ? 2U : 0U) +
                                (vertices[3] == row ? 3U : 0U);
        // Of the faces at this vertex.
        const double around = (term.face_mass[0] + term.face_mass[1]) +
                              (term.face_mass[2] + term.face_mass[3]) - term.face_mass[own];
        // A vertex of a face has 6 times its pairs' mass by itself, and once more by the face
        // point.
        diagonal_mass +=
            term.cell_mass + (halves ? around + terms.vertex_masses[c][own] : 7 * around);
        for (std::size_t step = 1; step < 4; ++step) {
          const std::size_t other = own ^ step;
          const double pair = term.pair[kPair[own][other]];
          const double pair_mass = term.cell_mass + around - term.face_mass[other];
          Sums& at = sums[static_cast<std::size_t>(place[vertices[other]])];
          at.stiffness -= pair;
          at.mass += pair_mass;
          diagonal += pair;
          row_mass += pair_mass;
        }
        if (const Index across = vertices[4 + own]; across >= 0) {
          sums[static_cast<std::size_t>(place[across])].stiffness -= term.across[own];
          diagonal += term.across[own];
        }
      }
      sums[static_cast<std::size_t>(place[row])] = {diagonal, diagonal_mass};
      double* const values = stiffness.valuePtr() + begin;
      for (Index k = 0; k < size; ++k) values[k] = sums[static_cast<std::size_t>(k)].stiffness;
      if (lumped_mass) {
        mass.valuePtr()[row] = diagonal_mass + row_mass;
      } else {
        for (Index k = mass_offsets[row]; k < mass_offsets[row + 1]; ++k)
          mass.valuePtr()[k] = sums[static_cast<std::size_t>(place[mass_columns[k]])].mass;
      }
    }
  });
}

}  // namespace carat
