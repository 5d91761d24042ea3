#pragma once
// Eigenfunctions of the Laplacian over all processes.

#include <filesystem>
#include <functional>
#include <vector>

#include "carat/apps/eigenmodes.h"
#include "carat/mesh/mesh_part.h"
#include "carat/operators/part_discretization.h"

namespace carat {

/// Collective. The `count` smallest eigenvalues of S x = lambda M x on a mesh of which every
/// process holds a part, as eigenmodes() on one that is whole: SLEPc's Krylov-Schur method about a
/// negative shift, with conjugate gradients and multigrid. Options of SLEPc (-eps_..., -st_ksp_...)
/// choose others.
/// \param discretization      of discretize_part()
/// \param dirichlet_vertices  numbered as in the part; those of others are ignored
/// \param checkpoint          a file that all processes see: the pairs found so far are kept in it,
///                            and a run that ended early goes on from there, also with another
///                            number of processes; empty: none. The caller removes it.
/// \param progress            called with the number of pairs found so far
/// \return vectors at the part's vertices
/// \throws InvalidOption  as eigenmodes(), Shared; the checkpoint of another problem
/// \throws SolverFailure  likewise
/// \throws IoError                       Shared; a checkpoint that cannot be read or written
EigenPairs distributed_eigenmodes(const MeshPart<PolygonMesh>& part,
                                  const Discretization& discretization, Index count,
                                  const std::vector<Index>& dirichlet_vertices = {},
                                  const std::filesystem::path& checkpoint = {},
                                  const std::function<void(Index)>& progress = {});
EigenPairs distributed_eigenmodes(const MeshPart<PolyhedralMesh>& part,
                                  const Discretization& discretization, Index count,
                                  const std::vector<Index>& dirichlet_vertices = {},
                                  const std::filesystem::path& checkpoint = {},
                                  const std::function<void(Index)>& progress = {});

}  // namespace carat
