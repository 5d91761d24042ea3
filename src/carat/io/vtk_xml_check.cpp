#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

#include "carat/base/error.h"
#include "carat/io/scanner.h"
#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"

namespace carat::detail {
namespace {

// No compressor that VTK knows packs more than this many bytes into one.
constexpr std::int64_t kHighestCompression = 8192;

std::string_view attribute(vtkXMLDataElement* element, const char* name) {
  const char* const text = element->GetAttribute(name);
  return text == nullptr ? std::string_view() : std::string_view(text);
}

/// A count in the file, 0 if it is not there.
std::int64_t read_count(vtkXMLDataElement* element, const char* name, std::int64_t limit) {
  const std::string_view text = attribute(element, name);
  if (text.empty()) return 0;
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  const std::string what = std::string(name) + " of " + element->GetName() + " is ";
  if (status != std::errc() || stop != end || value < 0)
    throw IoError(what + in_quotes(text) + ", which is no count; the file is damaged");
  if (value > limit)
    throw IoError(what + std::string(text) +
                  ", more than the file can hold; it is truncated or damaged, export it again");
  return value;
}

/// Decodes whole groups of four characters, as far as they go.
std::string decode_base64(std::string_view text) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t digit = digits.find(text[i]);
    if (digit == digits.npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if (i % 4 != 3) continue;
    for (const int shift : {16, 8, 0}) bytes += static_cast<char>(bits >> shift & 0xff);
  }
  return bytes;
}

/// Compares what a file announces with what it can hold. The readers of VTK allocate the former,
/// and divide by block sizes.
class Checker {
 public:
  Checker(const FileContent& file, vtkXMLDataParser* parser)
      : file_(file), root_(parser->GetRootElement()), appended_(parser->GetAppendedDataPosition()) {
    compressed_ = !attribute(root_, "compressor").empty();
    large_words_ = attribute(root_, "header_type") == "UInt64";
    big_endian_ = attribute(root_, "byte_order") == "BigEndian";
    for (int i = 0; i < root_->GetNumberOfNestedElements(); ++i) {
      vtkXMLDataElement* const element = root_->GetNestedElement(i);
      if (std::strcmp(element->GetName(), "AppendedData") == 0)
        raw_ = attribute(element, "encoding") == "raw";
    }
    limit_ =
        compressed_ ? most_vtk_values(file.bytes) : static_cast<std::int64_t>(file.bytes.size());
  }

  void check() const { check_element(root_, 0, 0); }

 private:
  /// \param rows  the largest number of rows announced above this element
  void check_element(vtkXMLDataElement* element, std::int64_t rows, int depth) const {
    if (depth > 32) throw IoError("XML elements are nested more than 32 deep; the file is damaged");
    rows = std::max(rows, read_count(element, "NumberOfPoints", limit_ / 3));
    for (const char* name : {"NumberOfCells", "NumberOfVerts", "NumberOfLines", "NumberOfStrips",
                             "NumberOfPolys", "NumberOfTuples"})
      rows = std::max(rows, read_count(element, name, limit_));
    read_count(element, "NumberOfComponents", limit_ / std::max<std::int64_t>(rows, 1));
    if (compressed_ && std::strcmp(element->GetName(), "DataArray") == 0) check_blocks(element);
    for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
      check_element(element->GetNestedElement(i), rows, depth + 1);
  }

  /// The bytes in front of compressed blocks: their number, size, and the last one's size.
  void check_blocks(vtkXMLDataElement* array) const {
    const std::size_t word = large_words_ ? 8 : 4;
    const bool appended = !attribute(array, "offset").empty();
    if (!appended && attribute(array, "format") != "binary") return;
    const std::string_view data = appended ? appended_data(array) : inline_data(array);
    // Four characters of base64 stand for three bytes.
    const std::string header = appended && raw_ ? std::string(data.substr(0, 3 * word))
                                                : decode_base64(data.substr(0, 4 * word));
    if (header.size() < 3 * word) return;  // the reader reports the end of the file
    Scanner scanner(header);
    scanner.set_encoding(big_endian_ ? Encoding::BigEndian : Encoding::LittleEndian);
    const auto next = [&] {
      return scanner.whole(large_words_ ? NumberType::Int64 : NumberType::UInt32);
    };
    const std::int64_t n = next(), size = next(), last = next();
    const auto available = static_cast<std::int64_t>(data.size() / word);
    const bool empty = n == 0 && last == 0;
    const bool fits = n > 0 && n <= available && size > 0 && last >= 0 && last <= size &&
                      (n == 1 || size <= limit_ / (n - 1)) && (last > 0 ? last : size) <= limit_;
    if (!empty && !fits)
      throw IoError("the compressed blocks of array " + in_quotes(attribute(array, "Name")) + " (" +
                    std::to_string(n) + " of " + std::to_string(size) +
                    " bytes) cannot be in the file; it is truncated or damaged, export it again");
  }

  std::string_view from(std::int64_t position) const {
    position -= static_cast<std::int64_t>(file_.start);
    const auto size = static_cast<std::int64_t>(file_.bytes.size());
    return file_.bytes.substr(
        static_cast<std::size_t>(std::clamp<std::int64_t>(position, 0, size)));
  }

  std::string_view appended_data(vtkXMLDataElement* array) const {
    const auto size = static_cast<std::int64_t>(file_.bytes.size());
    return from(appended_ + read_count(array, "offset", size));
  }

  std::string_view inline_data(vtkXMLDataElement* array) const {
    std::string_view data = from(array->GetXMLByteIndex());
    data.remove_prefix(std::min(data.find('>'), data.size() - 1) + 1);
    data.remove_prefix(std::min(data.find_first_not_of(" \t\r\n"), data.size()));
    return data;
  }

  const FileContent& file_;
  vtkXMLDataElement* root_;
  std::int64_t appended_;
  std::int64_t limit_ = 0;  ///< number of values that the file can hold
  bool compressed_ = false, large_words_ = false, big_endian_ = false, raw_ = false;
};

}  // namespace

std::int64_t most_vtk_values(std::string_view content) {
  return static_cast<std::int64_t>(content.size()) * kHighestCompression;
}

std::string_view vtk_file_type(std::string_view content) {
  content = content.substr(0, 4096);
  const std::size_t start = content.find("<VTKFile");
  if (start == content.npos) return {};
  content = content.substr(start, content.find('>', start) - start);
  for (const std::string_view key : {" type=\"", " type='"}) {
    const std::size_t value = content.find(key);
    if (value == content.npos) continue;
    const std::string_view rest = content.substr(value + key.size());
    return rest.substr(0, rest.find_first_of("\"'"));
  }
  return "?";
}

namespace {

/// Parses the XML elements of a file of that type.
void parse(const FileContent& file, const char* type, VtkSession& session,
           vtkXMLDataParser* parser) {
  const std::string_view found = vtk_file_type(file.bytes);
  if (found.empty()) throw IoError("holds no element VTKFile, so it is no VTK XML file");
  if (found != type)
    throw IoError("holds VTK data of type " + in_quotes(found) +
                  "; PolyData or UnstructuredGrid is needed, extract the surface first");
  parser->AddObserver(vtkCommand::ErrorEvent, session.observer());
  parser->SetFileName(file.path.c_str());
  const bool parsed = parser->Parse() == 1;
  session.check();
  if (!parsed || parser->GetRootElement() == nullptr)
    throw IoError("malformed XML; the file is truncated or damaged, export it again");
}

}  // namespace

vtkSmartPointer<vtkXMLDataElement> parse_vtk_xml(const FileContent& file, const char* type,
                                                 VtkSession& session) {
  vtkNew<vtkXMLDataParser> parser;
  parse(file, type, session, parser);
  return parser->GetRootElement();
}

void check_vtk_xml(const FileContent& file, const char* type, VtkSession& session) {
  vtkNew<vtkXMLDataParser> parser;
  parse(file, type, session, parser);
  Checker(file, parser).check();
}

}  // namespace carat::detail
