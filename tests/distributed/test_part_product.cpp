#include "carat/distributed/part_product.h"
#include "carat/operators/part_discretization.h"
#include "parts.h"

namespace carat::test {
namespace {

// Also where a preconditioner or a user's vector is not zero at the rows that are held.
TEST(PartProduct, multiplies_as_the_sum_of_all_matrices_does) {
  const PolyhedralMesh mesh = generate_volume("cube-truncated", {.level = 0, .jitter = 0.1});
  const auto part = own_block(mesh);
  DiscretizationOptions options;
  const SparseMatrix matrix = discretize_part(part, "diamond", options).stiffness;
  options.form = OperatorForm::Products;
  const PartExchange exchange(part.numbers);
  PetscMatrix product =
      product_of_all(exchange, discretize_part(part, "diamond", options).stiffness_product);
  PetscMatrix sum = exchange.sum(matrix);

  const PetscVector x = exchange.vector(), y = exchange.vector(), expected = exchange.vector();
  const Index first = part.numbers.first_row;
  {
    const OwnRows own(x);
    for (Index row = 0; row < own.values().size(); ++row)
      own.values()[row] = std::sin(1.0 + 3 * (first + row));
  }
  const auto difference = [&] {
    double largest = 0, size = 0;
    carat::check(MatMult(product, x, y));
    carat::check(MatMult(sum, x, expected));
    carat::check(VecNorm(expected, NORM_INFINITY, &size));
    carat::check(VecAXPY(y, -1, expected));
    carat::check(VecNorm(y, NORM_INFINITY, &largest));
    return largest / size;
  };
  EXPECT_LT(difference(), 1e-13);

  std::vector<bool> held(static_cast<std::size_t>(exchange.n_own()), false);
  std::vector<PetscInt> rows;
  for (std::size_t row = 0; row < held.size(); row += 3) {
    held[row] = true;
    rows.push_back(first + static_cast<PetscInt>(row));
  }
  hold_rows(product, held, 0.75);
  carat::check(MatZeroRowsColumns(sum, static_cast<PetscInt>(rows.size()), rows.data(), 0.75,
                                  nullptr, nullptr));
  EXPECT_LT(difference(), 1e-13);
}

}  // namespace
}  // namespace carat::test
