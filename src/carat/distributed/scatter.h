#pragma once
// A mesh that one process has read, divided among all; and values that come back to it.

#include <span>

#include "carat/distributed/part_data.h"

namespace carat {

/// Collective. Divides the first process's mesh and gives every process its part, with its fields
/// and patches. What the others pass is not read.
/// \param element_part  element -> process, e.g. of partition()
/// \throws  as divide(), Shared
AnyPartData scatter(const MeshData* whole, std::span<const Index> element_part);

/// Collective. Rows of values of the part's own vertices to the first process: there one row a
/// vertex of the whole mesh, elsewhere empty.
/// \param values  one row a vertex of the part
Matrix gather_vertices(const PartNumbers& numbers, const Matrix& values);
/// Collective. The same of elements.
/// \param n_whole  of the whole mesh; those that no process has keep a row of zeros
Matrix gather_elements(const PartNumbers& numbers, const Matrix& values, Index n_whole);

/// Collective. The numbers of all processes, ascending, in the first; elsewhere empty.
std::vector<Index> gather_numbers(std::vector<Index> numbers);

}  // namespace carat
