// Geodesic distance from a vertex of a mesh file, written as a vertex field of another file.
//
// Usage: geodesics IN OUT [SOURCE]
// Sample run: geodesics bunny.obj distance.vtp 0
#include <carat/apps/heat_geodesics.h>
#include <carat/io/mesh_file.h>
#include <carat/operators/registry.h>

#include <exception>
#include <iostream>
#include <string>

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "Usage: geodesics IN OUT [SOURCE]\n";
    return 2;
  }
  try {
    const carat::PolygonMesh mesh = carat::read_surface(argv[1]).mesh;
    const carat::HeatGeodesics geodesics(mesh, carat::discretize(mesh));
    const carat::Index source = argc > 3 ? std::stoi(argv[3]) : 0;
    const carat::Vector distance = geodesics.distance(source).values;

    carat::MeshFields fields;
    fields.vertex.push_back({"distance", 1, {distance.begin(), distance.end()}});
    carat::write_surface(argv[2], mesh, fields);
    std::cout << mesh.n_vertices() << " vertices, largest distance " << distance.maxCoeff() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "geodesics: " << error.what() << "\n";
    return 3;
  }
}
