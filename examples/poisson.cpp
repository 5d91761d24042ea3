// Poisson's equation on Voronoi cells of the unit square: u given on the left and the right side,
// du/dn on the top, nothing flows through the bottom. The solution is u = x^2 + y^2.
//
// Sample run: poisson
//   1346 vertices, L2 error 5.53528e-05
//   5378 vertices, L2 error 1.59069e-05
//   21506 vertices, L2 error 4.25637e-06
//   86018 vertices, L2 error 1.1004e-06
#include <carat/apps/poisson.h>
#include <carat/generators/families.h>
#include <carat/operators/registry.h>

#include <iostream>

int main() {
  for (int level = 2; level <= 5; ++level) {
    const carat::PolygonMesh mesh = carat::generate_mesh("plane-voronoi", {.level = level});
    const auto x = mesh.points().col(0), y = mesh.points().col(1);
    const carat::Vector exact = x.cwiseAbs2() + y.cwiseAbs2();

    carat::BoundaryConditions conditions;
    for (carat::Index v = 0; v < mesh.n_vertices(); ++v)
      if (x[v] == 0 || x[v] == 1) {
        conditions.dirichlet_vertices.push_back(v);
        conditions.dirichlet_values.push_back(exact[v]);
      }
    for (carat::Index e = 0; e < mesh.n_edges(); ++e) {
      const auto [a, b] = mesh.edges().vertices[e];
      if (y[a] == 1 && y[b] == 1) {
        conditions.neumann_sides.push_back(e);
        conditions.neumann_flux.push_back(2);
      }
    }
    const carat::Discretization diamond = carat::discretize(mesh);
    const carat::Poisson poisson(mesh, diamond, conditions);
    const carat::Vector u = poisson.solve(carat::Vector::Constant(mesh.n_vertices(), -4)).values;
    std::cout << mesh.n_vertices() << " vertices, L2 error "
              << carat::error_norms(diamond.mass, u, exact).l2 << "\n";
  }
}
