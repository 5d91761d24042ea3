#include "carat/assembly/pattern.h"

#include <algorithm>
#include <limits>
#include <string>

#include "carat/assembly/row_pattern.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"

namespace carat {
void write_transposed(const std::vector<CollectedRows>& parts, const Array<Index>& sizes,
                      const Array<Index>& counts, int threads, SparseMatrix& pattern) {
  const Index n = static_cast<Index>(pattern.rows());
  Index* const columns = pattern.innerIndexPtr();
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    Array<Index> next(pattern.outerIndexPtr() + begin, pattern.outerIndexPtr() + end);
    const bool all = begin == 0 && end == n;
    for (const CollectedRows& part : parts) {
      const Index* column = part.columns.data();
      for (Index row = part.begin; row < part.end; column += sizes[row], ++row) {
        const Index* const last = column + counts[row];
        if (all) {
          for (const Index* c = column; c < last; ++c) columns[next[*c]++] = row;
        } else {
          for (const Index* c = column; c < last; ++c)
            if (*c >= begin && *c < end) columns[next[*c - begin]++] = row;
        }
      }
    }
  });
}

SparseMatrix allocate_rows(Index n_rows, Index n_cols, const Array<Index>& row_sizes,
                           const char* what) {
  SparseMatrix matrix(n_rows, n_cols);
  std::int64_t total = 0;
  for (const Index size : row_sizes) total += size;
  if (total > std::numeric_limits<Index>::max())
    throw InvalidMesh(std::string(what) + " would have " + std::to_string(total) +
                      " entries; at most " + std::to_string(std::numeric_limits<Index>::max()) +
                      " are supported; split the mesh or its largest faces");
  Index* const offsets = matrix.outerIndexPtr();
  offsets[0] = 0;
  for (Index row = 0; row < n_rows; ++row) offsets[row + 1] = offsets[row] + row_sizes[row];
  matrix.resizeNonZeros(total);
  advise_huge_pages(matrix.valuePtr(), static_cast<std::size_t>(total) * sizeof(double));
  advise_huge_pages(matrix.innerIndexPtr(), static_cast<std::size_t>(total) * sizeof(Index));
  return matrix;
}

SparseMatrix diagonal_pattern(Index n) {
  SparseMatrix matrix =
      allocate_rows(n, n, Array<Index>(static_cast<std::size_t>(n), 1), "a matrix");
  for (Index row = 0; row < n; ++row) matrix.innerIndexPtr()[row] = row;
  return matrix;
}

FaceRings face_rings(const SurfaceIncidence& mesh, int threads) {
  const Index n = mesh.faces.n_rows();
  FaceRings rings;
  rings.offsets.resize(static_cast<std::size_t>(n) + 1);
  const auto for_sides_across = [&](Index f, auto&& visit) {
    for (Index c = mesh.faces.begin(f); c < mesh.faces.end(f); ++c)
      for (const Index side : mesh.edge_corners.row(mesh.corner_edges[c]))
        if (side != c) visit(side);
  };
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      std::int64_t size = 0;
      for_sides_across(f,
                       [&](Index side) { size += mesh.faces.size(mesh.corner_faces[side]) - 2; });
      rings.offsets[f + 1] = size;
    }
  });
  rings.offsets[0] = 0;
  for (Index f = 0; f < n; ++f) rings.offsets[f + 1] += rings.offsets[f];
  rings.vertices.resize(static_cast<std::size_t>(rings.offsets[n]));
  parallel_blocks(n, threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      Index* out = rings.vertices.data() + rings.begin(f);
      for_sides_across(f, [&](Index side) {
        for_vertices_across(mesh, side, [&](Index c) { *out++ = mesh.faces.indices[c]; });
      });
    }
  });
  return rings;
}

SparseMatrix face_pattern(const SurfaceIncidence& mesh, int threads) {
  Array<Index> sizes, same;
  const std::vector<CollectedRows> rows = collect_rows(
      mesh.vertex_corners.n_rows(), threads, sizes, same, [&](Index row, RowCollector& out) {
        for (const Index corner : mesh.vertex_corners.row(row))
          for (const Index v : mesh.faces.row(mesh.corner_faces[corner])) out.add(v, row);
        return Index{0};
      });
  const Index n = mesh.vertex_corners.n_rows();
  SparseMatrix pattern = allocate_rows(n, n, sizes, "the matrix");
  write_transposed(rows, sizes, sizes, threads, pattern);
  return pattern;
}

DiamondPatterns diamond_patterns(const SurfaceIncidence& mesh, const FaceRings& rings,
                                 int threads) {
  Array<Index> sizes, mass_sizes;
  const std::vector<CollectedRows> rows = collect_rows(
      mesh.vertex_corners.n_rows(), threads, sizes, mass_sizes, [&](Index row, RowCollector& out) {
        const std::size_t before = out.columns.size();
        const std::span<const Index> corners = mesh.vertex_corners.row(row);
        for (const Index corner : corners)
          for (const Index v : mesh.faces.row(mesh.corner_faces[corner])) out.add(v, row);
        const std::size_t own = out.columns.size() - before;
        for (const Index corner : corners) {
          const Index f = mesh.corner_faces[corner];
          for (std::int64_t k = rings.begin(f); k < rings.end(f); ++k)
            out.add(rings.vertices[static_cast<std::size_t>(k)], row);
        }
        return static_cast<Index>(own);
      });
  const Index n = mesh.vertex_corners.n_rows();
  DiamondPatterns patterns{allocate_rows(n, n, sizes, "the diamond stiffness"),
                           allocate_rows(n, n, mass_sizes, "the diamond mass")};
  write_transposed(rows, sizes, sizes, threads, patterns.stiffness);
  write_transposed(rows, sizes, mass_sizes, threads, patterns.mass);
  return patterns;
}

}  // namespace carat
