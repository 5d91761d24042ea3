#pragma once
// Named values on a mesh, as files and viewers carry them.

#include <string>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// A named array of values, `components` a row: 1 for scalars, 3 for vectors.
struct Field {
  std::string name;
  Index components = 1;
  std::vector<double> values;  ///< row-major, size = rows * components

  Index n_rows() const { return static_cast<Index>(values.size()) / components; }
};

/// The fields that belong to one mesh.
struct MeshFields {
  std::vector<Field> vertex;  ///< one row a vertex
  std::vector<Field> face;    ///< one row a face; surfaces only
  std::vector<Field> cell{};  ///< one row a cell; volumes only
};

}  // namespace carat
