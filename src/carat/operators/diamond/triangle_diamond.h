#pragma once
// Stiffness and mass of the diamond Laplacian on meshes of triangles.

#include <memory>

#include "carat/mesh/polygon_mesh.h"
#include "carat/operators/discretization.h"

namespace carat {

/// The diamond Laplacian in closed form, as the paper has it or stabilised.
/// \param options  settled; parts must be Matrices
/// \return null where the mesh is not one of triangles that are oriented alike, at most two an edge
std::unique_ptr<Assembly> make_triangle_diamond(const char* name, const PolygonMesh& mesh,
                                                const DiscretizationOptions& options);

}  // namespace carat
