#pragma once
// The processes that work on the parts of one mesh, and errors that all of them get to know.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "carat/base/error.h"

namespace carat {

/// MPI, PETSc and SLEPc from construction to destruction. Once in a process; everything else of
/// this folder needs it. Work is shared by all processes of the job: what is said to be
/// *collective* has to be called by all of them.
class Processes {
 public:
  /// \param arguments  the command line: options of PETSc and SLEPc in it count
  explicit Processes(std::vector<std::string> arguments);
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
  std::vector<std::string> arguments_;  // PETSc keeps pointers into them
  std::vector<char*> pointers_;
};

/// This process among those of the job, and how many there are.
int own_rank();
int n_processes();

/// What is also thrown by all other processes of the job. Whoever meets anything else has to end
/// the job, as the others may wait for this process.
class SharedFailure {
 public:
  virtual ~SharedFailure() = default;
};

/// An error that is also a SharedFailure.
template <class Kind>
class Shared final : public Kind, public SharedFailure {
  using Kind::Kind;
};

/// Collective. Runs work that does not communicate itself; if it throws in any process, all throw
/// the error of the lowest of these, as Shared. Its message names the process unless all failed.
void together(const std::function<void()>& work);

/// Counts that overflow would be wrong without a word.
/// \param limit  the largest number that can be counted
/// \throws InvalidOption  a process has more; says what helps
void require_countable(const char* what, std::uint64_t n, std::uint64_t limit);

/// Collective. The same for work of the first process alone.
void on_first(const std::function<void()>& work);

/// Collective. Runs a program and gives its exit code, or that of `describe` for what it throws. An
/// error that all processes know is described by the first alone; any other ends the job at once.
int run_processes(const std::function<int()>& program,
                  const std::function<int(const std::exception&)>& describe);

/// Ends all processes of the job, whatever they do.
[[noreturn]] void end_job(int exit_code);

/// Collective: sums over all processes.
double sum_of_all(double value);
std::int64_t sum_of_all(std::int64_t value);
/// Each entry by itself; equally many in all processes.
std::vector<double> sum_of_all(std::vector<double> values);
std::vector<std::int64_t> sum_of_all(std::vector<std::int64_t> values);
double largest_of_all(double value);

}  // namespace carat
