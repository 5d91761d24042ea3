#pragma once
// Boundary conditions of a problem on a surface or in a volume, and their integrals.

#include <functional>
#include <vector>

#include "carat/mesh/polyhedral_mesh.h"

namespace carat {

/// Conditions on parts of the boundary; where there is none, the natural one K du/dn = 0 holds.
///
/// A *side* is a piece of the boundary: of a surface an edge of exactly one face, numbered as in
/// PolygonMesh::edges(); of a volume a face of exactly one cell, numbered as in the mesh.
struct BoundaryConditions {
  /// u = value at these vertices (anywhere, not only on the boundary).
  std::vector<Index> dirichlet_vertices{};
  std::vector<double> dirichlet_values{};
  /// Value at unknowns on boundary faces and edges all of whose vertices are Dirichlet vertices;
  /// empty: the mean of these.
  std::function<double(const Vec3&)> dirichlet_function{};
  /// K du/dn = flux over these sides, n the outward normal (on surfaces: conormal): positive flux
  /// flows in.
  std::vector<Index> neumann_sides{};
  std::vector<double> neumann_flux{};
  /// K du/dn + alpha u = g over these sides, alpha >= 0.
  std::vector<Index> robin_sides{};
  std::vector<double> robin_alpha{}, robin_g{};
};

/// What Neumann and Robin data add to a linear system.
struct BoundaryIntegrals {
  Vector load;         ///< (V): integrals of flux and g
  SparseMatrix robin;  ///< (V, V): integral of alpha u v; semidefinite
};

/// Integrals by the linear trace. An edge gives half its length to each end. A face is cut into the
/// triangles between its sides and its virtual vertex; each gives a third of its area to its
/// corners, and what the virtual vertex gets goes to the face's vertices by their affine weights.
/// \throws InvalidOption  a side that does not exist or is not on the boundary, a value that is not
///                        finite, alpha < 0, lists of different length
/// Cost: O(vertices + sides given).
BoundaryIntegrals integrate_boundary(const PolygonMesh& mesh, const BoundaryConditions& conditions);
BoundaryIntegrals integrate_boundary(const PolyhedralMesh& mesh,
                                     const BoundaryConditions& conditions);

}  // namespace carat
