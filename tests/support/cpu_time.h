#pragma once
// Processor time, which unlike the time of day does not grow while other programs run.

#include <ctime>

namespace carat::test {

class CpuTimer {
 public:
  double seconds() const { return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

}  // namespace carat::test
