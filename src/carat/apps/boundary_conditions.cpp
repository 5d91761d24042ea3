#include "carat/apps/boundary_conditions.h"

#include <array>
#include <cmath>
#include <string>

#include "carat/base/error.h"
#include "carat/kernels/virtual_vertex.h"

namespace carat {
namespace {

void check_length(std::size_t sides, std::size_t values, const char* what) {
  if (sides != values)
    throw InvalidOption(std::string(what) + ": lists of " + std::to_string(sides) + " and " +
                        std::to_string(values) + " entries; they must be equally long");
}

void check_finite(double value, const std::string& what, const char* kind, Index side) {
  if (!std::isfinite(value))
    throw InvalidOption(what + " at " + kind + " " + std::to_string(side) + " is " +
                            std::to_string(value) + "; it must be a finite number",
                        {side});
}

/// The integral of u over one side: sum measures[i] u(vertices[i]) + inner_measure u(x), where
/// u(x) = sum inner_weights[i] u(vertices[i]).
struct Quadrature {
  std::span<const Index> vertices;
  std::vector<double> measures;
  double inner_measure = 0;
  std::vector<double> inner_weights;
};

/// Boundary edges of a surface.
class EdgeSides {
 public:
  static constexpr const char* kind = "edge";
  explicit EdgeSides(const PolygonMesh& mesh) : mesh_(mesh), edges_(mesh.edges()) {
    quadrature_.measures.resize(2);
    quadrature_.inner_weights.assign(2, 0.0);
  }
  Index size() const { return edges_.size(); }
  Index n_elements(Index edge) const { return edges_.corners.size(edge); }
  const Quadrature& quadrature(Index edge) {
    const std::array<Index, 2>& ends = edges_.vertices[edge];
    quadrature_.vertices = ends;
    quadrature_.measures[0] = quadrature_.measures[1] =
        (mesh_.point(ends[1]) - mesh_.point(ends[0])).norm() / 2;
    return quadrature_;
  }

 private:
  const PolygonMesh& mesh_;
  const EdgeTopology& edges_;
  Quadrature quadrature_;
};

/// Boundary faces of a volume.
class FaceSides {
 public:
  static constexpr const char* kind = "face";
  explicit FaceSides(const PolyhedralMesh& mesh) : mesh_(mesh), kernel_(VirtualVertexRule{}) {}
  Index size() const { return mesh_.n_faces(); }
  Index n_elements(Index face) const {
    const FaceCells& cells = mesh_.face_cells()[face];
    return (cells.below >= 0) + (cells.above >= 0);
  }
  const Quadrature& quadrature(Index face) {
    quadrature_.vertices = mesh_.face(face);
    const std::size_t n = quadrature_.vertices.size();
    triangles_.resize(n);
    quadrature_.inner_weights.resize(n);
    kernel_.compute(mesh_.points(), quadrature_.vertices, quadrature_.inner_weights.data(),
                    triangles_.data());
    quadrature_.measures.assign(n, 0.0);
    quadrature_.inner_measure = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double third = triangles_[i].double_area / 6;
      quadrature_.measures[i] += third;
      quadrature_.measures[i + 1 == n ? 0 : i + 1] += third;
      quadrature_.inner_measure += third;
    }
    return quadrature_;
  }

 private:
  const PolyhedralMesh& mesh_;
  VirtualVertexKernel kernel_;
  std::vector<VirtualTriangle> triangles_;
  Quadrature quadrature_;
};

template <class Sides>
const Quadrature& boundary_quadrature(Sides& sides, Index side, const char* what) {
  if (side < 0 || side >= sides.size())
    throw InvalidOption(std::string(what) + ": " + Sides::kind + " " + std::to_string(side) +
                            " does not exist; the mesh has " + Sides::kind + "s 0 to " +
                            std::to_string(sides.size() - 1),
                        {side});
  if (sides.n_elements(side) != 1)
    throw InvalidOption(std::string(what) + ": " + Sides::kind + " " + std::to_string(side) +
                            " has " + std::to_string(sides.n_elements(side)) +
                            " elements beside it and is not on the boundary",
                        {side});
  return sides.quadrature(side);
}

void add_load(const Quadrature& q, double density, Vector& load) {
  for (std::size_t i = 0; i < q.vertices.size(); ++i)
    load[q.vertices[i]] += density * (q.measures[i] + q.inner_measure * q.inner_weights[i]);
}

void add_robin(const Quadrature& q, double alpha,
               std::vector<Eigen::Triplet<double, Index>>& entries) {
  const std::size_t n = q.vertices.size();
  for (std::size_t i = 0; i < n; ++i) {
    entries.emplace_back(q.vertices[i], q.vertices[i], alpha * q.measures[i]);
    if (q.inner_measure == 0) continue;
    for (std::size_t j = 0; j < n; ++j)
      entries.emplace_back(q.vertices[i], q.vertices[j],
                           alpha * q.inner_measure * (q.inner_weights[i] * q.inner_weights[j]));
  }
}

template <class Sides>
BoundaryIntegrals integrate(Sides sides, Index n_vertices, const BoundaryConditions& conditions) {
  check_length(conditions.neumann_sides.size(), conditions.neumann_flux.size(), "Neumann data");
  check_length(conditions.robin_sides.size(), conditions.robin_alpha.size(), "Robin data");
  check_length(conditions.robin_sides.size(), conditions.robin_g.size(), "Robin data");
  BoundaryIntegrals result{Vector::Zero(n_vertices), SparseMatrix(n_vertices, n_vertices)};
  for (std::size_t k = 0; k < conditions.neumann_sides.size(); ++k) {
    const Index side = conditions.neumann_sides[k];
    check_finite(conditions.neumann_flux[k], "Neumann flux", Sides::kind, side);
    add_load(boundary_quadrature(sides, side, "Neumann data"), conditions.neumann_flux[k],
             result.load);
  }
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t k = 0; k < conditions.robin_sides.size(); ++k) {
    const Index side = conditions.robin_sides[k];
    const double alpha = conditions.robin_alpha[k];
    check_finite(alpha, "Robin alpha", Sides::kind, side);
    check_finite(conditions.robin_g[k], "Robin g", Sides::kind, side);
    if (alpha < 0)
      throw InvalidOption("Robin alpha at " + std::string(Sides::kind) + " " +
                              std::to_string(side) + " is " + std::to_string(alpha) +
                              "; it must not be negative",
                          {side});
    const Quadrature& q = boundary_quadrature(sides, side, "Robin data");
    add_load(q, conditions.robin_g[k], result.load);
    if (alpha > 0) add_robin(q, alpha, entries);
  }
  result.robin.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

BoundaryIntegrals integrate_boundary(const PolygonMesh& mesh,
                                     const BoundaryConditions& conditions) {
  return integrate(EdgeSides(mesh), mesh.n_vertices(), conditions);
}

BoundaryIntegrals integrate_boundary(const PolyhedralMesh& mesh,
                                     const BoundaryConditions& conditions) {
  return integrate(FaceSides(mesh), mesh.n_vertices(), conditions);
}

}  // namespace carat
