#pragma once
// Reads numbers and words from a file that lies in memory, as text or as binary values.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace carat::detail {

enum class Encoding { Text, LittleEndian, BigEndian };

enum class NumberType {
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

std::size_t size_of(NumberType type);
inline bool is_integer(NumberType type) { return type < NumberType::Float32; }

/// What a text format allows.
struct ScannerSyntax {
  char comment = '\0';            ///< starts a comment that ends with the line; 0: none
  bool continuation = false;      ///< a backslash before the end of a line joins it to the next
  std::string_view delimiters{};  ///< end a word or number like a blank, but are content
};

/// A position in a file's content. Lines end with LF or CRLF. Numbers are correctly rounded
/// and independent of the locale.
class Scanner {
 public:
  /// \param content  must outlive the scanner
  explicit Scanner(std::string_view content, ScannerSyntax syntax = {})
      : begin_(content.data()), at_(begin_), end_(begin_ + content.size()), syntax_(syntax) {}

  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }

  /// Skips blanks, line ends and comments. False at the end of the file.
  bool to_content();
  /// Skips blanks. True if the line (or the file) ends here, or a comment starts.
  bool at_line_end();
  void skip_bytes(std::size_t n) { at_ += n < remaining() ? n : remaining(); }
  /// Moves behind the next line end.
  void skip_line();
  /// The characters up to the next blank or line end, which must lie in this line ("" if none).
  std::string_view word();
  /// What is left of this line, without its end; leaves the scanner behind the line.
  std::string_view rest_of_line();
  /// The next number of this line; may be infinite or NaN.
  double number();
  /// The next number of this line, which must be finite.
  double coordinate();
  std::int64_t integer();
  /// Takes `c` if it comes next.
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  /// From here on real() and whole() read values of this encoding. Errors in binary values name the
  /// byte instead of the line.
  void set_encoding(Encoding encoding) { encoding_ = encoding; }
  Encoding encoding() const { return encoding_; }
  /// Moves from a header to its values: in binary they start in the next line.
  void start_values() {
    if (encoding_ != Encoding::Text) skip_line();
  }
  /// The next value of the body; in text it may stand in any later line.
  double real(NumberType type);
  std::int64_t whole(NumberType type);
  /// Moves over that many values of the body.
  void skip_values(std::int64_t count, NumberType type);
  /// Refuses a count which the rest of the file cannot hold, before anything is allocated for it.
  /// \param what    e.g. "vertices"
  /// \param values  numbers in one of them, at least
  /// \param bytes   size of one of them in binary, at least
  void require(std::int64_t count, const char* what, std::size_t values, std::size_t bytes) const;

  /// \throws IoError  "line 12: message", or "byte 345: message" in binary values
  [[noreturn]] void fail(const std::string& message) const;

 private:
  bool is_delimiter(char c) const { return syntax_.delimiters.find(c) != std::string_view::npos; }
  template <class T>
  T binary();
  template <class T>
  T binary(NumberType type);

  const char* begin_;
  const char* at_;
  const char* end_;
  ScannerSyntax syntax_;
  Encoding encoding_ = Encoding::Text;
};

/// What a message may show of a file: printable, short, in quotes.
std::string in_quotes(std::string_view text);

/// "line 12: " for a position in a text.
std::string line_prefix(std::string_view content, std::size_t position);

}  // namespace carat::detail
