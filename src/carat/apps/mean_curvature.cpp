#include "carat/apps/mean_curvature.h"

#include <cmath>

#include "carat/base/error.h"
#include "carat/mesh/statistics.h"
#include "carat/operators/common.h"
#include "carat/solve/cholesky.h"

namespace carat {

MeanCurvature mean_curvature(const PolygonMesh& mesh, const Discretization& discretization,
                             bool with_sign) {
  const Index n = mesh.n_vertices();
  require_vertex_unknowns(discretization, "mean curvature");
  if (discretization.n_vertices() != n)
    throw InvalidOption("the discretization has " + std::to_string(discretization.n_vertices()) +
                        " vertices, the mesh " + std::to_string(n));
  MeanCurvature result;
  result.values = Vector::Zero(n);
  if (n == 0) return result;

  std::vector<bool> fixed = boundary_vertices(mesh);
  const Vector vertex_mass = discretization.mass.diagonal();
  for (Index v = 0; v < n; ++v) {
    if (!(vertex_mass[v] > 0)) fixed[v] = true;
    if (fixed[v]) result.undefined_vertices.push_back(v);
  }
  const Points centred = mesh.points().rowwise() - mesh.points().colwise().mean();
  const Matrix curvature_vectors =
      Cholesky(discretization.mass, fixed).solve(-(discretization.stiffness * centred));
  result.values = curvature_vectors.rowwise().norm() / 2;
  if (with_sign) {
    const Points normals = vertex_normals(mesh);
    for (Index v = 0; v < n; ++v)
      if (curvature_vectors.row(v).dot(normals.row(v)) > 0) result.values[v] = -result.values[v];
  }
  return result;
}

}  // namespace carat
