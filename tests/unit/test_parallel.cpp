#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "carat/base/parallel.h"

namespace carat {
namespace {

TEST(Parallel, blocks_cover_the_range_once) {
  for (const Index n : {0, 1, 5, 2047, 2048, 5001})
    for (const int threads : {1, 2, 3, 8}) {
      std::vector<int> visits(static_cast<std::size_t>(n), 0);
      parallel_blocks(n, threads, [&](int, Index begin, Index end) {
        for (Index i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(n), 1));
    }
}

TEST(Parallel, the_exception_of_the_lowest_block_arrives) {
  for (const int threads : {1, 4}) {
    try {
      parallel_blocks(10000, threads, [&](int block, Index, Index) {
        if (block > 0 || threads == 1) throw std::runtime_error(std::to_string(block));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), threads == 1 ? "0" : "1");
    }
  }
}

TEST(Parallel, requested_threads_win) {
  EXPECT_EQ(resolve_threads(3), 3);
  EXPECT_EQ(resolve_threads(1000000000), 1024);
  EXPECT_GE(resolve_threads(0), 1);
  EXPECT_GE(resolve_threads(-2), 1);
}

TEST(Parallel, tasks_are_done_once_each) {
  for (const Index n : {0, 1, 7, 100})
    for (const int threads : {1, 2, 5}) {
      std::vector<int> visits(static_cast<std::size_t>(n), 0);
      parallel_tasks(n, threads, [&](Index task) { ++visits[task]; });
      EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(n), 1));
    }
}

TEST(Parallel, the_exception_of_the_lowest_task_arrives) {
  for (const int threads : {1, 4}) {
    try {
      parallel_tasks(20, threads, [](Index task) {
        if (task > 4) throw std::runtime_error(std::to_string(task));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "5");
    }
  }
}

}  // namespace
}  // namespace carat
