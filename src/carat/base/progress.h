#pragma once
// Progress reports from long work to whoever started it.

#include <functional>
#include <string_view>

namespace carat {

/// Called with the name of the running phase and the fraction done in [0, 1]. May be empty.
using Progress = std::function<void(std::string_view phase, double fraction)>;

}  // namespace carat
