// The diamond Laplacian in volumes with the jumps between the halves of its diamonds.

#include "carat/operators/registry.h"
#include "carat/operators/volume/diamond.h"

namespace carat {

extern const VolumeOperator stabilized_diamond_volume_operator = {
    "stabilized_diamond",
    "Diamond Laplacian that resists jumps of the derivative inside diamonds",
    "after Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    {.masses = {MassKind::MomentExact, MassKind::Full, MassKind::Lumped},
     .virtual_vertex = true,
     .theta = 2.0 / 3,
     .tau = 1.0,
     .products = true,
     .own_interfaces = true},
    {"S = theta S_diamond + (1 - theta) S_bunge: the diamond's gradient, and a row a diamond for "
     "the "
     "jump of the derivative across the face, which the diamond averages away. Same virtual "
     "vertices. Mass P^T M P with shares of every diamond that integrate linear functions exactly.",
     "vertices", "as the diamond's", "Where the diamond serves, with a lower error.",
     "Bunge, Botsch, Alexa 2021 for the diamonds; Bunge, Herholz, Kazhdan, Botsch: Polygon "
     "Laplacian "
     "Made Simple, 2020 for the other end of theta"},
    [](const PolyhedralMesh& mesh, const DiscretizationOptions& options) {
      return make_diamond("stabilized_diamond", mesh, options);
    }};

}  // namespace carat
