#include "carat/base/error.h"
#include "carat/operators/registry.h"

namespace carat {

const VolumeOperator diamond_volume_operator = {
    "diamond",
    "Diamond Laplacian: gradients on the minimal diamonds of faces",
    "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    [](const PolyhedralMesh&, const DiscretizationOptions&) -> std::unique_ptr<Assembly> {
      throw InvalidOption("not available");
    }};

}  // namespace carat
