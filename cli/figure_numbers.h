#pragma once
// Numbers as they are typeset in figures: ^{...} is raised, a minus is a minus sign.

#include <string>

namespace carat::cli {

/// Up to `digits` significant digits, with a power of ten where that is shorter to read.
/// \param keep_zeros  zeros at the end, so that numbers of a column have the same digits
std::string number_text(double value, int digits, bool keep_zeros = false);

/// A number with so many digits after the point.
std::string fixed_text(double value, int decimals);

/// A whole number in groups of three digits.
std::string integer_text(double value);

/// A ratio in the narrow cell of a matrix: two digits after the point where they tell something.
std::string ratio_text(double value);

/// mantissa × 10^exponent.
std::string power_text(const std::string& mantissa, int exponent);

/// Whether a number is written out, without a power of ten.
bool is_short(double value);

}  // namespace carat::cli
