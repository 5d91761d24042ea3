#pragma once
// The diamond Laplacian in volumes, as the paper has it or stabilised.

#include <memory>

#include "carat/mesh/polyhedral_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// \param options  settled; theta < 1 adds the energy of the jumps between the halves of diamonds
std::unique_ptr<Assembly> make_diamond(const char* name, const PolyhedralMesh& mesh,
                                       const DiscretizationOptions& options);

}  // namespace carat
