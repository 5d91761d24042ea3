#pragma once
// One file of an OpenFOAM mesh: a header, and a list in text or binary or a dictionary.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "carat/base/memory.h"
#include "carat/base/types.h"
#include "carat/io/scanner.h"

namespace carat::detail {

/// Words of a dictionary: names, values, texts in quotes (without them), and each of (){};
class FoamTokens {
 public:
  explicit FoamTokens(std::string_view text) : text_(text) {}
  /// The next token, "" at the end. Comments are passed over.
  std::string_view next();
  std::size_t position() const { return at_; }

 private:
  void skip_blanks_and_comments();
  std::string_view text_;
  std::size_t at_ = 0;
};

class FoamFile {
 public:
  /// Loads folder/name or folder/name.gz and reads the header.
  /// \throws IoError  missing, unreadable, no header
  FoamFile(const std::filesystem::path& folder, const std::string& name);

  const std::string& class_name() const { return class_; }
  /// What stands behind the header.
  std::string_view body() const { return content().substr(body_); }
  /// "line 12: " for a position in the body.
  std::string line_of(std::size_t position_in_body) const {
    return line_prefix(content(), body_ + position_in_body);
  }

  /// The next list of whole numbers. One of equal numbers can be written as 12{0}.
  /// \param most  numbers that such a list can stand for
  Array<Index> read_labels(std::int64_t most);
  /// The same for numbers of any sign and size.
  std::vector<std::int64_t> read_ids(std::int64_t most);
  /// A list of vectors with finite coordinates.
  Points read_vectors();
  /// A list of lists of whole numbers, in either form.
  Csr read_faces();

 private:
  std::string_view content() const { return {bytes_.data(), bytes_.size()}; }
  void read_header();
  void set_architecture(std::string_view text);
  std::int64_t open_list(const char* what, std::size_t values, std::size_t bytes);
  void open_parenthesis();
  void close_parenthesis();
  void start_values() { scanner_.set_encoding(encoding_); }
  template <class List, class Read>
  List read_list(std::int64_t most, const Read& read);
  Index read_label();
  Csr read_compact_faces();

  Array<char> bytes_;
  std::string class_;
  Encoding encoding_ = Encoding::Text;
  NumberType label_ = NumberType::Int32, scalar_ = NumberType::Float64;
  std::size_t body_ = 0;
  Scanner scanner_{std::string_view()};
};

}  // namespace carat::detail
