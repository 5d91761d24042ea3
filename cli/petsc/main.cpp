// The program carat-petsc: carat with an engine over all processes of an MPI job.

#include <string>
#include <vector>

#include "carat/distributed/processes.h"
#include "cli/failure.h"
#include "cli/petsc/part_engine.h"

namespace carat::cli {
namespace {

/// Options of PETSc, -ksp_type and the like, have one dash and an underscore.
bool is_petsc_option(const std::string& argument) {
  if (argument.size() < 2 || argument[0] != '-') return false;
  const std::string name = argument.substr(1);
  return name.find('_') != std::string::npos && name[0] >= 'a' && name[0] <= 'z' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

/// The arguments without PETSc's options and their values.
std::vector<std::string> own_arguments(int argc, char** argv) {
  std::vector<std::string> own;
  for (int k = 1; k < argc; ++k) {
    if (!is_petsc_option(argv[k])) {
      own.emplace_back(argv[k]);
    } else if (k + 1 < argc &&
               (argv[k + 1][0] != '-' || (argv[k + 1][1] >= '0' && argv[k + 1][1] <= '9'))) {
      ++k;
    }
  }
  return own;
}

int run(int argc, char** argv) {
  const Processes processes({argv, argv + argc});
  if (processes.rank() > 0) {
    work_on_parts();
    return 0;
  }
  PartEngine engine(processes.size());
  return run_program(own_arguments(argc, argv), &engine);
}

}  // namespace
}  // namespace carat::cli

int main(int argc, char** argv) {
  try {
    return carat::cli::run(argc, argv);
  } catch (const std::exception& error) {
    return carat::cli::report_failure(carat::cli::describe_failure(error), false);
  }
}
