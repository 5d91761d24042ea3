#include "carat/distributed/number_exchange.h"
#include "parts.h"

namespace carat::test {
namespace {

// Process p holds the numbers 10 p, 10 p + 10 and 5, the largest first.
NumberExchange example() {
  return NumberExchange(std::vector<std::int64_t>{10 * (rank() + 1), 10 * rank(), 5});
}

int n_holders(int which) { return which == 0 || which == n_processes() ? 1 : 2; }

TEST(NumberExchange, sums_over_all_that_hold_a_number) {
  Matrix values(3, 2);
  values << 1, 10, 1, 10, rank(), 1;
  const Matrix sums = example().sum(values);
  const int n = n_processes();
  EXPECT_EQ(sums(0, 0), n_holders(rank() + 1));
  EXPECT_EQ(sums(1, 1), 10 * n_holders(rank()));
  EXPECT_EQ(sums(2, 0), n * (n - 1) / 2);
  EXPECT_EQ(sums(2, 1), n);
}

TEST(NumberExchange, finds_the_least) {
  const std::vector<std::int64_t> least =
      example().least({100 - rank(), 100 - rank(), std::int64_t{-1} - rank()});
  EXPECT_EQ(least[0], 100 - std::min(rank() + 1, n_processes() - 1));
  EXPECT_EQ(least[1], 100 - rank());
  EXPECT_EQ(least[2], -n_processes());
}

TEST(NumberExchange, sums_what_comes_before) {
  // Every number counts once: 0, 5, 10, 20, ... with the values 1, 7, 1, 1, ...
  std::int64_t total = 0;
  const std::vector<std::int64_t> before = example().sums_before({1, 1, 7}, total);
  EXPECT_EQ(total, n_processes() + 1 + 7);
  EXPECT_EQ(before[0], rank() + 8);
  EXPECT_EQ(before[1], rank() == 0 ? 0 : rank() + 7);
  EXPECT_EQ(before[2], 1);
}

TEST(NumberExchange, some_or_all_hold_nothing) {
  const NumberExchange nobody(std::vector<std::int64_t>{});
  EXPECT_EQ(nobody.sum(Matrix(0, 3)).rows(), 0);
  std::vector<std::int64_t> mine;
  if (rank() == 0) mine = {std::int64_t{1} << 60};
  EXPECT_EQ(NumberExchange(mine).least(mine), mine);
}

}  // namespace
}  // namespace carat::test
