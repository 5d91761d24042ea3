#pragma once
// Numbers in the whole mesh of what is in the pieces of several processes. Seen by this folder's
// sources alone; everything here is collective.

#include <cstdint>
#include <string>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Numbers of what a process has; -1: none.
struct Numbering {
  std::vector<Index> numbers;
  Index n = 0;  ///< in the whole mesh
};

/// Numbers in the order of the ids.
/// \param what      e.g. "vertices"
/// \param distinct  whether an id may be in one process only, and there once
Numbering number_ids(const std::vector<std::int64_t>& ids, const std::string& what, bool distinct);

/// The same for what there may be more of than Index can number; all have an id.
/// \param total  receives how many there are in the whole mesh
std::vector<std::int64_t> number_many_ids(const std::vector<std::int64_t>& ids,
                                          const std::string& what, bool distinct,
                                          std::int64_t& total);

/// Numbers of elements one process after the other.
Numbering number_in_order(std::size_t n, const std::string& what);

/// Numbers of vertices that are the same where their coordinates are, see join_points(); in the
/// order of the processes, and in each of its vertices.
Numbering number_places(const Points& points, const std::vector<bool>& used);

/// What the whole mesh knows of a process's vertices.
struct VertexBook {
  std::vector<Index> rows;        ///< MeshDivision::vertex_row
  std::vector<bool> shared;       ///< elements of several processes have it
  std::vector<bool> is_loose;     ///< none has it, and this process is to bring it
  std::vector<Index> components;  ///< -1: without an element here
  Index first_row = 0, end_row = 0, n_components = 0;
};

/// \param vertices         their numbers
/// \param vertex_elements  vertex -> numbers of the elements that have it, as often as they do
/// \param n                vertices in the whole mesh
/// \param component        vertex -> which of the process's own components it is in; -1: none
VertexBook keep_vertices(const Numbering& vertices, const Points& points,
                         const Csr& vertex_elements, const std::vector<Index>& component);

}  // namespace carat
