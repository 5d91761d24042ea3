#pragma once
// Long work without Python's lock, which Ctrl-C ends.

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

#include "carat/base/interrupt.h"
#include "carat/base/types.h"

namespace carat::python {

/// What the thread that works and the one that waits for it share.
struct Job {
  std::atomic<bool> stop{false};
  std::atomic<Index> progress{0};
  std::mutex mutex;
  std::condition_variable ended;
  bool has_ended = false;
  std::exception_ptr failure;
};

namespace detail {

/// Starts the work on a thread of its own, which tells the job when it has ended.
void start(const std::shared_ptr<Job>& job, std::function<void()> work);
/// Waits for the end; handles signals, as Python does between two instructions.
/// \param progress  None, or called with the number that the job has come to
/// \throws pybind11::error_already_set  a signal's or progress's exception, e.g. KeyboardInterrupt.
///         The job has been asked to stop; after a moment of grace it is left to itself.
void wait(Job& job, const pybind11::object& progress);

}  // namespace detail

/// Runs work(job) and returns its result.
///
/// The work runs on a thread of its own, so that signals are met at once also in the middle of a
/// library's factorisation. For it may outlive the call then, it must own what it uses and touch no
/// Python object.
template <class Work>
auto run(Work work, const pybind11::object& progress = pybind11::none()) {
  using Result = std::invoke_result_t<Work, Job&>;
  struct State : Job {
    std::optional<Result> result;
  };
  const auto state = std::make_shared<State>();
  // A shared pointer, as std::function copies.
  detail::start(state, [state, held = std::make_shared<Work>(std::move(work))] {
    state->result.emplace((*held)(*state));
  });
  detail::wait(*state, progress);
  return std::move(*state->result);
}

/// Waits for work that was left to itself; called before the interpreter ends.
void wait_for_abandoned();

}  // namespace carat::python
