#pragma once
// Products with the sum of what all parts bring, without its matrix. Seen by this folder's sources
// alone.

#include <memory>
#include <vector>

#include "carat/base/symmetric_operator.h"
#include "carat/distributed/part_exchange.h"

namespace carat {

/// Collective. A matrix of PETSc that only multiplies.
/// \param exchange  has to outlive it
PetscMatrix product_of_all(const PartExchange& exchange,
                           std::shared_ptr<const SymmetricOperator> of_part);

/// Makes rows and columns of such a matrix those of the identity times `scale`.
/// \param held  a flag for each of the process's own rows
void hold_rows(Mat product, std::vector<bool> held, double scale);

}  // namespace carat
