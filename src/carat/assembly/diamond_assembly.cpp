#include "carat/assembly/diamond_assembly.h"

#include <algorithm>

#include "carat/base/parallel.h"

namespace carat {
namespace {

/// The diamonds of an edge: one, unless more than two faces meet there.
template <bool kOneAnEdge>
struct EdgeDiamonds {
  const DiamondTerm* terms;
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

/// r_f and the mass of the virtual vertex, for faces [begin, end).
template <bool kOneAnEdge>
void fill_rings(const SurfaceIncidence& mesh, const FaceRings& rings,
                const EdgeDiamonds<kOneAnEdge>& diamonds, const Array<double>& weights,
                Index begin, Index end, DiamondWorkspace& out) {
  for (Index f = begin; f < end; ++f) {
    const Index first = mesh.faces.begin(f), size = mesh.faces.size(f);
    double* const own = out.ring_values.data() + rings.begin(f);
    double* across = own + size;
    std::fill(own, across, 0.0);
    double gamma_sum = 0, mass = 0;
    for (Index a = 0; a < size; ++a) {
      const Index corner = first + a, edge = mesh.corner_edges[corner];
      const Index next = a + 1 == size ? 0 : a + 1;
      double own_beta = 0;  // of d = u(next) - u(a), whichever way the edge is numbered
      diamonds.for_side(edge, corner, [&](const DiamondTerm& term) {
        mass += term.mass_share;
        gamma_sum += term.gamma;
        const bool along_hinge = mesh.faces.indices[corner] == term.v1;
        own_beta += along_hinge == (term.left == corner) ? term.beta : -term.beta;
        if (term.left < 0 || term.right < 0) {
          // u at the midpoint of the hinge is the mean of its ends.
          own[a] -= 0.5 * term.gamma;
          own[next] -= 0.5 * term.gamma;
        }
      });
      own[a] += own_beta;
      own[next] -= own_beta;
      for (const Index side : mesh.edge_corners.row(edge)) {
        if (side == corner) continue;
        double gamma = 0;
        diamonds.for_side(edge, corner, [&](const DiamondTerm& term) {
          if (term.left == side || term.right == side) gamma += term.gamma;
        });
        // The side's two ends are vertices of f as well.
        const Index g = mesh.corner_faces[side];
        const Index side_end = side + 1 == mesh.faces.end(g) ? mesh.faces.begin(g) : side + 1;
        const bool opposed = mesh.faces.indices[side] == mesh.faces.indices[first + next];
        own[opposed ? next : a] -= gamma * weights[side];
        own[opposed ? a : next] -= gamma * weights[side_end];
        for_vertices_across(mesh, side, [&](Index c) { *across++ = -gamma * weights[c]; });
      }
    }
    for (Index a = 0; a < size; ++a) own[a] += gamma_sum * weights[first + a];
    out.face_mass[f] = mass;
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

template <bool kOneAnEdge>
void fill_rows(SparseMatrix& stiffness_matrix, SparseMatrix& mass_matrix, bool lumped_mass,
               const SurfaceIncidence& mesh, const FaceRings& rings,
               const EdgeDiamonds<kOneAnEdge>& diamonds, const Array<double>& weights, Index begin,
               Index end, const DiamondWorkspace& values, DiamondWorkspace::Thread& scratch) {
  RowWriter stiffness(stiffness_matrix, scratch.stiffness_position);
  RowWriter mass(mass_matrix, scratch.mass_position);
  for (Index row = begin; row < end; ++row) {
    stiffness.open(row);
    mass.open(row);
    const std::span<const Index> corners = mesh.vertex_corners.row(row);
    double own_mass = 0;
    for (const Index corner : corners) {
      const Index f = mesh.corner_faces[corner];
      const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
      // The edges at the row's vertex, from this face's side: d_i (alpha d - beta w).
      double coefficient = 0;  // of this face's weights
      const auto add_hinge = [&](Index side, Index neighbour) {
        diamonds.for_side(mesh.corner_edges[side], side, [&](const DiamondTerm& term) {
          const bool from_left = term.left == side;
          const double beta = (term.v2 == row) == from_left ? term.beta : -term.beta;
          coefficient -= beta;
          const bool boundary = term.left < 0 || term.right < 0;
          if (boundary) {
            // w holds minus half of both ends: the mean of u at the midpoint of the hinge.
            coefficient -= 0.5 * term.gamma;
            stiffness.add(row, beta + 0.25 * term.gamma);
            stiffness.add(neighbour, 0.25 * term.gamma);
          }
          if (from_left || boundary) {  // once a diamond
            stiffness.add(row, term.alpha);
            stiffness.add(neighbour, -term.alpha);
            own_mass += term.mass_share;
          }
        });
      };
      const Index previous = corner == first ? last - 1 : corner - 1;
      add_hinge(corner, mesh.faces.indices[corner + 1 == last ? first : corner + 1]);
      add_hinge(previous, mesh.faces.indices[previous]);

      const double weight = weights[corner];
      const double mass_weight = values.face_mass[f] * weight;
      const Index* v = rings.vertices.data() + rings.begin(f);
      const double* r = values.ring_values.data() + rings.begin(f);
      const Index* const ring_end = rings.vertices.data() + rings.end(f);
      if (lumped_mass) {
        own_mass += mass_weight;  // the weights of a face sum to one
        for (Index c = first; c < last; ++c, ++v, ++r)
          stiffness.add(*v, coefficient * weights[c] + weight * *r);
      } else {
        for (Index c = first; c < last; ++c, ++v, ++r) {
          stiffness.add(*v, coefficient * weights[c] + weight * *r);
          mass.add(*v, mass_weight * weights[c]);
        }
      }
      for (; v < ring_end; ++v, ++r) stiffness.add(*v, weight * *r);
    }
    if (!corners.empty() || lumped_mass) mass.add(row, own_mass);
  }
}

}  // namespace

void assemble_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                       const SurfaceIncidence& mesh, const FaceRings& rings,
                       const Array<DiamondTerm>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads, DiamondWorkspace& workspace) {
  const Index n_vertices = static_cast<Index>(stiffness.rows());
  const Index n_faces = mesh.faces.n_rows();
  workspace.ring_values.resize(rings.vertices.size());
  workspace.face_mass.resize(static_cast<std::size_t>(n_faces));
  workspace.threads.resize(static_cast<std::size_t>(resolve_threads(threads)));
  const auto run = [&](const auto& diamonds) {
    parallel_blocks(n_faces, threads, [&](int, Index begin, Index end) {
      fill_rings(mesh, rings, diamonds, weights, begin, end, workspace);
    });
    parallel_blocks(n_vertices, threads, [&](int block, Index begin, Index end) {
      DiamondWorkspace::Thread& scratch = workspace.threads[static_cast<std::size_t>(block)];
      scratch.stiffness_position.resize(static_cast<std::size_t>(n_vertices));
      scratch.mass_position.resize(static_cast<std::size_t>(n_vertices));
      fill_rows(stiffness, mass, lumped_mass, mesh, rings, diamonds, weights, begin, end,
                workspace, scratch);
    });
  };
  if (edge_diamonds.empty())
    run(EdgeDiamonds<true>{terms.data(), nullptr});
  else
    run(EdgeDiamonds<false>{terms.data(), edge_diamonds.data()});
}

}  // namespace carat
