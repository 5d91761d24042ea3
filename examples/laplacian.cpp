// Operators of a mesh given by arrays. Two triangles and a pentagon fill a square of side 2; with
// u = x + 2y on its border, the inner vertex gets the same linear function, as it should.
//
// Sample run: laplacian
//   area 4, entries of S 36
//   u(0.8, 1.1) = 3

// [readme]
#include <carat/carat.h>

#include <iostream>

int main() {
  carat::Points points(6, 3);
  points << 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0.8, 1.1, 0;
  const auto mesh = carat::PolygonMesh::from_faces(points, {{0, 1, 5}, {0, 5, 4}, {1, 2, 3, 4, 5}});
  const carat::Discretization diamond = carat::discretize(mesh);  // stiffness, mass, gradient
  std::cout << "area " << diamond.mass.sum() << ", entries of S " << diamond.stiffness.nonZeros();
  const carat::BoundaryConditions border{.dirichlet_vertices = {0, 1, 2, 3, 4},
                                         .dirichlet_values = {0, 1, 2, 6, 4}};
  const carat::Poisson poisson(mesh, diamond, border);
  std::cout << "\nu(0.8, 1.1) = " << poisson.solve(carat::Vector::Zero(6)).values[5] << "\n";
}
// [readme end]
