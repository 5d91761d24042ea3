// Runs the tests in every process of the job; it succeeds if all do. With --one-process-fails the
// last process throws while the others wait for it: the job must end.

#include <gtest/gtest.h>

#include <cstring>
#include <iostream>

#include "carat/distributed/processes.h"

namespace {

int fail_in_one(const carat::Processes& processes) {
  return carat::run_processes(
      [&]() -> int {
        if (processes.rank() + 1 == processes.size()) throw std::runtime_error("cannot go on");
        for (;;) carat::sum_of_all(1.0);
      },
      [](const std::exception& error) {
        std::cout << "one process says: " << error.what() << std::endl;
        return 4;
      });
}

}  // namespace

int main(int argc, char** argv) {
  const carat::Processes processes({argv, argv + argc});
  if (argc > 1 && std::strcmp(argv[1], "--one-process-fails") == 0) return fail_in_one(processes);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
