#pragma once
// Data parallelism over contiguous blocks. The partition never influences a result: callers write
// each output from exactly one block, in an order that does not depend on the blocks.

#include <functional>

#include "carat/base/types.h"

namespace carat {

/// Number of threads to use: `requested` if positive, but at most 1024; else what the machine
/// offers.
int resolve_threads(int requested);

/// Calls body(block, begin, end) on `threads` contiguous blocks that cover [0, n).
/// The exception of the lowest block, if any, is rethrown after all have ended.
void parallel_blocks(Index n, int threads,
                     const std::function<void(int block, Index begin, Index end)>& body);

/// Calls body(task) once for every task in [0, n), each on one of `threads` threads: for few tasks
/// that are long. The exception of the lowest task, if any, is rethrown after all have ended.
void parallel_tasks(Index n, int threads, const std::function<void(Index task)>& body);

}  // namespace carat
