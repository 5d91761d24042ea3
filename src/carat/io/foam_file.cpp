#include "carat/io/foam_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/gzip.h"
#include "carat/io/load_file.h"

namespace carat::detail {
namespace {

constexpr ScannerSyntax kSyntax{.comment = '/', .delimiters = "(){}"};

Array<char> load(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path plain = folder / name, packed = folder / (name + ".gz");
  std::error_code ignored;
  if (std::filesystem::exists(plain, ignored) || !std::filesystem::exists(packed, ignored))
    return load_file(plain);
  return unpack_gzip(load_file(packed));
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
bool is_punctuation(char c) { return std::string_view("(){};").find(c) != std::string_view::npos; }

}  // namespace

void FoamTokens::skip_blanks_and_comments() {
  while (at_ < text_.size()) {
    const std::string_view rest = text_.substr(at_);
    if (is_space(rest[0])) {
      ++at_;
    } else if (rest.starts_with("//")) {
      at_ += std::min(rest.find('\n'), rest.size());
    } else if (rest.starts_with("/*")) {
      const std::size_t end = rest.find("*/", 2);
      at_ += end == rest.npos ? rest.size() : end + 2;
    } else {
      return;
    }
  }
}

std::string_view FoamTokens::next() {
  skip_blanks_and_comments();
  if (at_ == text_.size()) return {};
  const std::size_t first = at_;
  if (text_[at_] == '"') {
    const std::size_t end = std::min(text_.find('"', first + 1), text_.size());
    at_ = std::min(end + 1, text_.size());
    return text_.substr(first + 1, end - first - 1);
  }
  if (is_punctuation(text_[at_])) return text_.substr(at_++, 1);
  while (at_ < text_.size() && !is_space(text_[at_]) && !is_punctuation(text_[at_])) ++at_;
  return text_.substr(first, at_ - first);
}

FoamFile::FoamFile(const std::filesystem::path& folder, const std::string& name)
    : bytes_(load(folder, name)) {
  read_header();
  scanner_ = Scanner(content(), kSyntax);
  scanner_.skip_bytes(body_);
}

void FoamFile::read_header() {
  FoamTokens tokens(content());
  if (tokens.next() != "FoamFile" || tokens.next() != "{")
    throw IoError("does not start with the header FoamFile; it is no file of OpenFOAM");
  std::string_view format = "ascii", architecture;
  for (std::string_view key = tokens.next(); key != "}"; key = tokens.next()) {
    const std::string_view value = tokens.next();
    if (key.empty() || value.empty())
      throw IoError("the header FoamFile does not end; the file is truncated, export it again");
    if (value == ";") continue;
    if (key == "format") format = value;
    if (key == "class") class_ = value;
    if (key == "arch") architecture = value;
    for (std::string_view rest = tokens.next(); rest != ";"; rest = tokens.next())
      if (rest.empty() || rest == "}")
        throw IoError("the header FoamFile is damaged at " + in_quotes(key));
  }
  body_ = tokens.position();
  if (format != "ascii" && format != "binary")
    throw IoError("is of format " + in_quotes(format) + "; ascii or binary is needed");
  if (format == "binary") set_architecture(architecture);
}

/// For example "LSB;label=32;scalar=64"; what is not said is as there.
void FoamFile::set_architecture(std::string_view text) {
  const auto says = [&](std::string_view part) { return text.find(part) != text.npos; };
  encoding_ = says("MSB") ? Encoding::BigEndian : Encoding::LittleEndian;
  if (says("label=64")) label_ = NumberType::Int64;
  if (says("scalar=32")) scalar_ = NumberType::Float32;
}

void FoamFile::open_parenthesis() {
  if (!scanner_.to_content() || !scanner_.take('('))
    scanner_.fail("'(' is missing; the file is truncated or damaged");
}

void FoamFile::close_parenthesis() {
  scanner_.set_encoding(Encoding::Text);
  if (!scanner_.to_content() || !scanner_.take(')'))
    scanner_.fail("a list does not end with ')' where it should; the file is truncated or damaged");
}

std::int64_t FoamFile::open_list(const char* what, std::size_t values, std::size_t bytes) {
  if (!scanner_.to_content()) scanner_.fail("the file ends too early; it is truncated");
  const std::int64_t n = scanner_.integer();
  open_parenthesis();
  start_values();
  scanner_.require(n, what, values, bytes);
  return n;
}

Index FoamFile::read_label() {
  const std::int64_t value = scanner_.whole(label_);
  // -1 stands for no cell.
  if (value < -1 || value > std::numeric_limits<Index>::max())
    scanner_.fail("number " + std::to_string(value) + " of an element is negative or too large");
  return static_cast<Index>(value);
}

template <class List, class Read>
List FoamFile::read_list(std::int64_t most, const Read& read) {
  if (!scanner_.to_content()) scanner_.fail("the file ends too early; it is truncated");
  Scanner look_ahead = scanner_;
  const std::int64_t n = look_ahead.integer();
  if (look_ahead.to_content() && look_ahead.take('{')) {
    scanner_ = look_ahead;
    if (n < 0 || n > most)
      scanner_.fail(std::to_string(n) + " equal numbers; at most " + std::to_string(most) +
                    " are possible");
    scanner_.to_content();
    start_values();
    const List labels(static_cast<std::size_t>(n), read());
    scanner_.set_encoding(Encoding::Text);
    if (!scanner_.to_content() || !scanner_.take('}')) scanner_.fail("'}' is missing");
    return labels;
  }
  if (n == 0 && encoding_ != Encoding::Text && !Scanner(look_ahead).take('(')) {
    scanner_ = look_ahead;  // an empty list may have no parentheses
    return {};
  }
  List labels(static_cast<std::size_t>(open_list("numbers", 1, size_of(label_))));
  for (auto& label : labels) label = read();
  close_parenthesis();
  return labels;
}

Array<Index> FoamFile::read_labels(std::int64_t most) {
  return read_list<Array<Index>>(most, [&] { return read_label(); });
}

std::vector<std::int64_t> FoamFile::read_ids(std::int64_t most) {
  return read_list<std::vector<std::int64_t>>(most, [&] { return scanner_.whole(label_); });
}

Points FoamFile::read_vectors() {
  const std::int64_t n = open_list("points", 3, 3 * size_of(scalar_));
  Points points(n, 3);
  const bool text = encoding_ == Encoding::Text;
  for (std::int64_t v = 0; v < n; ++v) {
    if (text) open_parenthesis();
    for (int k = 0; k < 3; ++k) {
      points(v, k) = scanner_.real(scalar_);
      if (!std::isfinite(points(v, k)))
        scanner_.fail("point " + std::to_string(v) + ": coordinate " +
                      std::to_string(points(v, k)) + "; every coordinate must be a finite number");
    }
    if (text) close_parenthesis();
  }
  close_parenthesis();
  return points;
}

Csr FoamFile::read_compact_faces() {
  constexpr std::int64_t kNoEqualNumbers = 0;
  Csr faces;
  faces.offsets = read_labels(kNoEqualNumbers);
  if (faces.offsets.empty()) faces.offsets.push_back(0);
  faces.indices = read_labels(kNoEqualNumbers);
  return faces;
}

Csr FoamFile::read_faces() {
  if (class_ == "faceCompactList") return read_compact_faces();
  Csr faces;
  const std::int64_t n = open_list("faces", 1, 3);
  faces.offsets.reserve(static_cast<std::size_t>(n) + 1);
  for (std::int64_t f = 0; f < n; ++f) {
    scanner_.set_encoding(Encoding::Text);
    const std::int64_t size = open_list("vertices of a face", 1, size_of(label_));
    for (std::int64_t k = 0; k < size; ++k) faces.indices.push_back(read_label());
    close_parenthesis();
    if (faces.indices.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      scanner_.fail("more than 2^31 - 1 vertices of faces; split the mesh");
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  close_parenthesis();
  return faces;
}

}  // namespace carat::detail
