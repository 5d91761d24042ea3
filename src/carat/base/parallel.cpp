#include "carat/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "carat/base/interrupt.h"

namespace carat {

// A mistake beyond, which would take all memory for stacks.
constexpr int kMostThreads = 1024;

int resolve_threads(int requested) {
  if (requested > 0) return std::min(requested, kMostThreads);
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_blocks(Index n, int threads, const std::function<void(int, Index, Index)>& body) {
  // Below this a thread costs more than it saves.
  constexpr Index kSerialBelow = 2048;
  const int blocks = n < kSerialBelow ? 1 : std::min<int>(resolve_threads(threads), n);
  const auto bound = [&](int block) {
    return static_cast<Index>(static_cast<std::int64_t>(n) * block / blocks);
  };
  throw_if_interrupted();
  if (blocks == 1) {
    body(0, 0, n);
    return;
  }
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(blocks));
  const auto guarded = [&](int block) {
    try {
      body(block, bound(block), bound(block + 1));
    } catch (...) {
      failures[static_cast<std::size_t>(block)] = std::current_exception();
    }
  };
  std::vector<std::jthread> workers;
  workers.reserve(static_cast<std::size_t>(blocks) - 1);
  for (int block = 1; block < blocks; ++block) workers.emplace_back(guarded, block);
  guarded(0);
  workers.clear();
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void parallel_tasks(Index n, int threads, const std::function<void(Index task)>& body) {
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(n));
  std::atomic<Index> next{0};
  const auto work = [&, stop = current_interrupt()] {
    const Interruptible scope(stop);
    for (Index task = next++; task < n; task = next++) try {
        throw_if_interrupted();
        body(task);
      } catch (...) {
        failures[static_cast<std::size_t>(task)] = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> workers;
    for (int k = 1; k < std::min<int>(resolve_threads(threads), n); ++k) workers.emplace_back(work);
    work();
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace carat
