#pragma once
// Numbers in messages.

#include <cstdio>
#include <string>

namespace carat {

/// "1.5 GB".
inline std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", bytes * 1e-9);
  return text;
}

/// "1.5e-09".
inline std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

}  // namespace carat
