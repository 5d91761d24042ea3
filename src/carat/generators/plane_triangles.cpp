#include "carat/generators/jitter.h"
#include "carat/generators/lattice.h"

namespace carat {
namespace {

/// Rows of 6 * 2^level intervals; odd rows are shifted by half an interval, which adds a vertex.
class TriangleRows {
 public:
  explicit TriangleRows(Index n) : n_(n) {}

  Index row_size(Index j) const { return n_ + 1 + j % 2; }
  Index first(Index j) const { return j * (n_ + 1) + j / 2; }
  double x(Index j, Index i) const {
    if (j % 2 == 0) return double(i) / n_;
    return i == 0 ? 0 : i == n_ + 1 ? 1 : (i - 0.5) / n_;
  }
  /// The strip between rows j and j + 1, from left to right.
  void add_strip(Index j, Csr& faces) const {
    Index below = 0, above = 0;
    while (below + 1 < row_size(j) || above + 1 < row_size(j + 1)) {
      const Index v = first(j) + below, w = first(j + 1) + above;
      // The odd row goes first: its next vertex always lies farther to the left.
      const bool advance_above = j % 2 == 0 ? above == below : above < below || below > n_;
      faces.indices.insert(faces.indices.end(), {v, advance_above ? w + 1 : v + 1, w});
      faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
      ++(advance_above ? above : below);
    }
  }

 private:
  Index n_;
};

}  // namespace

/// n = 6 * 2^level intervals a row and m = 7 * 2^level rows: equilateral to 1 % without jitter.
/// Left and right, every other triangle is half of one.
PolygonMesh generate_plane_triangles(const FamilyOptions& options) {
  const Index n = lattice_size(options.level, 6, 3 * 2 * 7.0 / 6 * 1.1);
  const Index m = n / 6 * 7;
  const TriangleRows rows(n);
  Points points(rows.first(m + 1), 3);
  for (Index j = 0; j <= m; ++j)
    for (Index i = 0; i < rows.row_size(j); ++i)
      points.row(rows.first(j) + i) << grade(rows.x(j, i), options.anisotropy), double(j) / m, 0;
  Csr faces;
  for (Index j = 0; j < m; ++j) rows.add_strip(j, faces);
  return jitter_vertices(PolygonMesh(std::move(points), std::move(faces)), kSquare, options);
}

}  // namespace carat
