#pragma once
// Stopping long work from outside: a user who presses Ctrl-C, a program that has changed its mind.

#include <atomic>
#include <exception>

namespace carat {

/// Thrown by work that was asked to stop. Not an Error: nothing is wrong.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped on request"; }
};

/// While it lives, work that this thread begins ends with Interrupted soon after `stop` has become
/// true. Iterations look at it in every step, assembly and factorisations between their phases; a
/// phase of a factorisation, which a library runs, is not cut short.
class Interruptible {
 public:
  /// \param stop  must outlive the scope; may be set by any thread
  explicit Interruptible(const std::atomic<bool>* stop);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  const std::atomic<bool>* before_;
};

/// What the calling thread's work is stopped by, to hand it on to threads of its own; null:
/// nothing.
const std::atomic<bool>* current_interrupt();

/// \throws Interrupted  the calling thread's work is to stop
void throw_if_interrupted();

}  // namespace carat
