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
  std::int64_t n_entries = 0;
  for_each_entry(matrix, symmetry, [&](Index, Index, double) { ++n_entries; });
  write_matrix_market(path, matrix.rows(), matrix.cols(), n_entries, symmetry, comment,
                      [&](const PutEntry& put) { for_each_entry(matrix, symmetry, put); });
}

void write_matrix_market(const std::filesystem::path& path, std::int64_t rows, std::int64_t columns,
                         std::int64_t n_entries, MatrixSymmetry symmetry, std::string_view comment,
                         const std::function<void(const PutEntry& put)>& produce) {
  const bool symmetric = symmetry == MatrixSymmetry::Symmetric;
  if (symmetric && rows != columns)
    throw InvalidOption(path.string() + ": a symmetric matrix must be square, this one is " +
                        std::to_string(rows) + " x " + std::to_string(columns) +
                        "; write it as general");
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    try {
      detail::BufferedWriter out(temporary);
      out.put("%%MatrixMarket matrix coordinate real ");
      out.put(symmetric ? "symmetric\n" : "general\n");
      put_comment(out, comment);
      out.put(rows).put(' ').put(columns).put(' ').put(n_entries).put('\n');
      std::int64_t n_put = 0;
      produce([&](std::int64_t row, std::int64_t column, double value) {
        if (!std::isfinite(value))
          throw InvalidOption(path.string() + ": entry (" + std::to_string(row) + ", " +
                                  std::to_string(column) + ") is " + std::to_string(value) +
                                  "; only finite entries can be written",
                              {static_cast<Index>(row), static_cast<Index>(column)});
        ++n_put;
        out.put(row + 1).put(' ').put(column + 1);
        out.put(' ').put(value).put('\n');
      });
      if (n_put != n_entries)
        throw InvalidOption(path.string() + ": " + std::to_string(n_put) + " entries instead of " +
                            std::to_string(n_entries));
      out.close();
    } catch (const IoError& error) {
      throw IoError(path.string() + ": " + error.what());
    }
  });
}

}  // namespace carat
