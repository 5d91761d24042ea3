#include "carat/assembly/diamond_product.h"

#include <algorithm>

#include "carat/assembly/row_assembly.h"
#include "carat/assembly/row_pattern.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

DiamondProducts both_products(const std::shared_ptr<const ElementStructure>& structure,
                              const std::shared_ptr<const CornerTerms>& corners,
                              SparseMatrix between, ElementTerms of_stiffness, SparseMatrix mass,
                              ElementTerms of_mass, int threads) {
  return {std::make_shared<ElementProduct>(structure, corners, std::move(between),
                                           std::make_shared<ElementTerms>(std::move(of_stiffness)),
                                           threads),
          std::make_shared<ElementProduct>(structure, corners, std::move(mass),
                                           std::make_shared<ElementTerms>(std::move(of_mass)),
                                           threads)};
}

/// The energy of a diamond as couplings.
GeneralDiamondTerm couplings(const DiamondTerm& term) {
  GeneralDiamondTerm k{};
  k.v1 = term.v1;
  k.v2 = term.v2;
  k.left = term.left;
  k.right = term.right;
  k.k12 = term.alpha;
  k.k1l = k.k2r = -term.beta;
  k.k2l = k.k1r = term.beta;
  k.klr = term.gamma;
  k.mass1 = k.mass2 = k.mass_left = k.mass_right = term.mass_share;
  if (term.left < 0 || term.right < 0) {
    // u at the midpoint of the hinge is the mean of its ends.
    k.k1l += term.gamma / 2;
    k.k2l += term.gamma / 2;
    k.k1r += term.gamma / 2;
    k.k2r += term.gamma / 2;
    k.k12 -= term.gamma / 4;
    k.klr = 0;
  }
  return k;
}
const GeneralDiamondTerm& couplings(const GeneralDiamondTerm& term) { return term; }

/// Which diamonds belong to an edge.
template <class Term>
struct EdgeTerms {
  const Array<Term>& terms;
  const Array<Index>& first;  // empty: one an edge

  template <class Visit>
  void visit(Index edge, const Visit& visit) const {
    if (first.empty()) {
      visit(couplings(terms[edge]));
    } else {
      for (Index d = first[edge]; d < first[edge + 1]; ++d) visit(couplings(terms[d]));
    }
  }
};

template <class Term>
void fill_elements(const SurfaceIncidence& mesh, const EdgeTerms<Term>& diamonds,
                   const ElementStructure& structure, Array<double>& own, ElementTerms& stiffness,
                   ElementTerms& mass, Index begin, Index end) {
  for (Index f = begin; f < end; ++f) {
    const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
    std::fill(own.begin() + first, own.begin() + last, 0.0);
    double diagonal = 0, of_virtual = 0;
    Index across = structure.across.begin(f);
    for (Index corner = first; corner < last; ++corner) {
      const Index edge = mesh.corner_edges[corner];
      const Index next = corner + 1 == last ? first : corner + 1;
      const std::span<const Index> sides = mesh.edge_corners.row(edge);
      const Index end_of_side = across + static_cast<Index>(sides.size()) - 1;
      std::fill(stiffness.across.begin() + across, stiffness.across.begin() + end_of_side, 0.0);
      diamonds.visit(edge, [&](const GeneralDiamondTerm& k) {
        if (k.left != corner && k.right != corner) return;
        const bool is_left = k.left == corner;
        const bool a_is_1 = mesh.faces.indices[corner] == k.v1;
        const double to_1 = is_left ? k.k1l : k.k1r, to_2 = is_left ? k.k2l : k.k2r;
        own[corner] -= a_is_1 ? to_1 : to_2;
        own[next] -= a_is_1 ? to_2 : to_1;
        diagonal += to_1 + to_2 + k.klr;
        of_virtual += is_left ? k.mass_left : k.mass_right;
        const Index other = is_left ? k.right : k.left;
        Index place = across;
        for (const Index side : sides) {
          if (side == other) stiffness.across[place] += k.klr;
          if (side != corner) ++place;
        }
      });
      across = end_of_side;
    }
    stiffness.diagonal[f] = diagonal;
    if (!mass.diagonal.empty()) mass.diagonal[f] = of_virtual;
  }
}

/// Calls visit(edge, other end) for every edge of a vertex once.
template <class Visit>
void for_edges(const SurfaceIncidence& mesh, Index vertex, const Visit& visit) {
  for (const Index corner : mesh.vertex_corners.row(vertex)) {
    const Index f = mesh.corner_faces[corner];
    const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
    const Index next = corner + 1 == last ? first : corner + 1;
    const Index previous = corner == first ? last - 1 : corner - 1;
    const Index after = mesh.corner_edges[corner], before = mesh.corner_edges[previous];
    if (mesh.edge_corners.row(after)[0] == corner) visit(after, mesh.faces.indices[next]);
    if (mesh.edge_corners.row(before)[0] == previous) visit(before, mesh.faces.indices[previous]);
  }
}

}  // namespace

std::shared_ptr<ElementStructure> diamond_structure(const SurfaceIncidence& mesh) {
  auto structure =
      std::make_shared<ElementStructure>(mesh.faces, mesh.vertex_corners, mesh.corner_faces);
  Csr& across = structure->across;
  const Index n_faces = mesh.faces.n_rows();
  across.offsets.resize(static_cast<std::size_t>(n_faces) + 1);
  across.offsets[0] = 0;
  across.indices.reserve(mesh.faces.indices.size());
  for (Index f = 0; f < n_faces; ++f) {
    for (Index corner = mesh.faces.begin(f); corner < mesh.faces.end(f); ++corner)
      for (const Index side : mesh.edge_corners.row(mesh.corner_edges[corner]))
        if (side != corner) across.indices.push_back(mesh.corner_faces[side]);
    across.offsets[f + 1] = static_cast<Index>(across.indices.size());
  }
  return structure;
}

std::shared_ptr<ElementStructure> diamond_structure(const VolumeIncidence& mesh) {
  auto structure = std::make_shared<ElementStructure>(mesh.cell_vertices, mesh.vertex_cell_corners,
                                                      mesh.corner_cells);
  Csr& across = structure->across;
  const Index n_cells = mesh.cells.n_rows();
  across.offsets.resize(static_cast<std::size_t>(n_cells) + 1);
  across.offsets[0] = 0;
  across.indices.reserve(mesh.cells.indices.size());
  for (Index c = 0; c < n_cells; ++c) {
    for (const Index f : mesh.cells.row(c))
      if (const Index other = mesh.face_cells[f].other(c); other >= 0)
        across.indices.push_back(other);
    across.offsets[c + 1] = static_cast<Index>(across.indices.size());
  }
  return structure;
}

template <class Term>
DiamondProducts diamond_products(std::shared_ptr<const ElementStructure> structure,
                                 bool lumped_mass, const SurfaceIncidence& mesh,
                                 const Array<Term>& terms, const Array<Index>& edge_diamonds,
                                 const Array<double>& weights, int threads) {
  const EdgeTerms<Term> diamonds{terms, edge_diamonds};
  const Index n_faces = mesh.faces.n_rows(), n = mesh.vertex_corners.n_rows();
  ElementTerms of_stiffness, of_mass;
  of_stiffness.couples = true;
  Array<double> own(weights.size());
  of_stiffness.diagonal.resize(static_cast<std::size_t>(n_faces));
  of_stiffness.across.resize(structure->across.indices.size());
  of_mass.diagonal.resize(static_cast<std::size_t>(n_faces));
  parallel_blocks(n_faces, threads, [&](int, Index begin, Index end) {
    fill_elements(mesh, diamonds, *structure, own, of_stiffness, of_mass, begin, end);
  });
  Array<Index> sizes(static_cast<std::size_t>(n));
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      sizes[row] = mesh.vertex_corners.size(row) > 0;
      for_edges(mesh, row, [&](Index, Index) { ++sizes[row]; });
    }
  });
  SparseMatrix between = allocate_rows(n, n, sizes, "the couplings along edges");
  SparseMatrix mass = diagonal_pattern(n);
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      const std::span<const Index> corners = mesh.vertex_corners.row(row);
      double diagonal = 0, own_mass = 0;
      const Index first = between.outerIndexPtr()[row];
      Index last = first;
      Index* const columns = between.innerIndexPtr();
      double* const values = between.valuePtr();
      // Ascending.
      const auto insert = [&](Index column, double value) {
        Index place = last++;
        for (; place > first && columns[place - 1] > column; --place) {
          columns[place] = columns[place - 1];
          values[place] = values[place - 1];
        }
        columns[place] = column;
        values[place] = value;
      };
      for_edges(mesh, row, [&](Index edge, Index other) {
        double along = 0;
        diamonds.visit(edge, [&](const GeneralDiamondTerm& k) {
          const bool is_1 = row == k.v1;
          along -= k.k12;
          diagonal += k.k12 +
                      (k.left < 0 ? 0.0
                       : is_1     ? k.k1l
                                  : k.k2l) +
                      (k.right < 0 ? 0.0
                       : is_1      ? k.k1r
                                   : k.k2r);
          own_mass += is_1 ? k.mass1 : k.mass2;
        });
        insert(other, along);
      });
      if (!corners.empty()) insert(row, diagonal);
      if (lumped_mass)
        for (const Index corner : corners)  // the weights of a face sum to one
          own_mass += weights[corner] * of_mass.diagonal[mesh.corner_faces[corner]];
      mass.valuePtr()[row] = own_mass;
    }
  });
  if (lumped_mass) of_mass = {};
  const auto corners = std::make_shared<CornerTerms>(*structure, weights, own, threads);
  return both_products(structure, corners, std::move(between), std::move(of_stiffness),
                       std::move(mass), std::move(of_mass), threads);
}

template DiamondProducts diamond_products(std::shared_ptr<const ElementStructure>, bool,
                                          const SurfaceIncidence&, const Array<DiamondTerm>&,
                                          const Array<Index>&, const Array<double>&, int);
template DiamondProducts diamond_products(std::shared_ptr<const ElementStructure>, bool,
                                          const SurfaceIncidence&, const Array<GeneralDiamondTerm>&,
                                          const Array<Index>&, const Array<double>&, int);

SparseMatrix interface_pattern(const VolumeIncidence& mesh, const Csr& vertex_corners,
                               const Array<Index>& corner_faces, int threads) {
  const Index n = mesh.n_vertices();
  Array<Index> sizes, same;
  const std::vector<CollectedRows> rows =
      collect_rows(n, threads, sizes, same, [&](Index row, RowCollector& out) {
        if (mesh.vertex_cell_corners.size(row) > 0) out.add(row, row);
        for (const Index corner : vertex_corners.row(row)) {
          const FaceCells cells = mesh.face_cells[corner_faces[corner]];
          if (cells.below < 0 && cells.above < 0) continue;
          for (const Index v : mesh.faces.row(corner_faces[corner])) out.add(v, row);
        }
        return Index{0};
      });
  SparseMatrix pattern = allocate_rows(n, n, sizes, "the couplings within faces");
  write_transposed(rows, sizes, sizes, threads, pattern);
  return pattern;
}

DiamondProducts diamond_products(std::shared_ptr<const ElementStructure> structure,
                                 const SparseMatrix& pattern, bool lumped_mass,
                                 const VolumeIncidence& mesh, const Csr& vertex_corners,
                                 const Array<Index>& corner_faces,
                                 const Array<double>& face_weights,
                                 const Array<double>& cell_weights,
                                 const VolumeDiamondWorkspace& workspace, int threads) {
  const Index n = mesh.n_vertices(), n_cells = mesh.cells.n_rows();
  ElementTerms of_stiffness, of_mass;
  of_stiffness.couples = true;
  Array<double> own(cell_weights.size());
  of_stiffness.diagonal.resize(static_cast<std::size_t>(n_cells));
  of_stiffness.across.resize(structure->across.indices.size());
  of_mass.diagonal.resize(static_cast<std::size_t>(n_cells));
  parallel_blocks(n_cells, threads, [&](int, Index begin, Index end) {
    Array<Index> place(static_cast<std::size_t>(n));  // vertex -> its corner of the cell at hand
    for (Index c = begin; c < end; ++c) {
      for (Index k = mesh.cell_vertices.begin(c); k < mesh.cell_vertices.end(c); ++k) {
        place[mesh.cell_vertices.indices[k]] = k;
        own[k] = 0;
      }
      double diagonal = 0, mass = 0;
      Index across = structure->across.begin(c);
      for (const Index f : mesh.cells.row(c)) {
        const FaceCells cells = mesh.face_cells[f];
        const VolumeDiamondWorkspace::Face& face = workspace.faces[f];
        const bool is_above = cells.above == c;
        const double of_face = is_above ? face.above : face.below;
        for (Index corner = mesh.faces.begin(f); corner < mesh.faces.end(f); ++corner) {
          const VolumeDiamondWorkspace::Tips& at = workspace.tips[corner];
          own[place[mesh.faces.indices[corner]]] +=
              (is_above ? at.above : at.below) + of_face * face_weights[corner];
        }
        diagonal += is_above ? face.gamma_above : face.gamma_below;
        mass += is_above ? face.mass_above : face.mass_below;
        if (cells.other(c) >= 0) of_stiffness.across[across++] = face.gamma_across;
      }
      of_stiffness.diagonal[c] = diagonal;
      of_mass.diagonal[c] = mass;
    }
  });
  SparseMatrix between = pattern;
  SparseMatrix mass = lumped_mass ? diagonal_pattern(n) : pattern;
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    Array<Index> position(static_cast<std::size_t>(n)), mass_position(position.size());
    for (Index row = begin; row < end; ++row) {
      const RowWriter stiffness_row(between, row, position);
      const RowWriter mass_row(mass, row, mass_position);
      double diagonal = 0, own_mass = 0;
      for (const Index corner : vertex_corners.row(row)) {
        const Index f = corner_faces[corner];
        const FaceCells cells = mesh.face_cells[f];
        if (cells.below < 0 && cells.above < 0) continue;
        const Index first = mesh.faces.begin(f), last = mesh.faces.end(f);
        const Index next = corner + 1 == last ? first : corner + 1;
        const Index previous = corner == first ? last - 1 : corner - 1;
        const Index* const vertices = mesh.faces.indices.data();
        const VolumeDiamondWorkspace::Corner& at = workspace.corners[corner];
        const double weight = face_weights[corner];
        const double face_weight = workspace.faces[f].spokes * weight - at.spoke;
        const double mass_weight = workspace.faces[f].mass * weight;
        diagonal += at.diagonal;
        own_mass += at.mass;
        stiffness_row.add(vertices[next], -at.side);
        stiffness_row.add(vertices[previous], -workspace.corners[previous].side);
        for (Index k = first; k < last; ++k)
          stiffness_row.add(vertices[k],
                            face_weight * face_weights[k] - weight * workspace.corners[k].spoke);
        if (lumped_mass)
          own_mass += mass_weight;
        else
          for (Index k = first; k < last; ++k)
            mass_row.add(vertices[k], mass_weight * face_weights[k]);
      }
      if (lumped_mass)
        for (const Index corner : mesh.vertex_cell_corners.row(row))
          own_mass += cell_weights[corner] * of_mass.diagonal[mesh.corner_cells[corner]];
      const bool referenced = mesh.vertex_cell_corners.size(row) > 0;
      if (referenced) stiffness_row.add(row, diagonal);
      if (referenced || lumped_mass) mass_row.add(row, own_mass);
    }
  });
  if (lumped_mass) of_mass = {};
  const auto corners = std::make_shared<CornerTerms>(*structure, cell_weights, own, threads);
  return both_products(structure, corners, std::move(between), std::move(of_stiffness),
                       std::move(mass), std::move(of_mass), threads);
}

}  // namespace carat
