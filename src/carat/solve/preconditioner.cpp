#include "carat/solve/preconditioner.h"

namespace carat {

void Preconditioner::apply_block(const Vector& r, Vector& z, Index k) const {
  if (k == 1) {
    apply(r, z);
    return;
  }
  const Eigen::Index n = r.size() / k;
  z.resize(r.size());
  Vector own, result;
  for (Index j = 0; j < k; ++j) {
    const Eigen::Map<const Vector, 0, Eigen::InnerStride<>> from(r.data() + j, n,
                                                                 Eigen::InnerStride<>(k));
    own = from;
    apply(own, result);
    Eigen::Map<Vector, 0, Eigen::InnerStride<>>(z.data() + j, n, Eigen::InnerStride<>(k)) = result;
  }
}

}  // namespace carat
