#include "run.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

namespace carat::python {
namespace {

namespace py = pybind11;
using std::chrono::milliseconds;

constexpr milliseconds kLook{20};     // between two looks for signals
constexpr milliseconds kGrace{1000};  // for work that has been asked to stop

/// How many jobs run. Never destroyed: threads may end after static objects.
struct Running {
  std::mutex mutex;
  std::condition_variable fewer;
  int count = 0;
};
Running& running() {
  static Running* const only = new Running;
  return *only;
}

}  // namespace

namespace detail {

void start(const std::shared_ptr<Job>& job, std::function<void()> work) {
  {
    const std::lock_guard lock(running().mutex);
    ++running().count;
  }
  auto body = [job = job, work = std::move(work)]() mutable {
    try {
      const Interruptible scope(&job->stop);
      work();
    } catch (...) {
      job->failure = std::current_exception();
    }
    work = nullptr;
    {
      const std::lock_guard lock(job->mutex);
      job->has_ended = true;
    }
    job->ended.notify_all();
    job.reset();
    const std::lock_guard lock(running().mutex);
    --running().count;
    running().fewer.notify_all();
  };
  try {
    std::thread(std::move(body)).detach();
  } catch (...) {
    const std::lock_guard lock(running().mutex);
    --running().count;
    throw;
  }
}

void wait(Job& job, const py::object& progress) {
  Index shown = 0;
  const auto show = [&] {
    const Index now = job.progress.load();
    if (progress.is_none() || now == shown) return;
    shown = now;
    progress(now);
  };
  const auto until_end = [&](milliseconds time) {
    std::unique_lock lock(job.mutex);
    return job.ended.wait_for(lock, time, [&] { return job.has_ended; });
  };
  {
    const py::gil_scoped_release released;
    while (!until_end(kLook)) {
      const py::gil_scoped_acquire acquired;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        show();
      } catch (...) {
        job.stop = true;
        const py::gil_scoped_release released_again;
        until_end(kGrace);
        throw;
      }
    }
  }
  if (job.failure) std::rethrow_exception(job.failure);
  show();
}

}  // namespace detail

void wait_for_abandoned() {
  const py::gil_scoped_release released;
  std::unique_lock lock(running().mutex);
  if (running().count == 0) return;
  // Whoever presses Ctrl-C once more does not want to wait.
  std::signal(SIGINT, SIG_DFL);
  running().fewer.wait(lock, [] { return running().count == 0; });
}

}  // namespace carat::python
