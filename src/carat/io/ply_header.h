#pragma once
// The header of a PLY file: which elements it holds and which values each of them has.

#include <string>
#include <vector>

#include "carat/io/scanner.h"

namespace carat::detail {

struct PlyProperty {
  std::string name;
  NumberType type = NumberType::Float32;
  bool is_list = false;
  NumberType count_type = NumberType::UInt8;  ///< of lists
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// Reads up to and including the line "end_header" and sets the scanner's encoding.
/// \throws IoError  malformed header
std::vector<PlyElement> read_ply_header(Scanner& scanner);

}  // namespace carat::detail
