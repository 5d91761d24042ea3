#pragma once
// Files that list vertices to measure distances from.

#include <string>
#include <vector>

#include "carat/apps/heat_geodesics.h"

namespace carat::cli {

/// One set of sources a line: vertices, counted from 0. Empty lines and what follows a # are passed
/// over.
/// \throws IoError  the file cannot be read, lists nothing, or names a vertex that does not exist:
///                  with the line
std::vector<std::vector<GeodesicSource>> read_source_sets(const std::string& path,
                                                          Index n_vertices);

}  // namespace carat::cli
