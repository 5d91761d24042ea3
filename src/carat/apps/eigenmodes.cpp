#include "carat/apps/eigenmodes.h"

#include <string>

#include "carat/base/error.h"
#include "carat/operators/common.h"

namespace carat {

EigenPairs eigenmodes(const Discretization& discretization, Index count,
                      const std::vector<Index>& dirichlet_vertices, const EigenOptions& options) {
  require_vertex_unknowns(discretization, "eigenmodes");
  const Index n = discretization.n_vertices();
  std::vector<bool> fixed(static_cast<std::size_t>(n), false);
  for (const Index v : dirichlet_vertices) {
    if (v < 0 || v >= n)
      throw InvalidOption("Dirichlet data: vertex " + std::to_string(v) +
                              " does not exist; the mesh has vertices 0 to " +
                              std::to_string(n - 1),
                          {v});
    fixed[v] = true;
  }
  return smallest_eigenpairs(discretization.stiffness, discretization.mass, count, fixed, options);
}

}  // namespace carat
