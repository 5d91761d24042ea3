#pragma once
// Index and matrix types shared by every layer.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "carat/base/memory.h"

namespace carat {

/// Numbers vertices, edges, faces, corners and matrix entries. 32 bit: whatever would not fit is
/// refused with a typed error before any arithmetic on it can overflow.
using Index = std::int32_t;

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// Positions, one row a point, contiguous like a C-ordered (n, 3) array.  [length]
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Compressed sparse rows, columns ascending in each row. An Eigen matrix that can be moved: the
/// moves of Eigen 3.4 copy, which would double the memory of every assembled operator.
class SparseMatrix : public Eigen::SparseMatrix<double, Eigen::RowMajor, std::int32_t> {
 public:
  using Plain = Eigen::SparseMatrix<double, Eigen::RowMajor, std::int32_t>;
  using Plain::Plain;
  using Plain::operator=;
  SparseMatrix() = default;
  SparseMatrix(const SparseMatrix&) = default;
  SparseMatrix& operator=(const SparseMatrix&) = default;
  SparseMatrix(SparseMatrix&& other) noexcept { Plain::swap(other); }
  SparseMatrix& operator=(SparseMatrix&& other) noexcept {
    Plain::swap(other);
    return *this;
  }
};

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Rows of different length over one array: row i is indices[offsets[i] .. offsets[i+1]).
struct Csr {
  Array<Index> offsets{0};
  Array<Index> indices;

  Index n_rows() const { return static_cast<Index>(offsets.size()) - 1; }
  Index begin(Index row) const { return offsets[static_cast<std::size_t>(row)]; }
  Index end(Index row) const { return offsets[static_cast<std::size_t>(row) + 1]; }
  Index size(Index row) const { return end(row) - begin(row); }
  std::span<const Index> row(Index row) const {
    return {indices.data() + begin(row), static_cast<std::size_t>(size(row))};
  }
};

/// Two cells of a face. The face's normal, by the right-hand rule from the order of its vertices,
/// points out of `below` and into `above`; -1: none. Boundary faces have one cell.
struct FaceCells {
  Index below, above;
  Index other(Index cell) const { return cell == below ? above : below; }
  bool boundary() const { return (below < 0) != (above < 0); }
};

}  // namespace carat
