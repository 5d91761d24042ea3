#include "carat/assembly/diamond_assembly.h"

#include "carat/assembly/row_assembly.h"

namespace carat {
namespace {

/// The faces around one vertex, each with its own weight of the vertex and the coefficient that
/// its weights get in the row.
class FacesOfRow {
 public:
  explicit FacesOfRow(Index n_faces) : slot_of_face_(static_cast<std::size_t>(n_faces), Mark{-1, 0}) {}

  void open(const SurfaceIncidence& mesh, const Array<double>& weights, Index row) {
    row_ = row;
    slots_.clear();
    for (const Index corner : mesh.vertex_corners.row(row)) {
      const Index f = mesh.corner_faces[corner];
      Mark& mark = slot_of_face_[f];
      if (mark.row != row) {
        mark = {row, static_cast<Index>(slots_.size())};
        slots_.push_back({f, 0.0, 0.0});
      }
      slots_[mark.slot].own_weight += weights[corner];
    }
  }

  struct Slot {
    Index face;
    double own_weight;   // of the row's vertex in this face
    double coefficient;  // of the face's weights in the row
  };
  Array<Slot>& slots() { return slots_; }
  Slot* find(Index face) {
    const Mark mark = slot_of_face_[face];
    return mark.row == row_ ? &slots_[mark.slot] : nullptr;
  }

 private:
  struct Mark {
    Index row, slot;
  };
  Array<Mark> slot_of_face_;
  Array<Slot> slots_;
  Index row_ = -1;
};

void add_face_weights(const SurfaceIncidence& mesh, const Array<double>& weights, Index face,
                      double coefficient, RowWriter& writer) {
  for (Index c = mesh.faces.begin(face); c < mesh.faces.end(face); ++c)
    writer.add(mesh.faces.indices[c], coefficient * weights[c]);
}

/// Adds the diamond's part of the row; seen from `corner`, a side of the face in `slot`.
inline void add_diamond(const SurfaceIncidence& mesh, const DiamondTerm& term, Index corner, Index row,
                        const Array<double>& weights, FacesOfRow& faces, FacesOfRow::Slot& slot,
                        RowWriter& writer) {
  const bool from_left = term.left == corner;
  if (!from_left && term.right != corner) return;
  const Index across = from_left ? term.right : term.left;
  const double sign = from_left ? 1.0 : -1.0;
  const double d = static_cast<double>(row == term.v2) - static_cast<double>(row == term.v1);
  double w = sign * slot.own_weight;
  if (across < 0) {
    // u at the midpoint of the hinge is the mean of its ends.
    if (d != 0) w -= sign * 0.5;
    const double along = term.alpha * d - term.beta * w;
    const double over = sign * (term.gamma * w - term.beta * d);
    writer.add(term.v1, -along - 0.5 * over);
    writer.add(term.v2, along - 0.5 * over);
    slot.coefficient += over;
    return;
  }
  const Index other_face = mesh.corner_faces[across];
  FacesOfRow::Slot* const other = faces.find(other_face);
  if (other != nullptr) {
    if (!from_left) return;  // both faces belong to the row: counted once, from the left
    w -= other->own_weight;
  }
  const double along = term.alpha * d - term.beta * w;
  const double over = sign * (term.gamma * w - term.beta * d);
  writer.add(term.v1, -along);
  writer.add(term.v2, along);
  slot.coefficient += over;
  if (other != nullptr)
    other->coefficient -= over;
  else
    add_face_weights(mesh, weights, other_face, -over, writer);
}

}  // namespace

void assemble_diamonds(SparseMatrix& stiffness, const SurfaceIncidence& mesh,
                       const Array<DiamondTerm>& terms, const Array<Index>& edge_diamonds,
                       const Array<double>& weights, int threads) {
  const bool one_an_edge = edge_diamonds.empty();
  assemble_rows(
      stiffness, threads, [&] { return FacesOfRow(mesh.faces.n_rows()); },
      [&](Index row, RowWriter& writer, FacesOfRow& faces) {
        faces.open(mesh, weights, row);
        for (FacesOfRow::Slot& slot : faces.slots()) {
          for (Index c = mesh.faces.begin(slot.face); c < mesh.faces.end(slot.face); ++c) {
            const Index e = mesh.corner_edges[c];
            const Index first = one_an_edge ? e : edge_diamonds[e];
            const Index last = one_an_edge ? e + 1 : edge_diamonds[e + 1];
            for (Index k = first; k < last; ++k)
              add_diamond(mesh, terms[k], c, row, weights, faces, slot, writer);
          }
        }
        for (const FacesOfRow::Slot& slot : faces.slots())
          add_face_weights(mesh, weights, slot.face, slot.coefficient, writer);
      });
}

}  // namespace carat
