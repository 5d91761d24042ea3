#pragma once
// A sign of life during long work, on terminals only.

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace carat::cli {

/// While it lives, the last line of the terminal shows the running phase and its time. It draws
/// nothing where standard error is no terminal, nor in the first moments.
class ProgressLine {
 public:
  explicit ProgressLine(std::string phase);
  ~ProgressLine();
  /// Another text from now on.
  void show(std::string phase);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

 private:
  void draw(const std::stop_token& stop);

  std::string phase_;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread drawer_;
};

}  // namespace carat::cli
