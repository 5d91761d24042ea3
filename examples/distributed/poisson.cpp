// -div grad u = 1, zero at x < 0, on a mesh of which every process reads its own part:
//   carat generate ball-voronoi --level 2 -o ball.vtu
//   carat partition ball.vtu -n 4 -o parts
//   mpirun -np 4 poisson parts/mesh.pvtu
//
// Sample run: ball-voronoi of level 2 on 4 processes
//   14108 vertices in 4 parts, u is at most 0.357939
#include <carat/distributed/poisson.h>
#include <carat/distributed/processes.h>
#include <carat/distributed/read_parts.h>
#include <carat/operators/part_discretization.h>

#include <iostream>

int main(int argc, char** argv) {
  // 1. MPI, PETSc and SLEPc, whose options (-ksp_monitor, ...) count.
  const carat::Processes processes({argv, argv + argc});
  const auto solve = [&]() -> int {
    if (argc < 2) throw carat::InvalidOption("usage: poisson MESH, a mesh in parts");
    // 2. The part of this process: its own cells and a layer of those across from them.
    const carat::AnyPartData read = carat::read_parts(argv[1]);
    const auto* data = std::get_if<carat::PartData<carat::PolyhedralMesh>>(&read);
    if (data == nullptr) throw carat::InvalidOption("this example is for volumes");
    const carat::MeshPart<carat::PolyhedralMesh>& part = data->part;
    // 3. What the part brings to the operators, in the form that takes least memory.
    carat::DiscretizationOptions options;
    options.parts = carat::DiscretizationParts::Matrices;
    options.form = carat::distributed_poisson_form(part, "diamond");
    const carat::Discretization diamond = carat::discretize_part(part, "diamond", options);
    // 4. Data count for the part's own vertices, so they may be given at all.
    carat::BoundaryConditions conditions;
    for (carat::Index v = 0; v < part.mesh.n_vertices(); ++v)
      if (part.mesh.point(v).x() < 0) {
        conditions.dirichlet_vertices.push_back(v);
        conditions.dirichlet_values.push_back(0);
      }
    const carat::DistributedPoisson poisson(part, diamond, conditions);
    const carat::Vector u = poisson.solve(carat::Vector::Ones(part.mesh.n_vertices())).values;
    // 5. Sums and maxima over all processes.
    const double largest = carat::largest_of_all(u.maxCoeff());
    if (processes.rank() == 0)
      std::cout << part.numbers.n_vertices << " vertices in " << processes.size()
                << " parts, u is at most " << largest << "\n";
    return 0;
  };
  return carat::run_processes(solve, [](const std::exception& error) {
    std::cerr << "poisson: " << error.what() << "\n";
    return 3;
  });
}
