#pragma once
// Sparse matrices as Matrix Market files.

#include <filesystem>
#include <string_view>

#include "carat/base/types.h"

namespace carat {

enum class MatrixSymmetry {
  General,   ///< every stored entry is written
  Symmetric  ///< the lower triangle is written; the caller vouches for the upper one
};

/// Writes "matrix coordinate real" with 1-based rows and columns, row by row, each value as the
/// shortest text that reads back bit by bit. The file appears only when it is complete.
/// \param comment  what the matrix is; each of its lines becomes a comment line
/// \throws InvalidOption  a symmetric matrix that is not square; an entry that is not finite
/// \throws IoError        the file cannot be written
/// Cost: O(entries).
void write_matrix_market(const std::filesystem::path& path, const SparseMatrix& matrix,
                         MatrixSymmetry symmetry = MatrixSymmetry::General,
                         std::string_view comment = {});

}  // namespace carat
