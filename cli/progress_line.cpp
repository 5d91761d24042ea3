#include "cli/progress_line.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>
#include <utility>

namespace carat::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPause{120};

bool has_terminal() {
  const char* const terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

}  // namespace

ProgressLine::ProgressLine(std::string phase) : phase_(std::move(phase)) {
  if (has_terminal()) drawer_ = std::jthread([this](const std::stop_token& stop) { draw(stop); });
}

ProgressLine::~ProgressLine() {
  if (!drawer_.joinable()) return;
  drawer_.request_stop();
  drawer_.join();
}

void ProgressLine::show(std::string phase) {
  const std::scoped_lock lock(mutex_);
  phase_ = std::move(phase);
}

void ProgressLine::draw(const std::stop_token& stop) {
  constexpr std::string_view spokes = "|/-\\";
  std::unique_lock lock(mutex_);
  int steps = 0;
  while (!ended_.wait_for(lock, stop, kPause, [] { return false; }) && !stop.stop_requested()) {
    ++steps;
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, " %.1f s ",
                  static_cast<double>(steps * kPause.count()) / 1000);
    std::cerr << "\r\033[K" << spokes[static_cast<std::size_t>(steps) % 4] << ' ' << phase_
              << seconds;
  }
  if (steps > 0) std::cerr << "\r\033[K";
}

}  // namespace carat::cli
