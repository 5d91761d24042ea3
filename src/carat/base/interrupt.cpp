#include "carat/base/interrupt.h"

namespace carat {
namespace {

thread_local const std::atomic<bool>* stop_of_thread = nullptr;

}  // namespace

Interruptible::Interruptible(const std::atomic<bool>* stop) : before_(stop_of_thread) {
  stop_of_thread = stop;
}

Interruptible::~Interruptible() { stop_of_thread = before_; }

const std::atomic<bool>* current_interrupt() { return stop_of_thread; }

void throw_if_interrupted() {
  if (stop_of_thread != nullptr && stop_of_thread->load(std::memory_order_relaxed))
    throw Interrupted();
}

}  // namespace carat
