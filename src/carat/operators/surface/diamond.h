#pragma once
// The diamond Laplacian on surfaces, as the paper has it or stabilised.

#include <memory>

#include "carat/mesh/polygon_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// \param options  settled; theta < 1 adds the energy of the jumps between the halves of diamonds
std::unique_ptr<Assembly> make_diamond(const char* name, const PolygonMesh& mesh,
                                       const DiscretizationOptions& options);

}  // namespace carat
