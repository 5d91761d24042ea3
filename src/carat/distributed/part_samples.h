#pragma once
// The gradient samples of a part, and what its discretization found, numbered as in the whole mesh.

#include <cstdint>
#include <string>
#include <vector>

#include "carat/mesh/mesh_part.h"
#include "carat/operators/discretization.h"

namespace carat {

/// Samples follow the elements or interfaces that they belong to, as in one process.
struct PartSamples {
  std::vector<std::int64_t> numbers;       ///< the part's sample -> its number; -1: another part's
  std::vector<std::int64_t> first_rows;    ///< the part's sample -> its first row of the gradient
  std::int64_t n_samples = 0, n_rows = 0;  ///< of the whole mesh
};

/// Collective. Faces of a volume that no cell has count for nothing.
PartSamples number_samples(const MeshPart<PolygonMesh>& part, const Discretization& discretization);
PartSamples number_samples(const MeshPart<PolyhedralMesh>& part,
                           const Discretization& discretization);

/// A Finding of the whole mesh, which may have more faces and samples than Index can number.
struct WholeFinding {
  std::string name, meaning;
  std::vector<std::int64_t> elements;
};

/// Collective. What all processes found of a discretization with DegeneratePolicy::Report, each
/// finding once and with the numbers of the whole mesh; in the first process alone, elsewhere
/// empty.
/// \param strict  as DegeneratePolicy::Strict
/// \throws DegenerateElement  Shared; names samples as in the whole mesh, and lists those that Index
///                            can number
std::vector<WholeFinding> whole_diagnostics(const MeshPart<PolygonMesh>& part,
                                            const Discretization& discretization, bool strict);
std::vector<WholeFinding> whole_diagnostics(const MeshPart<PolyhedralMesh>& part,
                                            const Discretization& discretization, bool strict);

}  // namespace carat
