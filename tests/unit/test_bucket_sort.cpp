#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "carat/base/bucket_sort.h"

namespace carat {
namespace {

TEST(BucketSort, keys_of_any_number_ascend) {
  std::mt19937 random(3);
  for (int repetition = 0; repetition < 200; ++repetition)
    for (Index n = 0; n <= 20; ++n) {
      std::vector<std::uint64_t> keys(static_cast<std::size_t>(n) + 1);
      // Few different ones, so that some are equal; the last is not part of them.
      for (std::uint64_t& key : keys)
        key = make_key(static_cast<Index>(random() % 7), random() % 3);
      std::vector<std::uint64_t> expected = keys;
      std::sort(expected.begin(), expected.end() - 1);
      sort_keys(keys.data(), n);
      EXPECT_EQ(keys, expected) << n;
    }
}

TEST(BucketSort, every_order_of_few_keys_is_sorted) {
  for (Index n = 1; n <= 8; ++n) {
    std::vector<std::uint64_t> order(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const std::vector<std::uint64_t> expected = order;
    do {
      std::vector<std::uint64_t> keys = order;
      sort_keys(keys.data(), n);
      ASSERT_EQ(keys, expected);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(BucketSort, keys_have_both_parts) {
  EXPECT_EQ(major_of(make_key(2147483647, 4000000000U)), 2147483647);
  EXPECT_EQ(minor_of(make_key(2147483647, 4000000000U)), 4000000000U);
  EXPECT_LT(make_key(1, 4000000000U), make_key(2, 0));
}

TEST(BucketSort, buckets_hold_their_keys_for_any_number_of_threads) {
  const Index n_buckets = 4000, n_items = 9000;  // enough to be split
  const auto items = [&](Index begin, Index end, auto&& emit) {
    for (Index i = begin; i < end; ++i)
      for (Index k = 0; k < i % 3; ++k)
        emit(static_cast<Index>((std::int64_t{i} * 7919 + k * 31) % (n_buckets - 5)),
             make_key((i * 13 + k) % 101, static_cast<std::uint32_t>(i)));
  };
  std::vector<std::vector<std::uint64_t>> expected(static_cast<std::size_t>(n_buckets));
  items(0, n_items, [&](Index bucket, std::uint64_t key) { expected[bucket].push_back(key); });
  for (const int threads : {1, 2, 5}) {
    const Buckets buckets = sort_into_buckets(n_buckets, n_items, threads, items);
    ASSERT_EQ(buckets.offsets.size(), expected.size() + 1);
    for (Index b = 0; b < n_buckets; ++b) {
      std::vector<std::uint64_t> sorted = expected[b];
      std::sort(sorted.begin(), sorted.end());
      EXPECT_TRUE(std::equal(sorted.begin(), sorted.end(),
                             buckets.keys.begin() + buckets.offsets[b],
                             buckets.keys.begin() + buckets.offsets[b + 1]));
    }
  }
  EXPECT_EQ(sort_into_buckets(3, 0, 2, items).offsets, (Array<Index>{0, 0, 0, 0}));
}

}  // namespace
}  // namespace carat
