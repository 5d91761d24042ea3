// The program carat-petsc: carat with an engine over all processes of an MPI job.

#include <algorithm>
#include <iostream>
#include <streambuf>
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

/// Takes what all but the first process would print, as all run the same program.
class Silence {
 public:
  explicit Silence(bool silent) {
    if (!silent) return;
    output_ = std::cout.rdbuf(&nothing_);
    errors_ = std::cerr.rdbuf(&nothing_);
  }
  ~Silence() { end(); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  void end() {
    if (output_ == nullptr) return;
    std::cout.rdbuf(output_);
    std::cerr.rdbuf(errors_);
    output_ = nullptr;
  }

 private:
  struct Nothing final : std::streambuf {
    int overflow(int c) override { return traits_type::not_eof(c); }
  };
  Nothing nothing_;
  std::streambuf *output_ = nullptr, *errors_ = nullptr;
};

int run(int argc, char** argv) {
  const Processes processes({argv, argv + argc});
  const std::vector<std::string> arguments = own_arguments(argc, argv);
  const bool first = processes.rank() == 0;
  // Without an engine a command is one process's work.
  if (!first && !asks_for_petsc(arguments)) return kSuccess;
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  Silence silence(!first);
  const PartEngine engine;
  return run_processes([&] { return run_program(arguments, &engine); },
                       [&](const std::exception& error) {
                         silence.end();
                         return report_failure(describe_failure(error), json);
                       });
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
