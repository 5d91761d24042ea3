#include "carat/io/matrix_market.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"

namespace carat {
namespace {

void put_comment(detail::BufferedWriter& out, std::string_view comment) {
  while (!comment.empty()) {
    const std::string_view line = comment.substr(0, comment.find('\n'));
    out.put("% ").put(line).put('\n');
    comment.remove_prefix(std::min(comment.size(), line.size() + 1));
  }
}

/// Calls visit(row, column, value) for every entry to be written.
template <class Visit>
void for_each_entry(const SparseMatrix& matrix, MatrixSymmetry symmetry, Visit&& visit) {
  for (Index row = 0; row < matrix.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(matrix, row); entry; ++entry)
      if (symmetry == MatrixSymmetry::General || entry.col() <= row)
        visit(row, static_cast<Index>(entry.col()), entry.value());
}

}  // namespace

void write_matrix_market(const std::filesystem::path& path, const SparseMatrix& matrix,
                         MatrixSymmetry symmetry, std::string_view comment) {
  const bool symmetric = symmetry == MatrixSymmetry::Symmetric;
  if (symmetric && matrix.rows() != matrix.cols())
    throw InvalidOption(path.string() + ": a symmetric matrix must be square, this one is " +
                        std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
                        "; write it as general");
  std::int64_t n_entries = 0;
  for_each_entry(matrix, symmetry, [&](Index row, Index column, double value) {
    ++n_entries;
    if (!std::isfinite(value))
      throw InvalidOption(path.string() + ": entry (" + std::to_string(row) + ", " +
                              std::to_string(column) + ") is " + std::to_string(value) +
                              "; only finite entries can be written",
                          {row, column});
  });
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    try {
      detail::BufferedWriter out(temporary);
      out.put("%%MatrixMarket matrix coordinate real ");
      out.put(symmetric ? "symmetric\n" : "general\n");
      put_comment(out, comment);
      out.put(matrix.rows()).put(' ').put(matrix.cols()).put(' ').put(n_entries).put('\n');
      for_each_entry(matrix, symmetry, [&](Index row, Index column, double value) {
        out.put(std::int64_t{row} + 1).put(' ').put(std::int64_t{column} + 1);
        out.put(' ').put(value).put('\n');
      });
      out.close();
    } catch (const IoError& error) {
      throw IoError(path.string() + ": " + error.what());
    }
  });
}

}  // namespace carat
