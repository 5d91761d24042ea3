#pragma once
// The attributes of legacy VTK files: what stands behind POINT_DATA and CELL_DATA.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "carat/io/scanner.h"
#include "carat/mesh/fields.h"

namespace carat::detail {

std::string upper_case(std::string_view word);

/// The next word as a type of numbers, e.g. unsigned_char.
NumberType read_vtk_type(Scanner& scanner);

/// Reads attributes of n rows each up to the next POINT_DATA or CELL_DATA, whose keyword it
/// returns, or to the end of the file ("").
std::string read_vtk_attributes(Scanner& scanner, std::int64_t n, std::vector<Field>& fields);

/// Passes over the arrays behind the keyword FIELD.
void skip_vtk_field_data(Scanner& scanner);

/// Passes over a block METADATA, which an empty line ends: one that may follow, or the rest of one
/// whose keyword is read.
void skip_vtk_metadata(Scanner& scanner);
void skip_vtk_metadata_block(Scanner& scanner);

}  // namespace carat::detail
