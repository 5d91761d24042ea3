// The command line: finds the command, parses its options, runs it, and turns exceptions into one
// line and an exit code.

#include <dlfcn.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "carat/base/parallel.h"
#include "cli/command.h"
#include "cli/engine.h"
#include "cli/failure.h"

namespace carat::cli {

const std::vector<const Command*>& commands() {
  static const std::vector<const Command*> all = {
#define CARAT_COMMAND(name) &name##_command,
#include "cli/commands.def"
#undef CARAT_COMMAND
  };
  return all;
}

namespace {

/// Insertions, deletions and replacements between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

Failure unknown_command(const std::string& name) {
  std::string message = "unknown command '" + name + "'";
  constexpr std::size_t farthest = 3;
  std::size_t best = farthest;
  const Command* guess = nullptr;
  for (const Command* command : commands())
    if (const std::size_t distance = edit_distance(name, command->name); distance < best) {
      best = distance;
      guess = command;
    }
  if (guess != nullptr) message += "; did you mean '" + std::string(guess->name) + "'?";
  return usage_failure(message + " See carat --help");
}

void print_help() {
  std::cout << "carat " CARAT_VERSION
               " - discrete differential operators on polygon and polyhedral meshes\n\n"
               "Usage: carat COMMAND [OPTIONS]\n\nCommands:\n";
  for (const Command* command : commands()) {
    std::string name = command->name;
    name.resize(12, ' ');
    std::cout << "  " << name << command->title << '\n';
  }
  std::cout << "\n  -h, --help     this text; carat COMMAND --help for a command's options\n"
               "  --version      the version\n\n"
               "Every command knows --json (one object on standard output) and --threads N.\n"
               "Exit codes: 0 done, 2 command line, 3 input, 4 numerical failure.\n\n"
               "Examples:\n"
               "  carat generate sphere-hexagons --level 4 -o sphere.ply\n"
               "  carat info sphere.ply\n"
               "  carat geodesics sphere.ply --source 0 -o distance.html\n"
               "  carat curvature sphere.ply --signed -o curvature.vtp\n"
               "  carat generate ball-voronoi --level 2 -o ball.vtu\n"
               "  carat eigen ball.vtu --dirichlet -o modes.html\n";
}

/// OpenBLAS has a pool of its own. It is looked up, as other BLAS libraries serve as well.
void limit_blas_threads(int threads) {
  using SetThreads = void (*)(int);
  if (const auto set = reinterpret_cast<SetThreads>(  // the interface of dlsym
          ::dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
    set(resolve_threads(threads));
}

int run_command(const Command& command, std::vector<std::string> arguments, const Engine* engine) {
  CLI::App app(std::string(command.title) + ".\n" + command.details,
               "carat " + std::string(command.name));
  app.footer("\nExamples:\n" + std::string(command.examples));
  app.get_formatter()->column_width(32);
  CommonOptions common;
  common.engine = engine;
  const std::function<void(Session&)> run = command.declare(app);
  app.add_flag("--json", common.json, "Print one JSON object on standard output, nothing else");
  app.add_option("--threads", common.threads, "Number of threads; 0: all the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  // Also where parsing fails, the answer is in the form that was asked for.
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  try {
    std::reverse(arguments.begin(), arguments.end());
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    return report_failure(
        usage_failure(std::string(error.what()) + "; see carat " + command.name + " --help"), json);
  }
  try {
    limit_blas_threads(common.threads);
    Session session(command.name, common);
    run(session);
    session.finish();
    return session.exit_code();
  } catch (const std::exception& error) {
    if (engine != nullptr) throw;
    return report_failure(describe_failure(error), json);
  }
}

/// Becomes the program with the engine, which lies beside this one. \return only if there is none
Failure start_petsc(const std::vector<std::string>& arguments) {
  std::error_code ignored;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::string program = (self.parent_path() / "carat-petsc").string();
  std::vector<char*> pointers{const_cast<char*>(program.c_str())};  // the interface of execv
  for (const std::string& argument : arguments)
    pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return usage_failure("--engine petsc: " + program +
                       " cannot be started; it is built where Scotch, PETSc, SLEPc and MPI are "
                       "found (Debian: tools/install_packages.sh distributed)");
}

}  // namespace

bool asks_for_petsc(const std::vector<std::string>& arguments) {
  for (std::size_t k = 0; k < arguments.size(); ++k)
    if (arguments[k] == "--engine=petsc" ||
        (arguments[k] == "--engine" && k + 1 < arguments.size() && arguments[k + 1] == "petsc"))
      return true;
  return false;
}

int run_program(std::vector<std::string> arguments, const Engine* engine) {
  if (arguments.empty()) {
    print_help();
    return kUsage;
  }
  const bool json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  const bool petsc = asks_for_petsc(arguments);
  if (petsc && engine == nullptr) return report_failure(start_petsc(arguments), json);
  // The engine may also be named before the command.
  if (arguments[0] == "--engine" && arguments.size() > 2)
    std::rotate(arguments.begin(), arguments.begin() + 2, arguments.end());
  const std::string first = arguments[0];
  if (first == "--help" || first == "-h" || first == "help") {
    print_help();
    return kSuccess;
  }
  if (first == "--version") {
    std::cout << "carat " CARAT_VERSION "\n";
    return kSuccess;
  }
  arguments.erase(arguments.begin());
  for (const Command* command : commands())
    if (first == command->name)
      return run_command(*command, std::move(arguments), petsc ? engine : nullptr);
  return report_failure(unknown_command(first), json);
}

void declare_engine_option(CLI::App& app) {
  app.add_option_function<std::string>(
         "--engine", [](const std::string&) {},
         "What works: embedded, by itself, or petsc, over all\n"
         "processes of a job (mpirun -np N carat ...), with outputs\n"
         "also in parts (.pvtu, .pvtp); options of PETSc and SLEPc\n"
         "are those with one dash, e.g. -ksp_monitor, and come last")
      ->check(CLI::IsMember({"embedded", "petsc"}))
      ->type_name("NAME")
      ->default_str("embedded");
}

}  // namespace carat::cli
