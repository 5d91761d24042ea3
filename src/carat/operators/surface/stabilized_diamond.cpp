// The diamond Laplacian with the jumps between the halves of its diamonds.

#include "carat/operators/registry.h"
#include "carat/operators/surface/diamond.h"

namespace carat {

extern const SurfaceOperator stabilized_diamond_surface_operator = {
    "stabilized_diamond",
    "Diamond Laplacian that resists jumps of the derivative inside diamonds",
    "after Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    {.masses = {MassKind::Full, MassKind::MomentExact, MassKind::Lumped},
     .virtual_vertex = true,
     .theta = 0.75,
     .tau = 0.75,
     .products = true,
     .own_interfaces = true},
    {"S = theta S_diamond + (1 - theta) S_bunge: the diamond's gradient, and a row a diamond for "
     "the "
     "jump of the derivative across the edge, which the diamond averages away. Same virtual "
     "vertices and masses; the moment-exact one, P^T M P with shares of every diamond that "
     "integrate "
     "linear functions exactly, goes with smaller errors on quads and Voronoi cells.",
     "vertices", "as the diamond's",
     "Half of the diamond's error in Poisson's equation on most meshes, and less in distances; not "
     "for curvature.",
     "Bunge, Botsch, Alexa 2021 for the diamonds; Bunge, Herholz, Kazhdan, Botsch: Polygon "
     "Laplacian "
     "Made Simple, 2020 for the other end of theta"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) {
      return make_diamond("stabilized_diamond", mesh, options);
    }};

}  // namespace carat
