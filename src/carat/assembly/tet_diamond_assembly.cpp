#include "carat/assembly/tet_diamond_assembly.h"

#include <algorithm>

#include "carat/assembly/pattern.h"
#include "carat/assembly/row_assembly.h"
#include "carat/assembly/row_pattern.h"
#include "carat/kernels/diamond_3d.h"

namespace carat {
namespace {

/// Position of a pair of a tetrahedron's vertices in TetTerm::pair.
constexpr unsigned char kPair[4][4] = {{9, 0, 1, 2}, {0, 9, 3, 4}, {1, 3, 9, 5}, {2, 4, 5, 9}};

Vec3 position(const Points& points, Index v) {
  const double* const x = points.data() + 3 * static_cast<std::ptrdiff_t>(v);
  return {x[0], x[1], x[2]};
}

/// The diamonds of one face as seen from cell c: adds to its term, and returns the volume of one of
/// the three minimal diamonds.
double add_face(const VolumeIncidence& mesh, const TetTopology& tets, const Points& points,
                double eps_rel, Index c, std::size_t k, TetTerm& term) {
  const Index f = mesh.cells.indices[mesh.cells.begin(c) + static_cast<Index>(k)];
  const FaceCells cells = mesh.face_cells[f];
  const auto& place = tets.places[c][k];
  const Index across = tets.across[c][k];
  const Index* const face = mesh.faces.indices.data() + mesh.faces.begin(f);
  // The same operations from either cell, so that both get the same bits.
  const Vec3 xa = position(points, face[0]);
  const Vec3 ab = position(points, face[1]) - xa, ac = position(points, face[2]) - xa;
  const Vec3 third = (ab + ac) / 3;  // the face point
  const Vec3 own = position(points, mesh.cell_vertices.row(c)[place[3]]) - xa;
  const Vec3 other = across < 0 ? third : Vec3(position(points, across) - xa);
  const bool above = cells.above == c;
  const Vec3 tip = 0.25 * (above ? own - other : other - own);  // x_r - x_l
  // The minimal diamond of the first side, and its products for the whole face: the base triangle
  // is three times as large.
  const Diamond3d minimal = diamond_3d(Vec3::Zero(), ab, third, Vec3::Zero(), tip, eps_rel);
  const double size2 = std::max({ac.squaredNorm(), (ac - ab).squaredNorm(), tip.squaredNorm()});
  const double limit = 6 * eps_rel, det = minimal.determinant;
  if (!(det > 0 && det * det > limit * limit * (size2 * size2 * size2))) {
    term.across[k] = term.face_mass[k] = 0;
    return 0;
  }
  const Vec3 s = ac.cross(tip), t = tip.cross(ab), w = ab.cross(ac);
  const double scale = 1 / (18 * det);
  const double ss = scale * s.dot(s), tt = scale * t.dot(t), st = scale * s.dot(t);
  const double sign = above ? scale : -scale;  // w as seen from this cell
  const double alpha[3] = {-sign * (s + t).dot(w), sign * s.dot(w), sign * t.dot(w)};
  const double gamma = scale * w.dot(w);
  const double share = across < 0 ? 1.0 : 0.5;
  double ab_part = share * (ss + st), ac_part = share * (tt + st), bc_part = -share * st;
  double to_own = 0;
  if (across < 0) {
    // u_own - u_f instead of u_own - u_across, u_f the mean of the face's vertices.
    ab_part += (alpha[0] + alpha[1]) / 12 - gamma / 144;
    ac_part += (alpha[0] + alpha[2]) / 12 - gamma / 144;
    bc_part += (alpha[1] + alpha[2]) / 12 - gamma / 144;
    to_own = gamma / 48;
  }
  term.pair[kPair[place[0]][place[1]]] += ab_part;
  term.pair[kPair[place[0]][place[2]]] += ac_part;
  term.pair[kPair[place[1]][place[2]]] += bc_part;
  for (std::size_t j = 0; j < 3; ++j) term.pair[kPair[place[j]][place[3]]] += to_own - alpha[j] / 4;
  term.across[k] = across < 0 ? 0.0 : gamma / 16;
  // Each minimal diamond: 1/6 to a vertex, 1/4 to a tip; 1/4 throughout at the boundary. The face
  // point's part has weights 1/9 over the pairs.
  const double volume = minimal.volume();
  term.face_mass[k] = volume * (across < 0 ? 1.0 / 12 : 1.0 / 36);
  term.cell_mass += 3 * volume / 64;
  return volume;
}

}  // namespace

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
                           bool lumped_mass, Vector& measure, const VolumeIncidence& mesh,
                           const TetTopology& tets, const Points& points, double eps_rel,
                           int threads, TetDiamondWorkspace& workspace) {
  const Index n_cells = mesh.cells.n_rows(), n_vertices = mesh.n_vertices();
  workspace.terms.resize(static_cast<std::size_t>(n_cells));
  workspace.threads.resize(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(mesh.faces.n_rows(), threads, [&](int, Index begin, Index end) {
    // Faces without cells; the others are overwritten.
    for (Index f = begin; f < end; ++f)
      measure.segment(mesh.faces.begin(f), mesh.faces.size(f)).setZero();
  });
  parallel_blocks(n_cells, threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      TetTerm term{};
      for (std::size_t k = 0; k < 4; ++k) {
        const double volume = add_face(mesh, tets, points, eps_rel, c, k, term);
        const Index f = mesh.cells.indices[mesh.cells.begin(c) + static_cast<Index>(k)];
        const FaceCells cells = mesh.face_cells[f];
        if (cells.below == c || cells.below < 0)
          measure.segment<3>(mesh.faces.begin(f)).setConstant(volume);
      }
      workspace.terms[c] = term;
    }
  });
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
        double around = 0;  // of the faces at this vertex
        for (std::size_t k = 0; k < 4; ++k)
          if (k != opposite) around += term.face_mass[k];
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
