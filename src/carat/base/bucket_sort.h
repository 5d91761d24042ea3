#pragma once
// Sorting by counting: keys into buckets, and the few of every bucket by a fixed network.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "carat/base/parallel.h"
#include "carat/base/types.h"

namespace carat {

/// Bucket b holds keys[offsets[b] .. offsets[b + 1]), ascending.
struct Buckets {
  Array<Index> offsets;
  Array<std::uint64_t> keys;
};

/// A key that sorts by `major`, then by `minor`.
inline std::uint64_t make_key(Index major, std::uint32_t minor) {
  return static_cast<std::uint64_t>(major) << 32 | minor;
}
inline Index major_of(std::uint64_t key) { return static_cast<Index>(key >> 32); }
inline std::uint32_t minor_of(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

/// Where the items of every block go when blocks of items are sorted by counting: next[t][b] is the
/// first place of bucket b for block t, behind what the blocks before it bring.
using BlockPlaces = std::vector<Array<Index>>;

/// Turns counts a block and bucket into places; `offsets` gets n_buckets + 1 entries.
/// The total must be below 2^31.
inline void counts_to_places(Index n_buckets, BlockPlaces& counts, Array<Index>& offsets) {
  std::erase_if(counts, [](const Array<Index>& block) { return block.empty(); });
  offsets.resize(static_cast<std::size_t>(n_buckets) + 1);
  Index total = 0;
  for (Index b = 0; b < n_buckets; ++b) {
    offsets[b] = total;
    for (Array<Index>& block : counts) {
      const Index count = block[b];
      block[b] = total;
      total += count;
    }
  }
  offsets[n_buckets] = total;
}

/// Sorts n >= 0 keys. Few keys, of which there are many lots, without a branch that depends on
/// them.
inline void sort_keys(std::uint64_t* keys, Index n) {
  constexpr Index kNetwork = 8;
  if (n > kNetwork) {
    std::sort(keys, keys + n);
    return;
  }
  const auto order = [](std::uint64_t& a, std::uint64_t& b) {
    const std::uint64_t low = std::min(a, b), high = std::max(a, b);
    a = low;
    b = high;
  };
  if (n < 3) {
    if (n == 2) order(keys[0], keys[1]);
    return;
  }
  std::uint64_t k[kNetwork];
  for (Index i = 0; i < kNetwork; ++i)
    k[i] = i < n ? keys[i] : std::numeric_limits<std::uint64_t>::max();
  // Batcher's odd-even merge sort of four, then of eight.
  order(k[0], k[1]), order(k[2], k[3]), order(k[0], k[2]), order(k[1], k[3]), order(k[1], k[2]);
  if (n > 4) {
    order(k[4], k[5]), order(k[6], k[7]), order(k[4], k[6]), order(k[5], k[7]), order(k[5], k[6]);
    order(k[0], k[4]), order(k[1], k[5]), order(k[2], k[6]), order(k[3], k[7]);
    order(k[2], k[4]), order(k[3], k[5]);
    order(k[1], k[2]), order(k[3], k[4]), order(k[5], k[6]);
  }
  for (Index i = 0; i < n; ++i) keys[i] = k[i];
}

/// Keys of all items by bucket, ascending in each.
/// \param for_items  for_items(begin, end, emit) calls emit(bucket, key) for the keys of the items
///                   [begin, end), twice the same ones; less than 2^31 in all
/// Cost: linear where buckets are small.
template <class ForItems>
Buckets sort_into_buckets(Index n_buckets, Index n_items, int threads, const ForItems& for_items) {
  Buckets result;
  BlockPlaces next(static_cast<std::size_t>(resolve_threads(threads)));
  parallel_blocks(n_items, threads, [&](int block, Index begin, Index end) {
    Array<Index>& counts = next[static_cast<std::size_t>(block)];
    counts.assign(static_cast<std::size_t>(n_buckets) + 1, 0);  // never empty
    for_items(begin, end, [&](Index bucket, std::uint64_t) { ++counts[bucket]; });
  });
  counts_to_places(n_buckets, next, result.offsets);
  result.keys.resize(static_cast<std::size_t>(result.offsets[n_buckets]));
  parallel_blocks(n_items, threads, [&](int block, Index begin, Index end) {
    Index* const place = next[static_cast<std::size_t>(block)].data();
    std::uint64_t* const keys = result.keys.data();
    for_items(begin, end, [&](Index bucket, std::uint64_t key) { keys[place[bucket]++] = key; });
  });
  parallel_blocks(n_buckets, threads, [&](int, Index begin, Index end) {
    for (Index b = begin; b < end; ++b)
      sort_keys(result.keys.data() + result.offsets[b], result.offsets[b + 1] - result.offsets[b]);
  });
  return result;
}

}  // namespace carat
