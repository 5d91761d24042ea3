#pragma once
// Matrices of the whole mesh in the order of its numbers, for files.

#include <cstdint>
#include <functional>
#include <vector>

namespace carat {

struct MatrixEntry {
  std::int64_t row, column;
  double value;
};

/// A matrix that is the sum of what all parts bring, as a block of consecutive rows a process.
class MatrixRows {
 public:
  /// Collective. \param entries  what this process brings, in any order, some perhaps twice
  MatrixRows(const std::vector<MatrixEntry>& entries, std::int64_t n_rows);

  std::int64_t n_entries() const { return n_entries_; }  ///< of the whole matrix
  /// Collective. The first process visits all entries by rows and columns; it holds one process's
  /// rows a few at a time, never all.
  void visit(const std::function<void(const MatrixEntry&)>& visit) const;

 private:
  std::vector<MatrixEntry> entries_;  // of the own rows, in order
  std::int64_t n_entries_ = 0;
};

}  // namespace carat
