#pragma once
// The textbook assembly in volumes that the library is measured against: triplets and products.

#include "carat/mesh/polyhedral_mesh.h"
#include "triplet_baseline.h"

namespace carat::bench {

/// Weights by dense least-squares solves a face and a cell, then P = P_C P_F, G, D, S = -D G and M
/// by triplets and sparse products.
Baseline triplet_baseline(const PolyhedralMesh& mesh);

}  // namespace carat::bench
