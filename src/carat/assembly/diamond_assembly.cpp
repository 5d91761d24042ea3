#include "carat/assembly/diamond_assembly.h"

#include <algorithm>

#include "carat/base/parallel.h"

namespace carat {
namespace {

using Corner = DiamondWorkspace::Corner;
using Face = DiamondWorkspace::Face;

/// What the face at `corner`, a side of the diamond, adds at the side's first vertex a and its
/// second b.
/// \param a_is_1  a is the diamond's vertex 1
inline void add_side(const DiamondTerm& term, Index corner, bool a_is_1, Corner& a, Corner& b,
                     Face& face) {
  face.mass += term.mass_share;
  face.gamma += term.gamma;
  // -sigma beta d at this corner; minus that at the next.
  const double beta = a_is_1 == (term.left == corner) ? term.beta : -term.beta;
  a.beta += beta;
  b.beta -= beta;
  // A diamond's two sides each bring half of what belongs to its hinge.
  double side = 0.5 * term.alpha, share = 0.5 * term.mass_share;
  if (term.left < 0 || term.right < 0) {
    // p_across is half of both ends: u at the midpoint of the hinge is their mean.
    const double half_gamma = 0.5 * term.gamma;
    a.diagonal += half_gamma - beta;
    b.diagonal += half_gamma + beta;
    a.beta -= half_gamma;
    b.beta -= half_gamma;
    side = term.alpha - 0.5 * half_gamma;
    share = term.mass_share;
  }
  a.side += side;
  a.diagonal += side;
  b.diagonal += side;
  a.mass += share;
  b.mass += share;
}
inline double across_coupling(const DiamondTerm& term) { return term.gamma; }

inline void add_side(const GeneralDiamondTerm& term, Index corner, bool a_is_1, Corner& a,
                     Corner& b, Face& face) {
  const bool is_left = term.left == corner;
  const double to_1 = is_left ? term.k1l : term.k1r, to_2 = is_left ? term.k2l : term.k2r;
  const double to_a = a_is_1 ? to_1 : to_2, to_b = a_is_1 ? to_2 : to_1;
  face.mass += is_left ? term.mass_left : term.mass_right;
  face.gamma += to_a + to_b + term.klr;
  a.beta -= to_a;
  b.beta -= to_b;
  // A diamond's two sides each bring half of what belongs to its hinge.
  const double part = term.left < 0 || term.right < 0 ? 1.0 : 0.5;
  const double side = part * term.k12;
  a.side += side;
  a.diagonal += side + to_a;
  b.diagonal += side + to_b;
  a.mass += part * (a_is_1 ? term.mass1 : term.mass2);
  b.mass += part * (a_is_1 ? term.mass2 : term.mass1);
}
inline double across_coupling(const GeneralDiamondTerm& term) { return term.klr; }

/// The diamonds of an edge: one, unless more than two faces meet there.
template <bool kOneAnEdge, class Term>
struct EdgeDiamonds {
  const Term* terms;
  const Index* first;  // null if kOneAnEdge

  /// Calls visit(term) for the diamonds that `corner` is a side of.
  template <class Visit>
  void for_side(Index edge, Index corner, const Visit& visit) const {
    if constexpr (kOneAnEdge) {
      visit(terms[edge]);
    } else {
      for (Index k = first[edge]; k < first[edge + 1]; ++k)
        if (terms[k].left == corner || terms[k].right == corner) visit(terms[k]);
    }
  }
};

/// The values of the corners, faces and rings of faces [begin, end).
template <bool kOneAnEdge, class Term>
void fill_faces(const SurfaceIncidence& mesh, const FaceRings& rings,
                const EdgeDiamonds<kOneAnEdge, Term>& diamonds, const Array<double>& weights,
                Index begin, Index end, DiamondWorkspace& out) {
  for (Index f = begin; f < end; ++f) {
    const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
    double* across = out.across.data() + rings.begin(f);
    Face face{0, 0};
    std::fill(out.corners.begin() + first, out.corners.begin() + last, Corner{0, 0, 0, 0, 0});
    for (Index corner = first; corner < last; ++corner) {
      const Index edge = mesh.corner_edges[corner];
      const Index next = corner + 1 == last ? first : corner + 1;
      Corner& a = out.corners[corner];
      Corner& b = out.corners[next];
      diamonds.for_side(edge, corner, [&](const Term& term) {
        add_side(term, corner, mesh.faces.indices[corner] == term.v1, a, b, face);
      });
      const auto add_across = [&](Index other, double gamma) {
        // The side's two ends are vertices of f as well.
        const Index g = mesh.corner_faces[other];
        const Index other_end = other + 1 == mesh.faces.end(g) ? mesh.faces.begin(g) : other + 1;
        const bool opposed = mesh.faces.indices[other] == mesh.faces.indices[next];
        (opposed ? b : a).ring -= gamma * weights[other];
        (opposed ? a : b).ring -= gamma * weights[other_end];
        for_vertices_across(mesh, other, [&](Index c) { *across++ = -gamma * weights[c]; });
      };
      if constexpr (kOneAnEdge) {
        const Term& term = diamonds.terms[edge];
        const Index other = term.left == corner ? term.right : term.left;
        if (other >= 0) add_across(other, across_coupling(term));
      } else {
        for (const Index other : mesh.edge_corners.row(edge)) {
          if (other == corner) continue;
          double gamma = 0;
          diamonds.for_side(edge, corner, [&](const Term& term) {
            if (term.left == other || term.right == other) gamma += across_coupling(term);
          });
          add_across(other, gamma);
        }
      }
    }
    for (Index corner = first; corner < last; ++corner)
      out.corners[corner].ring += out.corners[corner].beta;
    out.faces[f] = face;
  }
}

/// Adds to one row of a matrix with a known pattern.
class RowWriter {
 public:
  RowWriter(SparseMatrix& matrix, Array<Index>& position)
      : offsets_(matrix.outerIndexPtr()),
        columns_(matrix.innerIndexPtr()),
        values_(matrix.valuePtr()),
        position_(position.data()) {}
  void open(Index row) {
    const Index begin = offsets_[row], end = offsets_[row + 1];
    for (Index k = begin; k < end; ++k) position_[columns_[k]] = k;
    std::fill(values_ + begin, values_ + end, 0.0);
  }
  void add(Index column, double value) const { values_[position_[column]] += value; }

 private:
  const Index* offsets_;
  const Index* columns_;
  double* values_;
  Index* position_;  // column -> its entry; set for the columns of the open row only
};

void fill_rows(SparseMatrix& stiffness_matrix, SparseMatrix& mass_matrix, bool lumped_mass,
               const SurfaceIncidence& mesh, const FaceRings& rings, const Array<double>& weights,
               Index begin, Index end, const DiamondWorkspace& values,
               DiamondWorkspace::Thread& scratch) {
  RowWriter stiffness(stiffness_matrix, scratch.stiffness_position);
  RowWriter mass(mass_matrix, scratch.mass_position);
  for (Index row = begin; row < end; ++row) {
    stiffness.open(row);
    mass.open(row);
    const std::span<const Index> corners = mesh.vertex_corners.row(row);
    double diagonal = 0, diagonal_mass = 0;
    for (const Index corner : corners) {
      const Index f = mesh.corner_faces[corner];
      const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
      const Index next = corner + 1 == last ? first : corner + 1;
      const Index previous = corner == first ? last - 1 : corner - 1;
      const Corner& own = values.corners[corner];
      const double weight = weights[corner];
      const double face_weight = own.beta + values.faces[f].gamma * weight;
      const double mass_weight = values.faces[f].mass * weight;
      diagonal += own.diagonal;
      diagonal_mass += own.mass;
      stiffness.add(mesh.faces.indices[next], -own.side);
      stiffness.add(mesh.faces.indices[previous], -values.corners[previous].side);
      for (Index c = first; c < last; ++c)
        stiffness.add(mesh.faces.indices[c],
                      face_weight * weights[c] + weight * values.corners[c].ring);
      if (lumped_mass)
        diagonal_mass += mass_weight;  // the weights of a face sum to one
      else
        for (Index c = first; c < last; ++c)
          mass.add(mesh.faces.indices[c], mass_weight * weights[c]);
      const std::int64_t ring_end = rings.end(f);
      for (std::int64_t k = rings.begin(f); k < ring_end; ++k)
        stiffness.add(rings.vertices[k], weight * values.across[k]);
    }
    if (!corners.empty()) stiffness.add(row, diagonal);
    if (!corners.empty() || lumped_mass) mass.add(row, diagonal_mass);
  }
}

}  // namespace

template <class Term>
void assemble_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                       const SurfaceIncidence& mesh, const FaceRings& rings,
                       const Array<Term>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads, DiamondWorkspace& workspace) {
  const Index n_vertices = static_cast<Index>(stiffness.rows());
  const Index n_faces = mesh.faces.n_rows();
  workspace.corners.resize(weights.size());
  workspace.faces.resize(static_cast<std::size_t>(n_faces));
  workspace.across.resize(rings.vertices.size());
  workspace.threads.resize(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n_faces, threads, [&](int, Index begin, Index end) {
    if (edge_diamonds.empty())
      fill_faces(mesh, rings, EdgeDiamonds<true, Term>{terms.data(), nullptr}, weights, begin, end,
                 workspace);
    else
      fill_faces(mesh, rings, EdgeDiamonds<false, Term>{terms.data(), edge_diamonds.data()},
                 weights, begin, end, workspace);
  });
  parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
    DiamondWorkspace::Thread& scratch = workspace.threads[static_cast<std::size_t>(block)];
    scratch.stiffness_position.resize(static_cast<std::size_t>(n_vertices));
    scratch.mass_position.resize(static_cast<std::size_t>(n_vertices));
    fill_rows(stiffness, mass, lumped_mass, mesh, rings, weights, begin, end, workspace, scratch);
  });
}

template void assemble_diamonds(SparseMatrix&, SparseMatrix&, bool, const SurfaceIncidence&,
                                const FaceRings&, const Array<DiamondTerm>&, const Array<Index>&,
                                const Array<double>&, int, DiamondWorkspace&);
template void assemble_diamonds(SparseMatrix&, SparseMatrix&, bool, const SurfaceIncidence&,
                                const FaceRings&, const Array<GeneralDiamondTerm>&,
                                const Array<Index>&, const Array<double>&, int, DiamondWorkspace&);

}  // namespace carat
