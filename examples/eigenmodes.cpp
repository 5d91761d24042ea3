// The lowest tones of a drum that fills the unit ball: eigenvalues of the Laplacian on a mesh of
// truncated cubes, zero at the boundary, beside the exact ones. A mesh of yours comes from
// carat::read_volume(path).mesh of carat::io.
//
// Sample run: eigenmodes
//   1149 cells, volume 4.15261
//   pi^2 = 9.8696: 9.86445, residual below 1e-9: yes
#include <carat/carat.h>

#include <iostream>
#include <numbers>

int main() {
  // 1. Any polyhedra: here truncated cubes, octahedra and pieces of them.
  const carat::PolyhedralMesh mesh = carat::generate_volume("ball-truncated", {.level = 2});
  // 2. Stiffness and mass of the diamond Laplacian.
  carat::DiscretizationOptions options;
  options.parts = carat::DiscretizationParts::Matrices;
  const carat::Discretization diamond = carat::discretize(mesh, "diamond", options);
  std::cout << mesh.n_cells() << " cells, volume " << diamond.mass.sum() << "\n";
  // 3. S x = lambda M x with x = 0 on the boundary.
  std::vector<carat::Index> border;
  const std::vector<bool> on_border = carat::boundary_vertices(mesh);
  for (carat::Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_border[static_cast<std::size_t>(v)]) border.push_back(v);
  const carat::EigenPairs tones = carat::eigenmodes(diamond, 1, border);
  std::cout << "pi^2 = " << std::numbers::pi * std::numbers::pi << ": " << tones.values[0]
            << ", residual below 1e-9: " << (tones.residuals[0] < 1e-9 ? "yes" : "no") << "\n";
}
