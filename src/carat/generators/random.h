#pragma once
// Random numbers that are the same on every platform (those of <random>'s distributions are not).

#include <cstdint>

#include "carat/base/types.h"

namespace carat {

/// SplitMix64, one independent stream for every (seed, index): the numbers of an element do not
/// depend on which elements came before it.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t index)
      : state_(mix(seed + kStep) ^ mix(~index * kStep)) {}

  /// Uniform in [0, 1).
  double uniform() {
    state_ += kStep;
    return static_cast<double>(mix(state_) >> 11) * 0x1p-53;
  }

  /// Uniform in the unit disc; by rejection, as sines differ between platforms.
  Vec2 in_disc() {
    while (true) {
      const double x = 2 * uniform() - 1;
      const double y = 2 * uniform() - 1;
      if (x * x + y * y <= 1) return {x, y};
    }
  }

  /// Uniform in the unit ball.
  Vec3 in_ball() {
    while (true) {
      const double x = 2 * uniform() - 1;
      const double y = 2 * uniform() - 1;
      const double z = 2 * uniform() - 1;
      if (x * x + y * y + z * z <= 1) return {x, y, z};
    }
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace carat
