#pragma once
// Matrices as .npy files, which NumPy loads or maps into memory; for Matlab there is readNPY.

#include <filesystem>
#include <functional>

#include "carat/base/types.h"

namespace carat {

/// Takes the next row. \param values  (columns)
using PutRow = std::function<void(const Vector& values)>;

/// Writes a matrix of shape (rows, columns), float64 in C order, whose rows come one after the
/// other, so that it need not fit into memory. The file appears only when it is complete.
/// \param produce  calls its argument once a row
/// \throws IoError        the file cannot be written, or is larger than the free space
/// \throws InvalidOption  rows of another length, or another number of them
void write_npy(const std::filesystem::path& path, Index rows, Index columns,
               const std::function<void(const PutRow& put)>& produce);

}  // namespace carat
