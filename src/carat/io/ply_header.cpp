#include "carat/io/ply_header.h"

#include <array>
#include <string_view>
#include <utility>

namespace carat::detail {
namespace {

NumberType parse_type(Scanner& scanner) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 16> names = {{
      {"char", NumberType::Int8},
      {"int8", NumberType::Int8},
      {"uchar", NumberType::UInt8},
      {"uint8", NumberType::UInt8},
      {"short", NumberType::Int16},
      {"int16", NumberType::Int16},
      {"ushort", NumberType::UInt16},
      {"uint16", NumberType::UInt16},
      {"int", NumberType::Int32},
      {"int32", NumberType::Int32},
      {"uint", NumberType::UInt32},
      {"uint32", NumberType::UInt32},
      {"float", NumberType::Float32},
      {"float32", NumberType::Float32},
      {"double", NumberType::Float64},
      {"float64", NumberType::Float64},
  }};
  const std::string_view word = scanner.word();
  for (const auto& [name, type] : names)
    if (word == name) return type;
  scanner.fail(in_quotes(word) + " is no PLY type such as int or double");
}

Encoding parse_encoding(Scanner& scanner) {
  const std::string_view word = scanner.word();
  if (word == "ascii") return Encoding::Text;
  if (word == "binary_little_endian") return Encoding::LittleEndian;
  if (word == "binary_big_endian") return Encoding::BigEndian;
  scanner.fail("unknown PLY encoding " + in_quotes(word) +
               "; known are ascii, binary_little_endian and binary_big_endian");
}

PlyElement parse_element(Scanner& scanner) {
  PlyElement element;
  element.name = scanner.word();
  element.count = scanner.integer();
  if (element.count < 0) scanner.fail("a negative number of elements; correct the header");
  return element;
}

PlyProperty parse_property(Scanner& scanner) {
  PlyProperty property;
  Scanner look_ahead = scanner;
  if (look_ahead.word() == "list") {
    scanner.word();
    property.is_list = true;
    property.count_type = parse_type(scanner);
    if (!is_integer(property.count_type))
      scanner.fail("the lengths of a list must be whole numbers; correct the header");
  }
  property.type = parse_type(scanner);
  property.name = scanner.word();
  if (property.name.empty()) scanner.fail("a property without a name; correct the header");
  return property;
}

}  // namespace

std::vector<PlyElement> read_ply_header(Scanner& scanner) {
  std::vector<PlyElement> elements;
  Encoding encoding = Encoding::Text;
  bool has_encoding = false;
  scanner.skip_line();
  for (; scanner.to_content(); scanner.skip_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "end_header") {
      if (!has_encoding) scanner.fail("the header has no format line; the file is damaged");
      scanner.skip_line();
      scanner.set_encoding(encoding);
      return elements;
    }
    if (keyword == "format") {
      encoding = parse_encoding(scanner);
      has_encoding = true;
    } else if (keyword == "element") {
      elements.push_back(parse_element(scanner));
    } else if (keyword == "property") {
      if (elements.empty()) scanner.fail("a property before the first element");
      PlyProperty property = parse_property(scanner);
      for (const PlyProperty& other : elements.back().properties)
        if (other.name == property.name)
          scanner.fail("property " + property.name + " is there twice; rename one of them");
      elements.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      scanner.fail(in_quotes(keyword) + " is no PLY header line; the file is damaged");
    }
  }
  scanner.fail("the header has no end_header line; the file is truncated, export it again");
}

}  // namespace carat::detail
