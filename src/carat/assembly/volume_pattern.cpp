#include "carat/assembly/volume_pattern.h"

#include <string>

#include "carat/base/error.h"

namespace carat {
namespace {

/// Places of the vertices of one cell after the other.
class PlaceFinder {
 public:
  explicit PlaceFinder(Index n_vertices)
      : cell_(static_cast<std::size_t>(n_vertices), -1),
        place_(static_cast<std::size_t>(n_vertices)) {}

  /// Gives v the place `next` unless it has one in this cell. True if it was new.
  bool add(Index cell, Index v, Index next) {
    if (cell_[v] == cell) return false;
    cell_[v] = cell;
    place_[v] = next;
    return true;
  }
  Index place(Index v) const { return place_[v]; }

 private:
  Array<Index> cell_, place_;
};

/// Refuses cells whose vertices alone, each coupled to each, pass 2^31 entries.
void check_cell_sizes(const VolumeIncidence& mesh) {
  constexpr Index kMostVertices = 46340;  // the root of 2^31
  for (Index c = 0; c < mesh.cell_vertices.n_rows(); ++c)
    if (mesh.cell_vertices.size(c) > kMostVertices)
      throw InvalidMesh("cell " + std::to_string(c) + " has " +
                            std::to_string(mesh.cell_vertices.size(c)) +
                            " vertices, all coupled to each other: at most " +
                            std::to_string(kMostVertices) + " are supported; split the cell",
                        {c});
}

}  // namespace

CellRings cell_rings(const VolumeIncidence& mesh, int threads) {
  check_cell_sizes(mesh);
  const Index n = mesh.cells.n_rows();
  CellRings rings;
  rings.place_offsets.resize(static_cast<std::size_t>(n) + 1);
  rings.ring_offsets.resize(static_cast<std::size_t>(n) + 1);
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      std::int64_t size = 0;
      for (const Index f : mesh.cells.row(c)) {
        const Index other = mesh.face_cells[f].other(c);
        size += mesh.faces.size(f) + (other >= 0 ? mesh.cell_vertices.size(other) : 0);
      }
      rings.place_offsets[c + 1] = size;
    }
  });
  rings.place_offsets[0] = 0;
  for (Index c = 0; c < n; ++c) rings.place_offsets[c + 1] += rings.place_offsets[c];
  rings.places.resize(static_cast<std::size_t>(rings.place_offsets[n]));

  std::vector<Array<Index>> collected(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n, threads, [&](int block, Index begin, Index end) {
    PlaceFinder finder(mesh.n_vertices());
    Array<Index>& ring = collected[static_cast<std::size_t>(block)];
    for (Index c = begin; c < end; ++c) {
      const std::size_t first = ring.size();
      Index next = 0;
      for (const Index v : mesh.cell_vertices.row(c)) finder.add(c, v, next++);
      Index* place = rings.places.data() + rings.place_offsets[c];
      for (const Index f : mesh.cells.row(c)) {
        for (const Index v : mesh.faces.row(f)) *place++ = finder.place(v);
        const Index other = mesh.face_cells[f].other(c);
        if (other < 0) continue;
        for (const Index v : mesh.cell_vertices.row(other)) {
          if (finder.add(c, v, next)) {
            ++next;
            ring.push_back(v);
          }
          *place++ = finder.place(v);
        }
      }
      rings.ring_offsets[c + 1] = static_cast<std::int64_t>(ring.size() - first);
    }
  });
  rings.ring_offsets[0] = 0;
  for (Index c = 0; c < n; ++c) rings.ring_offsets[c + 1] += rings.ring_offsets[c];
  if (collected.size() == 1) {
    rings.ring = std::move(collected[0]);
  } else {
    rings.ring.reserve(static_cast<std::size_t>(rings.ring_offsets[n]));
    for (const Array<Index>& part : collected)
      rings.ring.insert(rings.ring.end(), part.begin(), part.end());
  }
  return rings;
}

SparseMatrix cell_pattern(const VolumeIncidence& mesh, int threads) {
  check_cell_sizes(mesh);
  Array<Index> sizes, same;
  const Index n = mesh.n_vertices();
  const std::vector<CollectedRows> rows =
      collect_rows(n, threads, sizes, same, [&](Index row, RowCollector& out) {
        for (const Index corner : mesh.vertex_cell_corners.row(row))
          for (const Index v : mesh.cell_vertices.row(mesh.corner_cells[corner])) out.add(v, row);
        return Index{0};
      });
  SparseMatrix pattern = allocate_rows(n, n, sizes, "the matrix");
  write_transposed(rows, sizes, sizes, threads, pattern);
  return pattern;
}

VolumeDiamondPatterns diamond_patterns(const VolumeIncidence& mesh, const CellRings& rings,
                                       int threads) {
  return diamond_patterns(mesh, threads, [&](Index c, auto&& visit) {
    for (std::int64_t k = rings.ring_offsets[c]; k < rings.ring_offsets[c + 1]; ++k)
      visit(rings.ring[static_cast<std::size_t>(k)]);
  });
}

}  // namespace carat
