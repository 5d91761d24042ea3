// .npy files hold the rows in the order in which they come.

#include <cstring>
#include <limits>
#include <string>

#include "carat/base/error.h"
#include "carat/io/npy.h"
#include "io_support.h"

namespace carat::test {
namespace {

TEST(Npy, HoldsAHeaderAndTheRows) {
  const TemporaryFolder folder;
  const Vector first{{0.1, -2, std::numeric_limits<double>::infinity()}};
  const Vector second{{5e-324, 1e300, -0.0}};
  write_npy(folder / "a.npy", 2, 3, [&](const PutRow& put) {
    put(first);
    put(second);
  });
  const std::string bytes = read_bytes(folder / "a.npy");
  const std::string dictionary = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
  ASSERT_EQ(bytes.size(), 128u + 6 * sizeof(double));
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(bytes.substr(10, 118), dictionary + std::string(117 - dictionary.size(), ' ') + "\n");
  double values[6];
  std::memcpy(values, bytes.data() + 128, sizeof values);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(values[k], first[k]);
    EXPECT_EQ(values[3 + k], second[k]);
  }
  EXPECT_EQ(folder.n_files(), 1u);
}

TEST(Npy, LeavesNothingBehindWhenItFails) {
  const TemporaryFolder folder;
  const auto refuse = [&](Index rows, const std::function<void(const PutRow&)>& produce) {
    EXPECT_THROW(write_npy(folder / "a.npy", rows, 2, produce), InvalidOption);
  };
  const Vector row = Vector::Ones(2);
  refuse(2, [&](const PutRow& put) { put(row); });
  refuse(1, [&](const PutRow& put) {
    put(row);
    put(row);
  });
  refuse(1, [&](const PutRow& put) { put(Vector::Ones(3)); });
  refuse(1, [&](const PutRow&) { throw InvalidOption("what went wrong"); });
  // 32 exabytes
  EXPECT_THROW(write_npy(folder / "a.npy", std::numeric_limits<Index>::max(),
                         std::numeric_limits<Index>::max(), [](const PutRow&) {}),
               IoError);
  EXPECT_THROW(write_npy(folder / "none" / "a.npy", 1, 2, [&](const PutRow& put) { put(row); }),
               IoError);
  EXPECT_EQ(folder.n_files(), 0u);
}

}  // namespace
}  // namespace carat::test
