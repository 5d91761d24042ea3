// Matrix Market files hold what the matrix holds.

#include <limits>
#include <sstream>

#include "carat/base/error.h"
#include "carat/io/matrix_market.h"
#include "io_support.h"

namespace carat::test {
namespace {

SparseMatrix sample() {
  SparseMatrix matrix(3, 3);
  matrix.insert(0, 0) = 0.1;
  matrix.insert(0, 2) = -1.0 / 3;
  matrix.insert(1, 1) = 5e-324;
  matrix.insert(2, 0) = -1.0 / 3;
  matrix.insert(2, 2) = 1e300;
  matrix.makeCompressed();
  return matrix;
}

TEST(MatrixMarket, WritesAllEntriesOfAGeneralMatrix) {
  const TemporaryFolder folder;
  write_matrix_market(folder / "a.mtx", sample(), MatrixSymmetry::General, "stiffness\nof a test");
  EXPECT_EQ(read_bytes(folder / "a.mtx"),
            "%%MatrixMarket matrix coordinate real general\n% stiffness\n% of a test\n3 3 5\n"
            "1 1 0.1\n1 3 -0.3333333333333333\n2 2 5e-324\n3 1 -0.3333333333333333\n3 3 1e+300\n");
  EXPECT_EQ(folder.n_files(), 1u);
}

TEST(MatrixMarket, TakesEntriesOneAfterTheOther) {
  const TemporaryFolder folder;
  const auto write = [&](std::int64_t n_entries) {
    write_matrix_market(folder / "a.mtx", 3'000'000'000, 2, n_entries, MatrixSymmetry::General, "G",
                        [](const PutEntry& put) {
                          put(0, 1, 0.5);
                          put(2'999'999'999, 0, -1);
                        });
  };
  write(2);
  const std::string expected =
      "%%MatrixMarket matrix coordinate real general\n% G\n3000000000 2 2\n"
      "1 2 0.5\n3000000000 1 -1\n";
  EXPECT_EQ(read_bytes(folder / "a.mtx"), expected);
  EXPECT_THROW(write(3), InvalidOption);
  EXPECT_EQ(read_bytes(folder / "a.mtx"), expected);
  EXPECT_EQ(folder.n_files(), 1u);
}

TEST(MatrixMarket, WritesTheLowerTriangleOfASymmetricMatrix) {
  const TemporaryFolder folder;
  write_matrix_market(folder / "a.mtx", sample(), MatrixSymmetry::Symmetric);
  EXPECT_EQ(read_bytes(folder / "a.mtx"),
            "%%MatrixMarket matrix coordinate real symmetric\n3 3 4\n"
            "1 1 0.1\n2 2 5e-324\n3 1 -0.3333333333333333\n3 3 1e+300\n");
}

TEST(MatrixMarket, ReadsBackBitByBit) {
  const TemporaryFolder folder;
  SparseMatrix matrix(40, 7);
  for (Index i = 0; i < 40; ++i)
    matrix.insert(i, i % 7) = std::sin(1.0 + i) * std::pow(10.0, i - 20);
  matrix.makeCompressed();
  write_matrix_market(folder / "a.mtx", matrix);
  std::istringstream in(read_bytes(folder / "a.mtx"));
  std::string line;
  std::getline(in, line);
  Index rows = 0, columns = 0, entries = 0;
  in >> rows >> columns >> entries;
  EXPECT_EQ(rows, 40);
  EXPECT_EQ(columns, 7);
  ASSERT_EQ(entries, 40);
  for (Index i = 0; i < entries; ++i) {
    Index row = 0, column = 0;
    std::string value;
    in >> row >> column >> value;
    EXPECT_EQ(row, i + 1);
    EXPECT_EQ(column, i % 7 + 1);
    EXPECT_EQ(std::stod(value), matrix.coeff(row - 1, column - 1));
  }
}

TEST(MatrixMarket, RefusesWhatTheFormatCannotHold) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_matrix_market(folder / "a.mtx", SparseMatrix(2, 3), MatrixSymmetry::Symmetric),
               InvalidOption);
  SparseMatrix matrix = sample();
  matrix.coeffRef(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_matrix_market(folder / "a.mtx", matrix), InvalidOption);
  EXPECT_THROW(write_matrix_market(folder / "no/a.mtx", sample()), IoError);
  EXPECT_EQ(folder.n_files(), 0u);
}

}  // namespace
}  // namespace carat::test
