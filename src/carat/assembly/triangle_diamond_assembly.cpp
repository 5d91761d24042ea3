#include "carat/assembly/triangle_diamond_assembly.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "carat/base/bucket_sort.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

/// Pairs of vertices that couple, in buckets by the lower one, there by the upper one and then by
/// the number of the value: that of the edge, or n_edges + edge for the opposite vertices.
Buckets coupled_pairs(const TriangleIncidence& mesh, int threads) {
  const Index n_edges = mesh.edge_corners.n_rows();
  const Array<Index>& vertices = mesh.faces.indices;
  return sort_into_buckets(
      mesh.n_vertices, n_edges, threads, [&](Index begin, Index end, auto&& emit) {
        for (Index e = begin; e < end; ++e) {
          const auto value = static_cast<std::uint32_t>(e);
          emit(mesh.edge_vertices[e][0], make_key(mesh.edge_vertices[e][1], value));
          const Index first = mesh.edge_corners.begin(e);
          if (mesh.edge_corners.size(e) < 2) continue;
          const Index l = vertices[triangle_neighbours(mesh.edge_corners.indices[first]).previous];
          const Index r =
              vertices[triangle_neighbours(mesh.edge_corners.indices[first + 1]).previous];
          if (l == r) continue;  // u_l - u_r vanishes
          emit(std::min(l, r),
               make_key(std::max(l, r), value + static_cast<std::uint32_t>(n_edges)));
        }
      });
}

/// What every block of lower vertices brings.
struct BlockSums {
  Index first = 0;  // number of its first sum
  std::vector<std::vector<std::uint32_t>> sums;
};

}  // namespace

bool has_triangle_diamonds(const TriangleIncidence& mesh, int threads) {
  const Index n_edges = mesh.edge_corners.n_rows();
  if (n_edges >= std::numeric_limits<Index>::max() / 2) return false;
  std::atomic<bool> fits{true};
  parallel_blocks(n_edges, threads, [&](int, Index begin, Index end) {
    bool all = true;
    for (Index e = begin; e < end; ++e) {
      const Index first = mesh.edge_corners.begin(e), size = mesh.edge_corners.size(e);
      const Index last = first + std::min(size, 2) - 1;
      const Array<Index>& corners = mesh.edge_corners.indices;
      all &= size == 1 ||
             (size == 2 && mesh.faces.indices[corners[first]] != mesh.faces.indices[corners[last]]);
    }
    if (!all) fits = false;
  });
  return fits;
}

TriangleDiamondPatterns triangle_diamond_patterns(const TriangleIncidence& mesh, int threads) {
  const Index n = mesh.n_vertices, n_edges = mesh.edge_corners.n_rows();
  const auto edge_values = static_cast<std::uint32_t>(n_edges);
  const Buckets pairs = coupled_pairs(mesh, threads);

  // Row i: what lower vertices bring in their order, the diagonal, what i brings.
  const auto blocks = static_cast<std::size_t>(resolve_threads(threads));
  BlockPlaces to_stiffness(blocks), to_mass(blocks);
  std::vector<BlockSums> block_sums(blocks);
  Array<Index> own(static_cast<std::size_t>(n)), own_mass(static_cast<std::size_t>(n));
  parallel_blocks(n, threads, [&](int block, Index begin, Index end) {
    const auto t = static_cast<std::size_t>(block);
    to_stiffness[t].assign(static_cast<std::size_t>(n) + 1, 0);
    to_mass[t].assign(static_cast<std::size_t>(n) + 1, 0);
    Index* const stiffness = to_stiffness[t].data();
    Index* const mass = to_mass[t].data();
    Index n_repeated = 0;
    for (Index i = begin; i < end; ++i) {
      Index previous = -1, n_own = 0, n_edge = 0;
      bool repeated = false;
      for (Index k = pairs.offsets[i]; k < pairs.offsets[i + 1]; ++k) {
        const Index j = major_of(pairs.keys[k]);
        const auto fresh = static_cast<Index>(j != previous);
        const auto edge = static_cast<Index>(minor_of(pairs.keys[k]) < edge_values);
        n_repeated += static_cast<Index>(fresh == 0 && !repeated);
        repeated = fresh == 0;
        n_own += fresh;
        n_edge += edge;
        stiffness[j] += fresh;
        mass[j] += edge;
        previous = j;
      }
      own[i] = n_own;
      own_mass[i] = n_edge;
    }
    block_sums[t].first = n_repeated;
  });
  const auto row_sizes = [&](BlockPlaces& below, Array<Index>& own_sizes) {
    std::erase_if(below, [](const Array<Index>& block) { return block.empty(); });
    Array<Index> sizes(static_cast<std::size_t>(n));
    parallel_blocks(n, threads, [&](int, Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        Index size = own_sizes[i];
        for (const Array<Index>& block : below) size += block[i];
        sizes[i] = size > 0 ? size + 1 : 0;
      }
    });
    return sizes;
  };
  TriangleDiamondPatterns result{
      {allocate_rows(n, n, row_sizes(to_stiffness, own), "the diamond stiffness"),
       allocate_rows(n, n, row_sizes(to_mass, own_mass), "the diamond mass")},
      {}};
  SparseMatrix& stiffness = result.patterns.stiffness;
  SparseMatrix& mass = result.patterns.mass;
  TriangleDiamondSources& sources = result.sources;

  // Counts become places; `own` becomes the place of the diagonal.
  const auto set_places = [&](BlockPlaces& below, const SparseMatrix& matrix,
                              const Array<Index>& own_sizes, Array<Index>& diagonal) {
    diagonal.resize(static_cast<std::size_t>(n));
    const Index* const offsets = matrix.outerIndexPtr();
    parallel_blocks(n, threads, [&](int, Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        Index place = offsets[i];
        for (Array<Index>& block : below) place += std::exchange(block[i], place);
        diagonal[i] = offsets[i] == offsets[i + 1] ? -1 : offsets[i + 1] - own_sizes[i] - 1;
      }
    });
  };
  set_places(to_stiffness, stiffness, own, sources.stiffness_diagonal);
  set_places(to_mass, mass, own_mass, sources.mass_diagonal);
  Index n_sums = 0;
  for (BlockSums& block : block_sums) n_sums += std::exchange(block.first, n_sums);

  sources.stiffness.resize(static_cast<std::size_t>(stiffness.nonZeros()));
  sources.vertex_edges.offsets.assign(mass.outerIndexPtr(), mass.outerIndexPtr() + n + 1);
  sources.vertex_edges.indices.resize(static_cast<std::size_t>(mass.nonZeros()));
  const std::uint32_t zero = 2 * edge_values + static_cast<std::uint32_t>(n_sums);
  parallel_blocks(n, threads, [&](int block, Index begin, Index end) {
    const auto t = static_cast<std::size_t>(block);
    Index* const next = to_stiffness[t].data();
    Index* const next_mass = to_mass[t].data();
    Index* const columns = stiffness.innerIndexPtr();
    Index* const mass_columns = mass.innerIndexPtr();
    std::uint32_t* const values = sources.stiffness.data();
    Index* const edges = sources.vertex_edges.indices.data();
    for (Index i = begin; i < end; ++i) {
      Index place = sources.stiffness_diagonal[i], mass_place = sources.mass_diagonal[i];
      if (place < 0) continue;
      columns[place] = mass_columns[mass_place] = i;
      values[place++] = zero;
      edges[mass_place++] = n_edges;
      Index previous = -1;
      for (Index k = pairs.offsets[i]; k < pairs.offsets[i + 1]; ++k) {
        const Index j = major_of(pairs.keys[k]);
        const std::uint32_t value = minor_of(pairs.keys[k]);
        if (value < edge_values) {
          mass_columns[mass_place] = j;
          edges[mass_place++] = static_cast<Index>(value);
          const Index at = next_mass[j]++;
          mass_columns[at] = i;
          edges[at] = static_cast<Index>(value);
        }
        if (j == previous) {
          std::vector<std::vector<std::uint32_t>>& sums = block_sums[t].sums;
          std::uint32_t& entry = values[place - 1];
          if (entry < 2 * edge_values) {
            sums.push_back({entry});
            entry = 2 * edge_values +
                    static_cast<std::uint32_t>(block_sums[t].first + Index(sums.size()) - 1);
            values[next[j] - 1] = entry;
          }
          sums.back().push_back(value);
          continue;
        }
        previous = j;
        columns[place] = j;
        values[place++] = value;
        const Index at = next[j]++;
        columns[at] = i;
        values[at] = value;
      }
    }
  });
  for (BlockSums& block : block_sums)
    std::move(block.sums.begin(), block.sums.end(), std::back_inserter(sources.sums));
  for (Index e = 0; e < n_edges; ++e)
    if (mesh.edge_corners.size(e) == 1) sources.boundary_edges.push_back(e);
  return result;
}

void TriangleDiamondTerms::resize(Index n_edges, Index n_corners, bool split,
                                  const TriangleDiamondSources& sources) {
  const auto n = static_cast<std::size_t>(n_edges);
  around.resize(split ? 0 : n + 1);
  halves.resize(split ? static_cast<std::size_t>(n_corners) : 0);
  ends.resize(split ? n : 0);
  values.resize(2 * n + sources.sums.size() + 1);
  mass.resize(n + 1);
}

namespace {

/// The values of edges: what the sides around them add.
template <bool kHalves>
void add_sides(const TriangleIncidence& mesh, Index begin, Index end, TriangleDiamondTerms& terms) {
  [[maybe_unused]] const Index* const of_corner = mesh.corner_edges.data();
  [[maybe_unused]] const TriangleDiamondTerms::Around* const around = terms.around.data();
  for (Index e = begin; e < end; ++e) {
    double value = terms.values[e], mass = 0;
    for (Index k = mesh.edge_corners.begin(e); k < mesh.edge_corners.end(e); ++k) {
      const Index corner = mesh.edge_corners.indices[k];
      const TriangleCorners corners = triangle_neighbours(corner);
      if constexpr (kHalves) {
        const auto& next = terms.halves[corners.next];
        const auto& previous = terms.halves[corners.previous];
        value += next.start + previous.end;
        // In one order for all edges of the face.
        const Index first = corner - corner % 3;
        mass += terms.halves[first].tip + terms.halves[first + 1].tip + terms.halves[first + 2].tip;
      } else {
        const auto& next = around[of_corner[corners.next]];
        const auto& previous = around[of_corner[corners.previous]];
        value += next.beta - previous.beta;
        mass += next.share + previous.share + around[e].share;
      }
    }
    terms.values[e] = value;
    terms.mass[e] = mass;
  }
}

/// At the boundary p_r is half of both ends instead of the mean of a triangle.
void add_boundary(const TriangleIncidence& mesh, const TriangleDiamondSources& sources,
                  Array<double>& values) {
  const Index n_edges = mesh.edge_corners.n_rows();
  for (const Index e : sources.boundary_edges) {
    const double coupling = values[n_edges + e];
    const TriangleCorners corners = triangle_neighbours(mesh.edge_corners.row(e)[0]);
    values[e] -= coupling / 4;
    values[mesh.corner_edges[corners.next]] += coupling / 2;
    values[mesh.corner_edges[corners.previous]] += coupling / 2;
  }
}

void fill_stiffness(SparseMatrix& matrix, const TriangleDiamondSources& sources, Index begin,
                    Index end, const Array<double>& values) {
  const Index* const offsets = matrix.outerIndexPtr();
  double* const out = matrix.valuePtr();
  for (Index row = begin; row < end; ++row) {
    double sum = 0;
    for (Index k = offsets[row]; k < offsets[row + 1]; ++k) {
      const double value = values[sources.stiffness[k]];
      out[k] = value;
      sum += value;
    }
    if (sources.stiffness_diagonal[row] >= 0) out[sources.stiffness_diagonal[row]] = -sum;
  }
}

template <bool kHalves>
void fill_mass(SparseMatrix& matrix, bool lumped, [[maybe_unused]] const TriangleIncidence& mesh,
               const TriangleDiamondSources& sources, Index begin, Index end,
               const TriangleDiamondTerms& terms) {
  double* const out = matrix.valuePtr();
  for (Index row = begin; row < end; ++row) {
    // A face adds the same to the two edges at the vertex and to the vertex.
    double edges = 0, shares = 0;
    for (Index k = sources.vertex_edges.begin(row); k < sources.vertex_edges.end(row); ++k) {
      const Index e = sources.vertex_edges.indices[k];
      const double value = terms.mass[e];
      if (!lumped) out[k] = value;
      edges += value;
      if constexpr (!kHalves)
        shares += terms.around[e].share;
      else if (k != sources.mass_diagonal[row])
        shares += terms.ends[e][mesh.edge_vertices[e][0] == row ? 0 : 1];
    }
    const double diagonal = edges / 2 + (kHalves ? shares : 9 * shares);
    if (lumped)
      out[row] = edges + diagonal;
    else if (sources.mass_diagonal[row] >= 0)
      out[sources.mass_diagonal[row]] = diagonal;
  }
}

}  // namespace

void assemble_triangle_diamonds(SparseMatrix& stiffness, SparseMatrix& mass, bool lumped_mass,
                                const TriangleIncidence& mesh,
                                const TriangleDiamondSources& sources, int threads,
                                TriangleDiamondTerms& terms) {
  const Index n_edges = mesh.edge_corners.n_rows();
  const bool halves = terms.around.empty();  // also without a face, which has no halves
  parallel_blocks(n_edges, threads, [&](int, Index begin, Index end) {
    halves ? add_sides<true>(mesh, begin, end, terms) : add_sides<false>(mesh, begin, end, terms);
  });
  add_boundary(mesh, sources, terms.values);
  double* sum = terms.values.data() + 2 * static_cast<std::size_t>(n_edges);
  for (const std::vector<std::uint32_t>& members : sources.sums) {
    *sum = 0;
    for (const std::uint32_t member : members) *sum += terms.values[member];
    ++sum;
  }
  *sum = 0;
  terms.mass[n_edges] = 0;
  if (!halves) terms.around[n_edges] = {0, 0};
  parallel_blocks(static_cast<Index>(stiffness.rows()), threads, [&](int, Index begin, Index end) {
    fill_stiffness(stiffness, sources, begin, end, terms.values);
    if (halves)
      fill_mass<true>(mass, lumped_mass, mesh, sources, begin, end, terms);
    else
      fill_mass<false>(mass, lumped_mass, mesh, sources, begin, end, terms);
  });
}

}  // namespace carat
