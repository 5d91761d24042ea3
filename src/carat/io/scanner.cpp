#include "carat/io/scanner.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>
#include <system_error>

#include "carat/base/error.h"
#include "carat/base/types.h"

namespace carat::detail {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// The value of a number that from_chars finds out of range: 0 or infinity with its sign.
double saturated(const char* first, const char* last) {
  std::istringstream stream(std::string(first, last));
  stream.imbue(std::locale::classic());
  double value = 0;
  if (stream >> value) return value;
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string shown = "'";
  for (const char c : text.substr(0, 24)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > 24 ? "...'" : "'");
}

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::Int8:
    case NumberType::UInt8:
      return 1;
    case NumberType::Int16:
    case NumberType::UInt16:
      return 2;
    case NumberType::Int32:
    case NumberType::UInt32:
    case NumberType::Float32:
      return 4;
    default:
      return 8;
  }
}

std::string line_prefix(std::string_view content, std::size_t position) {
  const std::string_view before = content.substr(0, position);
  return "line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ": ";
}

void Scanner::fail(const std::string& message) const {
  if (encoding_ != Encoding::Text)
    throw IoError("byte " + std::to_string(position()) + ": " + message);
  throw IoError(line_prefix({begin_, static_cast<std::size_t>(end_ - begin_)}, position()) +
                message);
}

bool Scanner::to_content() {
  while (at_line_end()) {
    if (at_ == end_) return false;
    skip_line();
  }
  return true;
}

bool Scanner::at_line_end() {
  for (; at_ != end_; ++at_) {
    if (is_blank(*at_)) continue;
    if (*at_ == '\n') return true;
    if (syntax_.comment != '\0' && *at_ == syntax_.comment) return true;
    if (!syntax_.continuation || *at_ != '\\') return false;
    const char* next = at_ + 1;
    if (next != end_ && *next == '\r') ++next;
    if (next != end_ && *next != '\n') return false;
    at_ = next;
    if (at_ == end_) return true;
  }
  return true;
}

void Scanner::skip_line() {
  const void* stop = at_ == end_ ? nullptr : std::memchr(at_, '\n', remaining());
  at_ = stop == nullptr ? end_ : static_cast<const char*>(stop) + 1;
}

std::string_view Scanner::word() {
  if (at_line_end()) return {};
  const char* first = at_;
  while (at_ != end_ && !is_blank(*at_) && *at_ != '\n' && !is_delimiter(*at_)) ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

std::string_view Scanner::rest_of_line() {
  const char* const first = at_;
  skip_line();
  std::string_view line(first, static_cast<std::size_t>(at_ - first));
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

double Scanner::number() {
  if (at_line_end()) fail("a number is missing; the file is truncated or damaged");
  const char* first = at_;
  if (*first == '+' && first + 1 != end_ && first[1] != '-') ++first;
  double value = 0;
  const auto [stop, status] = std::from_chars(first, end_, value);
  const bool ends = stop == end_ || is_blank(*stop) || *stop == '\n' || *stop == syntax_.comment ||
                    is_delimiter(*stop);
  if (status == std::errc::invalid_argument || !ends)
    fail(in_quotes(word()) + " is not a number; correct it");
  if (status == std::errc::result_out_of_range) value = saturated(first, stop);
  at_ = stop;
  return value;
}

double Scanner::coordinate() {
  const double value = number();
  if (!std::isfinite(value))
    fail("coordinate " + std::to_string(value) + "; every coordinate must be a finite number");
  return value;
}

std::int64_t Scanner::integer() {
  if (at_line_end()) fail("a whole number is missing; the file is truncated or damaged");
  const char* first = at_;
  if (*first == '+' && first + 1 != end_ && first[1] != '-') ++first;
  std::int64_t value = 0;
  const auto [stop, status] = std::from_chars(first, end_, value);
  const bool ends = stop == end_ || is_blank(*stop) || *stop == '\n' || *stop == '/' ||
                    *stop == syntax_.comment || is_delimiter(*stop);
  if (status != std::errc() || !ends)
    fail(in_quotes(word()) + " is not a whole number (or too large); correct it");
  at_ = stop;
  return value;
}

template <class T>
T Scanner::binary() {
  if (remaining() < sizeof(T)) fail("the file ends too early; it is truncated, export it again");
  char bytes[sizeof(T)];
  std::memcpy(bytes, at_, sizeof(T));
  at_ += sizeof(T);
  const bool little = encoding_ == Encoding::LittleEndian;
  if (little != (std::endian::native == std::endian::little))
    std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <class T>
T Scanner::binary(NumberType type) {
  switch (type) {
    case NumberType::Int8:
      return static_cast<T>(binary<std::int8_t>());
    case NumberType::UInt8:
      return static_cast<T>(binary<std::uint8_t>());
    case NumberType::Int16:
      return static_cast<T>(binary<std::int16_t>());
    case NumberType::UInt16:
      return static_cast<T>(binary<std::uint16_t>());
    case NumberType::Int32:
      return static_cast<T>(binary<std::int32_t>());
    case NumberType::UInt32:
      return static_cast<T>(binary<std::uint32_t>());
    case NumberType::Int64:
      return static_cast<T>(binary<std::int64_t>());
    case NumberType::UInt64:
      return static_cast<T>(binary<std::uint64_t>());
    case NumberType::Float32:
      return static_cast<T>(binary<float>());
    default:
      return static_cast<T>(binary<double>());
  }
}

double Scanner::real(NumberType type) {
  if (encoding_ != Encoding::Text) return binary<double>(type);
  if (!to_content()) fail("the file ends too early; it is truncated, export it again");
  return number();
}

std::int64_t Scanner::whole(NumberType type) {
  if (encoding_ == Encoding::Text) {
    if (!to_content()) fail("the file ends too early; it is truncated, export it again");
    return integer();
  }
  if (!is_integer(type)) fail("whole numbers are stored as floating point numbers");
  return binary<std::int64_t>(type);
}

void Scanner::skip_values(std::int64_t count, NumberType type) {
  require(count, "values", 1, size_of(type));
  if (encoding_ != Encoding::Text) {
    at_ += static_cast<std::size_t>(count) * size_of(type);
    return;
  }
  for (std::int64_t i = 0; i < count; ++i) {
    if (!to_content()) fail("the file ends too early; it is truncated, export it again");
    word();
  }
}

void Scanner::require(std::int64_t count, const char* what, std::size_t values,
                      std::size_t bytes) const {
  // In text a value takes a character and, but for the last one, a separator.
  const bool text = encoding_ == Encoding::Text;
  const std::size_t each = text ? 2 * values : bytes;
  const std::size_t available = remaining() + (text ? 1 : 0);
  if (count < 0 || (each > 0 && static_cast<std::uint64_t>(count) > available / each))
    fail(std::to_string(count) + " " + what + " are announced, but only " +
         std::to_string(remaining()) +
         " bytes follow; the file is truncated or damaged, export it again");
  if (count > std::numeric_limits<Index>::max())
    fail(std::to_string(count) + " " + what + ": at most " +
         std::to_string(std::numeric_limits<Index>::max()) + " are supported; split the mesh");
}

}  // namespace carat::detail
