#pragma once
// What the measuring programs share.

#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "carat/base/memory.h"

namespace carat::bench {

inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline void stream_triad(benchmark::State& state) {
  constexpr std::size_t n = 20000000;
  static Array<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  for (auto _ : state) {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.counters["GB/s"] =
      benchmark::Counter(24e-9 * n, benchmark::Counter::kIsIterationInvariantRate);
}

/// Peak memory of `work` in a process of its own, above that of the mesh alone.  [MB]
template <class Work>
double peak_megabytes(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    std::_Exit(0);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return WIFEXITED(status) ? static_cast<double>(usage.ru_maxrss) / 1024 : -1;
}

/// Runs `work` in a process of its own.
/// \return what it returns, or a default value where it fails
template <class Result, class Work>
Result in_process(const Work& work) {
  static_assert(std::is_trivially_copyable_v<Result>);
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    try {
      const Result result = work();
      std::_Exit(write(ends[1], &result, sizeof result) == sizeof result ? 0 : 1);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      std::_Exit(1);
    }
  }
  close(ends[1]);
  Result result{};
  const bool whole = read(ends[0], &result, sizeof result) == sizeof result;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return whole ? result : Result{};
}

/// Keeps the best time of every benchmark, for the table of ratios.
class BestTimes : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const double seconds = run.GetAdjustedRealTime() * 1e-3;
      const std::string name = run.run_name.function_name + "/" + run.run_name.args;
      const auto [entry, fresh] = best.emplace(name, seconds);
      if (!fresh && seconds < entry->second) entry->second = seconds;
    }
  }
  std::map<std::string, double> best;
};

}  // namespace carat::bench
