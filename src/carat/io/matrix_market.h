#pragma once
// Sparse matrices as Matrix Market files.

#include <cstdint>
#include <filesystem>
#include <functional>
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

/// Takes the next entry, numbered from 0.
using PutEntry = std::function<void(std::int64_t row, std::int64_t column, double value)>;

/// The same of entries that come one after the other, so that the matrix need not fit into memory.
/// \param n_entries  how many are put; of a symmetric matrix those of the lower triangle
/// \param produce    calls its argument once an entry
/// \throws  as above; InvalidOption also for another number of entries
void write_matrix_market(const std::filesystem::path& path, std::int64_t rows, std::int64_t columns,
                         std::int64_t n_entries, MatrixSymmetry symmetry, std::string_view comment,
                         const std::function<void(const PutEntry& put)>& produce);

}  // namespace carat
