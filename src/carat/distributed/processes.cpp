#include "carat/distributed/processes.h"

#include <slepcsys.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <thread>
#include <utility>

#include "carat/distributed/petsc.h"

namespace carat {
namespace {

enum ErrorKind { kNone, kMesh, kDegenerate, kOption, kFile, kSolver, kMemory, kOther };

constexpr const char* kNoMemory = "out of memory; use more processes or machines";

bool is_memory(const std::exception& error) {
  return dynamic_cast<const OutOfMemory*>(&error) || dynamic_cast<const std::bad_alloc*>(&error);
}

ErrorKind kind_of(const std::exception& error) {
  if (dynamic_cast<const InvalidMesh*>(&error)) return kMesh;
  if (dynamic_cast<const DegenerateElement*>(&error)) return kDegenerate;
  if (dynamic_cast<const InvalidOption*>(&error)) return kOption;
  if (dynamic_cast<const IoError*>(&error)) return kFile;
  if (dynamic_cast<const SolverFailure*>(&error)) return kSolver;
  return is_memory(error) ? kMemory : kOther;
}

[[noreturn]] void throw_shared(int kind, const std::string& message, std::vector<Index> elements) {
  switch (kind) {
    case kMesh:
      throw Shared<InvalidMesh>(message, std::move(elements));
    case kDegenerate:
      throw Shared<DegenerateElement>(message, std::move(elements));
    case kOption:
      throw Shared<InvalidOption>(message, std::move(elements));
    case kFile:
      throw Shared<IoError>(message, std::move(elements));
    case kSolver:
      throw Shared<SolverFailure>(message, std::move(elements));
    case kMemory:
      throw Shared<OutOfMemory>(message, std::move(elements));
    default:
      throw Shared<Error>(message, std::move(elements));
  }
}

void check_mpi(int error) {
  if (error != MPI_SUCCESS) throw SolverFailure("MPI failed: error " + std::to_string(error));
}

template <class Value>
Value reduce(Value value, MPI_Datatype type, MPI_Op operation) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, operation, PETSC_COMM_WORLD));
  return value;
}

/// Whether PETSc has met the end of memory: the code that comes back may be another.
bool memory_is_out = false;

/// Errors come back as codes, without a trace on the terminal.
PetscErrorCode note_error(MPI_Comm, int, const char* function, const char*, PetscErrorCode error,
                          PetscErrorType, const char*, void*) {
  memory_is_out |= error == PETSC_ERR_MEM ||
                   (function != nullptr && std::string_view(function).starts_with("PetscMalloc"));
  return error;
}

/// Of a process, to all others.
template <class List>
void broadcast(List& list, MPI_Datatype type, int from) {
  int length = static_cast<int>(list.size());
  check_mpi(MPI_Bcast(&length, 1, MPI_INT, from, PETSC_COMM_WORLD));
  list.resize(static_cast<std::size_t>(length));
  check_mpi(MPI_Bcast(list.data(), length, type, from, PETSC_COMM_WORLD));
}

/// Runs `work` in this process, if it is one of those that work; what the first process throws all
/// throw.
/// \param names_process  the message tells whose it is, where not all of several met an error
void share(const std::function<void()>& work, bool works, bool names_process) {
  int kind = kNone;
  std::string message;
  std::vector<Index> elements;
  try {
    if (works) work();
  } catch (const std::exception& error) {
    kind = kind_of(error);
    message = kind == kMemory ? kNoMemory : error.what();
    if (const auto* const own = dynamic_cast<const Error*>(&error)) elements = own->elements();
  }
  const int rank = own_rank();
  const int first = reduce(kind == kNone ? INT_MAX : rank, MPI_INT, MPI_MIN);
  if (first == INT_MAX) return;
  const int n_failed = reduce(kind == kNone ? 0 : 1, MPI_INT, MPI_SUM);
  if (names_process && n_failed < n_processes())
    message = "process " + std::to_string(rank) + ": " + message;
  check_mpi(MPI_Bcast(&kind, 1, MPI_INT, first, PETSC_COMM_WORLD));
  broadcast(message, MPI_CHAR, first);
  broadcast(elements, MPI_INT32_T, first);
  throw_shared(kind, message, std::move(elements));
}

}  // namespace

void check(PetscErrorCode error) {
  if (error == 0) return;
  if (std::exchange(memory_is_out, false)) throw OutOfMemory(kNoMemory);
  const char* general = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(error, &general, &specific);
  std::string message = "PETSc: ";
  message += general ? general : "error " + std::to_string(error);
  if (specific && *specific) message.append(": ").append(specific);
  std::replace(message.begin(), message.end(), '\n', ' ');
  throw SolverFailure(message);
}

Processes::Processes(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
  for (std::string& argument : arguments_) pointers_.push_back(argument.data());
  pointers_.push_back(nullptr);
  int count = static_cast<int>(arguments_.size());
  char** values = pointers_.data();
  check(SlepcInitialize(&count, &values, nullptr, nullptr));
  check(PetscPushErrorHandler(note_error, nullptr));
  check(PetscPopSignalHandler());
  check_mpi(MPI_Comm_rank(PETSC_COMM_WORLD, &rank_));
  check_mpi(MPI_Comm_size(PETSC_COMM_WORLD, &size_));
}

Processes::~Processes() { SlepcFinalize(); }

void together(const std::function<void()>& work) { share(work, true, true); }

void on_first(const std::function<void()>& work) { share(work, own_rank() == 0, false); }

void require_countable(const char* what, std::uint64_t n, std::uint64_t limit) {
  if (n <= limit) return;
  throw InvalidOption(std::to_string(n) + " " + what + " in one process, at most " +
                      std::to_string(limit) +
                      " can be counted by this PETSc's indices; use more processes, or a PETSc "
                      "that was configured with 64-bit indices");
}

int run_processes(const std::function<int()>& program,
                  const std::function<int(const std::exception&)>& describe) {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  int code = 0;
  try {
    return program();
  } catch (const std::exception& error) {
    const bool shared = dynamic_cast<const SharedFailure*>(&error) != nullptr;
    // What several meet at once, the lowest tells, and ends the others meanwhile.
    if (!shared) std::this_thread::sleep_for(std::chrono::milliseconds(300) * std::min(rank, 8));
    if (!shared && is_memory(error))
      code = describe(OutOfMemory(kNoMemory));
    else if (!shared || rank == 0)
      code = describe(error);
    // Without memory MPI may wait for ever where it ends.
    if (!shared || (rank == 0 && is_memory(error))) end_job(code);
  }
  check_mpi(MPI_Bcast(&code, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  return code;
}

void end_job(int exit_code) {
  std::fflush(nullptr);
  MPI_Abort(PETSC_COMM_WORLD, exit_code);
  std::abort();
}

double sum_of_all(double value) { return reduce(value, MPI_DOUBLE, MPI_SUM); }
std::int64_t sum_of_all(std::int64_t value) { return reduce(value, MPI_INT64_T, MPI_SUM); }
std::vector<std::int64_t> sum_of_all(std::vector<std::int64_t> values) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T,
                          MPI_SUM, PETSC_COMM_WORLD));
  return values;
}
std::vector<double> sum_of_all(std::vector<double> values) {
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE,
                          MPI_SUM, PETSC_COMM_WORLD));
  return values;
}
double largest_of_all(double value) { return reduce(value, MPI_DOUBLE, MPI_MAX); }

}  // namespace carat
