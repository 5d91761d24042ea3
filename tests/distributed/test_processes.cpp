#include "carat/distributed/processes.h"
#include "parts.h"

namespace carat::test {
namespace {

TEST(Processes, an_error_of_one_is_thrown_by_all) {
  const int last = n_processes() - 1;
  try {
    together([&] {
      if (rank() == last) throw InvalidMesh("face 3 is bad");
    });
    FAIL();
  } catch (const InvalidMesh& error) {
    EXPECT_NE(dynamic_cast<const SharedFailure*>(&error), nullptr);
    const std::string who = "process " + std::to_string(last) + ": ";
    EXPECT_EQ(error.what(), (last > 0 ? who : "") + "face 3 is bad");
  }
  // Of several the lowest is heard, and the job goes on.
  EXPECT_THROW(together([&] { throw SolverFailure(std::to_string(rank())); }),
               Shared<SolverFailure>);
  EXPECT_THROW(together([] { throw std::bad_alloc(); }), Shared<OutOfMemory>);
  EXPECT_NO_THROW(together([] {}));
}

TEST(Processes, errors_keep_their_elements_and_name_a_process_only_where_others_are_well) {
  try {
    together([] { throw DegenerateElement("all", {3, 5}); });
    FAIL();
  } catch (const DegenerateElement& error) {
    EXPECT_EQ(error.what(), std::string("all"));
    EXPECT_EQ(error.elements(), (std::vector<Index>{3, 5}));
  }
}

TEST(Processes, the_first_may_work_alone) {
  int n_runs = 0;
  on_first([&] { ++n_runs; });
  EXPECT_EQ(n_runs, rank() == 0 ? 1 : 0);
  try {
    on_first([] { throw IoError("no file", {7}); });
    FAIL();
  } catch (const Shared<IoError>& error) {
    EXPECT_EQ(error.what(), std::string("no file"));
    EXPECT_EQ(error.elements(), std::vector<Index>{7});
  }
}

TEST(Processes, programs_end_with_one_description) {
  int described = 0;
  const int code = run_processes(
      []() -> int {
        together([] { throw InvalidOption("no"); });
        return 0;
      },
      [&](const std::exception&) {
        ++described;
        return 2;
      });
  EXPECT_EQ(code, 2);
  EXPECT_EQ(described, rank() == 0 ? 1 : 0);
  EXPECT_EQ(run_processes([] { return 7; }, [](const std::exception&) { return 1; }), 7);
}

TEST(Processes, sums_and_maxima_are_of_all) {
  const int n = n_processes();
  EXPECT_EQ(sum_of_all(1.0), n);
  EXPECT_EQ(sum_of_all(std::int64_t{rank()}), n * (n - 1) / 2);
  EXPECT_EQ(sum_of_all(std::vector<double>{1, 2}), (std::vector<double>{1.0 * n, 2.0 * n}));
  EXPECT_EQ(sum_of_all(std::vector<std::int64_t>{1, 2}), (std::vector<std::int64_t>{n, 2 * n}));
  EXPECT_EQ(largest_of_all(static_cast<double>(rank())), n - 1);
}

TEST(Processes, counts_beyond_the_indices_are_refused) {
  EXPECT_NO_THROW(require_countable("entries", 2147483647, 2147483647));
  try {
    require_countable("entries", 2147483648, 2147483647);
    FAIL();
  } catch (const InvalidOption& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("2147483648 entries"), std::string::npos) << message;
    EXPECT_NE(message.find("64-bit"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace carat::test
