#include "carat/distributed/part_product.h"

#include <utility>

namespace carat {
namespace {

struct Product {
  const PartExchange& exchange;
  std::shared_ptr<const SymmetricOperator> of_part;
  std::vector<bool> held{};
  double scale = 0;
  PetscVector free{};  // the vector without its held rows
  Vector in{}, out{};  // at the part's vertices
};

Product& product_in(Mat matrix) {
  Product* product = nullptr;
  check(MatShellGetContext(matrix, &product));
  return *product;
}

PetscErrorCode multiply(Mat matrix, Vec x, Vec y) {
  try {
    Product& it = product_in(matrix);
    if (it.held.empty()) {
      it.exchange.to_part(x, it.in);
    } else {
      check(VecCopy(x, it.free));
      {
        const OwnRows own(it.free);
        for (std::size_t row = 0; row < it.held.size(); ++row)
          if (it.held[row]) own.values()[static_cast<Index>(row)] = 0;
      }
      it.exchange.to_part(it.free, it.in);
    }
    it.of_part->multiply(it.in.data(), it.out.data(), 1);
    it.exchange.sum(it.out, y);
    if (it.held.empty()) return 0;
    const double* given = nullptr;
    check(VecGetArrayRead(x, &given));
    {
      const OwnRows own(y);
      for (std::size_t row = 0; row < it.held.size(); ++row)
        if (it.held[row]) own.values()[static_cast<Index>(row)] = it.scale * given[row];
    }
    check(VecRestoreArrayRead(x, &given));
    return 0;
  } catch (const std::exception&) {
    return PETSC_ERR_LIB;
  }
}

PetscErrorCode destroy(Mat matrix) {
  delete &product_in(matrix);
  return 0;
}

}  // namespace

PetscMatrix product_of_all(const PartExchange& exchange,
                           std::shared_ptr<const SymmetricOperator> of_part) {
  auto product = std::make_unique<Product>(Product{exchange, std::move(of_part)});
  product->free = exchange.vector();
  product->in.resize(exchange.n_here());
  product->out.resize(exchange.n_here());
  const Index n = exchange.n_own();
  PetscMatrix matrix;
  check(MatCreateShell(PETSC_COMM_WORLD, n, n, PETSC_DETERMINE, PETSC_DETERMINE, product.get(),
                       matrix.out()));
  product.release();  // its matrix destroys it
  check(MatShellSetOperation(matrix, MATOP_DESTROY, reinterpret_cast<void (*)()>(destroy)));
  check(MatShellSetOperation(matrix, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

void hold_rows(Mat product, std::vector<bool> held, double scale) {
  Product& it = product_in(product);
  it.held = std::move(held);
  it.scale = scale;
}

}  // namespace carat
