#include "cli/figure_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace carat::cli {
namespace {

const std::string kMinus = "\u2212";
const std::string kThinSpace = "\u2009";

std::string print(const char* format, int digits, double value) {
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, digits, value);
  return buffer.data();
}

std::string with_minus_sign(std::string text) {
  if (!text.empty() && text[0] == '-') text.replace(0, 1, kMinus);
  return text;
}

void strip_zeros(std::string& text) {
  if (text.find('.') == std::string::npos) return;
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
}

}  // namespace

bool is_short(double value) {
  const double size = std::abs(value);
  return size == 0 || (size >= 1e-3 && size < 1e7);
}

std::string power_text(const std::string& mantissa, int exponent) {
  if (exponent == 0) return with_minus_sign(mantissa);
  const std::string power = "10^{" + with_minus_sign(std::to_string(exponent)) + "}";
  return mantissa == "1" ? power : with_minus_sign(mantissa) + "\u00d7" + power;
}

std::string number_text(double value, int digits, bool keep_zeros) {
  value += 0.0;  // zero has no sign
  const std::string scientific = print("%.*e", digits - 1, value);
  const std::size_t e = scientific.find('e');
  if (e == std::string::npos) return scientific;  // not finite
  const int exponent = std::atoi(scientific.c_str() + e + 1);
  std::string plain = is_short(value) ? print("%.*f", std::max(0, digits - 1 - exponent), value)
                                      : scientific.substr(0, e);
  if (!keep_zeros || value == 0) strip_zeros(plain);
  return is_short(value) ? with_minus_sign(plain) : power_text(plain, exponent);
}

std::string fixed_text(double value, int decimals) {
  const std::string text = print("%.*f", decimals, value);
  // Zero has no sign.
  return text.find_first_of("123456789") == std::string::npos ? print("%.*f", decimals, 0.0)
                                                              : with_minus_sign(text);
}

std::string integer_text(double value) {
  std::string text = print("%.*f", 0, std::abs(value));
  if (text.size() > 4)
    for (std::size_t i = text.size(); i > 3;) text.insert(i -= 3, kThinSpace);
  return (value < 0 ? kMinus : "") + text;
}

std::string ratio_text(double value) {
  const double size = std::abs(value);
  if (size != 0 && (size < 0.01 || size >= 9999.5)) return number_text(value, 1);
  return fixed_text(value, size < 9.995 ? 2 : size < 99.95 ? 1 : 0);
}

}  // namespace carat::cli
