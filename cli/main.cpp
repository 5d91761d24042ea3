// The program carat, which solves by itself.

#include <algorithm>

#include "cli/engine.h"
#include "cli/failure.h"

int main(int argc, char** argv) {
  try {
    return carat::cli::run_program({argv + std::min(argc, 1), argv + argc}, nullptr);
  } catch (const std::exception& error) {
    return carat::cli::report_failure(carat::cli::describe_failure(error), false);
  }
}
