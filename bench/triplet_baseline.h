#pragma once
// The textbook assembly that the library is measured against: triplets and sparse products.

#include "carat/mesh/polygon_mesh.h"

namespace carat::bench {

/// Stiffness and mass of the diamond Laplacian, and the seconds of the steps.
struct Baseline {
  SparseMatrix::Plain stiffness, mass;
  double weights_seconds = 0;   ///< affine weights by a dense least-squares solve a face
  double assembly_seconds = 0;  ///< triplets, then P^T G^T M G P and P^T M^ P by sparse products
};

Baseline triplet_baseline(const PolygonMesh& mesh);

}  // namespace carat::bench
