#include "carat/io/vtk_attributes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace carat::detail {
namespace {

struct ArrayHeader {
  std::string name;
  std::int64_t components = 1, rows = 0;
};

/// Names are written with %20 for a blank, and so on.
std::string decode_name(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char code = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      name += static_cast<char>(code);
      i += 2;
    } else {
      name += text[i];
    }
  }
  return name;
}

std::string read_name(Scanner& scanner) {
  const std::string_view word = scanner.word();
  if (word.empty()) scanner.fail("an array without a name; the file is damaged");
  return decode_name(word);
}

void require_room(const Scanner& scanner, const ArrayHeader& array, NumberType type) {
  scanner.require(array.components, "components", 1, 1);
  const auto components = static_cast<std::size_t>(array.components);
  scanner.require(array.rows, "rows of an array", components, components * size_of(type));
  if (components == 0) scanner.fail("an array of 0 components; the file is damaged");
}

Field read_values(Scanner& scanner, ArrayHeader array, NumberType type) {
  scanner.start_values();
  require_room(scanner, array, type);
  Field field{std::move(array.name), static_cast<Index>(array.components), {}};
  field.values.resize(static_cast<std::size_t>(array.rows * array.components));
  for (double& value : field.values) value = scanner.real(type);
  return field;
}

Field read_scalars(Scanner& scanner, std::int64_t n) {
  ArrayHeader array{read_name(scanner), 1, n};
  const NumberType type = read_vtk_type(scanner);
  if (!scanner.at_line_end()) array.components = scanner.integer();
  Scanner look_ahead = scanner;
  if (look_ahead.to_content() && upper_case(look_ahead.word()) == "LOOKUP_TABLE") {
    scanner.to_content();
    scanner.word();
    read_name(scanner);
  }
  return read_values(scanner, std::move(array), type);
}

/// Colours are numbers from 0 to 1 in text and bytes in binary; both become 0 to 255.
Field read_colours(Scanner& scanner, std::int64_t n) {
  ArrayHeader array{read_name(scanner), scanner.integer(), n};
  Field field = read_values(scanner, std::move(array), NumberType::UInt8);
  if (scanner.encoding() == Encoding::Text)
    for (double& value : field.values) value = std::floor(255 * value + 0.5);
  return field;
}

void skip_lookup_table(Scanner& scanner) {
  ArrayHeader array{read_name(scanner), 4, scanner.integer()};
  scanner.start_values();
  require_room(scanner, array, NumberType::UInt8);
  scanner.skip_values(array.rows * 4, NumberType::UInt8);
}

/// Reads the arrays behind FIELD; `fields` may be null to pass over them.
void read_field_data(Scanner& scanner, std::int64_t n, std::vector<Field>* fields) {
  read_name(scanner);
  const std::int64_t n_arrays = scanner.integer();
  scanner.require(n_arrays, "arrays", 4, 8);
  for (std::int64_t i = 0; i < n_arrays; ++i) {
    skip_vtk_metadata(scanner);
    if (!scanner.to_content()) scanner.fail("the file ends before its last array; export it again");
    ArrayHeader array{read_name(scanner)};
    array.components = scanner.integer();
    array.rows = scanner.integer();
    const NumberType type = read_vtk_type(scanner);
    if (fields == nullptr) {
      scanner.start_values();
      require_room(scanner, array, type);
      scanner.skip_values(array.rows * array.components, type);
      continue;
    }
    if (array.rows != n)
      scanner.fail("array " + in_quotes(array.name) + " has " + std::to_string(array.rows) +
                   " rows, the mesh needs " + std::to_string(n) + "; the file is damaged");
    fields->push_back(read_values(scanner, std::move(array), type));
  }
}

}  // namespace

std::string upper_case(std::string_view word) {
  std::string result(word);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

NumberType read_vtk_type(Scanner& scanner) {
  // vtkIdType is written with 32 bits, whatever it has in memory.
  static constexpr std::array<std::pair<std::string_view, NumberType>, 25> names = {{
      {"CHAR", NumberType::Int8},
      {"SIGNED_CHAR", NumberType::Int8},
      {"UNSIGNED_CHAR", NumberType::UInt8},
      {"SHORT", NumberType::Int16},
      {"UNSIGNED_SHORT", NumberType::UInt16},
      {"INT", NumberType::Int32},
      {"UNSIGNED_INT", NumberType::UInt32},
      {"LONG", NumberType::Int64},
      {"UNSIGNED_LONG", NumberType::UInt64},
      {"LONGLONG", NumberType::Int64},
      {"LONG_LONG", NumberType::Int64},
      {"UNSIGNEDLONGLONG", NumberType::UInt64},
      {"UNSIGNED_LONG_LONG", NumberType::UInt64},
      {"VTKIDTYPE", NumberType::Int32},
      {"VTKTYPEINT8", NumberType::Int8},
      {"VTKTYPEUINT8", NumberType::UInt8},
      {"VTKTYPEINT16", NumberType::Int16},
      {"VTKTYPEUINT16", NumberType::UInt16},
      {"VTKTYPEINT32", NumberType::Int32},
      {"VTKTYPEUINT32", NumberType::UInt32},
      {"VTKTYPEINT64", NumberType::Int64},
      {"VTKTYPEUINT64", NumberType::UInt64},
      {"FLOAT", NumberType::Float32},
      {"DOUBLE", NumberType::Float64},
      {"VTKTYPEFLOAT64", NumberType::Float64},
  }};
  const std::string word = upper_case(scanner.word());
  for (const auto& [name, type] : names)
    if (word == name) return type;
  scanner.fail("an array of type " + in_quotes(word) +
               "; only numbers such as double are supported, export without it");
}

std::string read_vtk_attributes(Scanner& scanner, std::int64_t n, std::vector<Field>& fields) {
  const auto read_tuples = [&](std::int64_t components) {
    ArrayHeader array{read_name(scanner), components, n};
    const NumberType type = read_vtk_type(scanner);
    fields.push_back(read_values(scanner, std::move(array), type));
  };
  while (scanner.to_content()) {
    std::string keyword = upper_case(scanner.word());
    if (keyword == "POINT_DATA" || keyword == "CELL_DATA") return keyword;
    if (keyword == "SCALARS") {
      fields.push_back(read_scalars(scanner, n));
    } else if (keyword == "VECTORS" || keyword == "NORMALS") {
      read_tuples(3);
    } else if (keyword == "TENSORS") {
      read_tuples(9);
    } else if (keyword == "TENSORS6") {
      read_tuples(6);
    } else if (keyword == "GLOBAL_IDS" || keyword == "PEDIGREE_IDS" || keyword == "EDGE_FLAGS") {
      read_tuples(1);
    } else if (keyword == "TEXTURE_COORDINATES") {
      ArrayHeader array{read_name(scanner), scanner.integer(), n};
      const NumberType type = read_vtk_type(scanner);
      fields.push_back(read_values(scanner, std::move(array), type));
    } else if (keyword == "COLOR_SCALARS") {
      fields.push_back(read_colours(scanner, n));
    } else if (keyword == "LOOKUP_TABLE") {
      skip_lookup_table(scanner);
    } else if (keyword == "FIELD") {
      read_field_data(scanner, n, &fields);
    } else if (keyword == "METADATA") {
      skip_vtk_metadata_block(scanner);
    } else {
      scanner.fail(in_quotes(keyword) + " is no VTK attribute; the file is damaged");
    }
  }
  return {};
}

void skip_vtk_field_data(Scanner& scanner) { read_field_data(scanner, 0, nullptr); }

void skip_vtk_metadata(Scanner& scanner) {
  Scanner look_ahead = scanner;
  if (!look_ahead.to_content() || upper_case(look_ahead.word()) != "METADATA") return;
  scanner = look_ahead;
  skip_vtk_metadata_block(scanner);
}

void skip_vtk_metadata_block(Scanner& scanner) {
  do {
    scanner.skip_line();
  } while (!scanner.at_line_end());
}

}  // namespace carat::detail
