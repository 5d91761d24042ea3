#pragma once
// Colours, and images made of them.

#include <cstdint>
#include <vector>

namespace carat::cli {

/// Red, green and blue from 0 to 1.
struct Color {
  double red;
  double green;
  double blue;
};

/// A colour from its usual six digits.
constexpr Color rgb(unsigned digits) {
  return {static_cast<double>(digits >> 16 & 255) / 255,
          static_cast<double>(digits >> 8 & 255) / 255, static_cast<double>(digits & 255) / 255};
}

/// Rows from above; every pixel as 0xRRGGBB.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> pixels{};
};

}  // namespace carat::cli
