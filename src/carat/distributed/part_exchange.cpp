#include "carat/distributed/part_exchange.h"

#include "carat/distributed/processes.h"

namespace carat {

PartExchange::PartExchange(const PartNumbers& numbers)
    : n_own_(numbers.end_row - numbers.first_row),
      n_all_(numbers.n_vertices),
      rows_(numbers.vertex_rows.begin(), numbers.vertex_rows.end()) {
  const PetscInt n = static_cast<PetscInt>(rows_.size());
  check(VecCreateSeq(PETSC_COMM_SELF, n, here_.out()));
  PetscIndices whole;
  check(ISCreateGeneral(PETSC_COMM_WORLD, n, rows_.data(), PETSC_COPY_VALUES, whole.out()));
  const PetscVector pattern = vector();
  check(VecScatterCreate(pattern, whole, here_, nullptr, scatter_.out()));
}

PetscVector PartExchange::vector() const {
  PetscVector vector;
  check(VecCreateMPI(PETSC_COMM_WORLD, n_own_, n_all_, vector.out()));
  check(VecSet(vector, 0));
  return vector;
}

void PartExchange::to_part(Vec values, Vector& here) const {
  check(VecScatterBegin(scatter_, values, here_, INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(scatter_, values, here_, INSERT_VALUES, SCATTER_FORWARD));
  here = OwnRows(here_).values();
}

Vector PartExchange::to_part(Vec values) const {
  Vector here;
  to_part(values, here);
  return here;
}

void PartExchange::sum(const Vector& of_part, Vec into) const {
  OwnRows(here_).values() = of_part;
  check(VecSet(into, 0));
  check(VecScatterBegin(scatter_, here_, into, ADD_VALUES, SCATTER_REVERSE));
  check(VecScatterEnd(scatter_, here_, into, ADD_VALUES, SCATTER_REVERSE));
}

PetscVector PartExchange::sum(const Vector& of_part) const {
  PetscVector result = vector();
  sum(of_part, result);
  return result;
}

PetscMatrix PartExchange::sum(const SparseMatrix& of_part) const {
  PetscMatrix matrix;
  check(MatCreate(PETSC_COMM_WORLD, matrix.out()));
  check(MatSetSizes(matrix, n_own_, n_own_, n_all_, n_all_));
  check(MatSetType(matrix, MATMPIAIJ));
  // Entries of another part's interfaces are zeros and stay here; own rows have a diagonal.
  std::vector<PetscInt> row_of, column_of;
  std::vector<double> values;
  row_of.reserve(static_cast<std::size_t>(of_part.nonZeros()));
  column_of.reserve(row_of.capacity());
  values.reserve(row_of.capacity());
  for (Index row = 0; row < of_part.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(of_part, row); entry; ++entry) {
      if (entry.value() == 0) continue;
      row_of.push_back(rows_[static_cast<std::size_t>(row)]);
      column_of.push_back(rows_[static_cast<std::size_t>(entry.col())]);
      values.push_back(entry.value());
    }
  PetscInt first = 0;
  {
    const PetscVector pattern = vector();
    check(VecGetOwnershipRange(pattern, &first, nullptr));
  }
  for (PetscInt row = first; row < first + n_own_; ++row) {
    row_of.push_back(row);
    column_of.push_back(row);
    values.push_back(0);
  }
  together([&] { require_countable("entries of the matrix", values.size(), PETSC_MAX_INT); });
  check(MatSetPreallocationCOO(matrix, static_cast<PetscCount>(values.size()), row_of.data(),
                               column_of.data()));
  check(MatSetValuesCOO(matrix, values.data(), ADD_VALUES));
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

}  // namespace carat
