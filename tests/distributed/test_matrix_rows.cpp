#include "carat/distributed/matrix_rows.h"
#include "parts.h"

namespace carat::test {
namespace {

TEST(MatrixRows, the_first_process_visits_the_sum_in_order) {
  // Everybody brings the whole 7 x 5 matrix, last row first, and its diagonal once more.
  std::vector<MatrixEntry> entries;
  for (std::int64_t row = 6; row >= 0; --row)
    for (std::int64_t column = 0; column < 5; ++column)
      entries.push_back({row, column, 10.0 * static_cast<double>(row) + rank()});
  for (std::int64_t k = 0; k < 5; ++k) entries.push_back({k, k, 0.5});
  const MatrixRows matrix(entries, 7);
  EXPECT_EQ(matrix.n_entries(), 35);
  std::int64_t next = 0;
  const int n = n_processes();
  matrix.visit([&](const MatrixEntry& entry) {
    EXPECT_EQ(entry.row * 5 + entry.column, next++);
    EXPECT_DOUBLE_EQ(entry.value, n * (10.0 * static_cast<double>(entry.row) + (n - 1) / 2.0 +
                                       (entry.row == entry.column ? 0.5 : 0.0)));
  });
  EXPECT_EQ(next, rank() == 0 ? 35 : 0);
}

TEST(MatrixRows, may_be_empty) {
  const MatrixRows matrix({}, 0);
  EXPECT_EQ(matrix.n_entries(), 0);
  matrix.visit([](const MatrixEntry&) { FAIL(); });
}

}  // namespace
}  // namespace carat::test
