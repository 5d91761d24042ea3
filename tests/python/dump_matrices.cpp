// Writes stiffness and mass as C++ assembles them, bit by bit, for comparison with Python's.
// dump_matrices MESH OPERATOR FOLDER

#include <cstdio>
#include <fstream>
#include <string>
#include <variant>

#include "carat/io/mesh_file.h"
#include "carat/operators/registry.h"

namespace {

template <class T>
void write(const std::string& path, const T* data, std::ptrdiff_t n) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(sizeof(T)) * n);
}

void write(const std::string& path, const carat::SparseMatrix& matrix) {
  write(path + ".data", matrix.valuePtr(), matrix.nonZeros());
  write(path + ".indices", matrix.innerIndexPtr(), matrix.nonZeros());
  write(path + ".indptr", matrix.outerIndexPtr(), matrix.rows() + 1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const carat::MeshData data = carat::read_mesh(argv[1]);
  std::visit(
      [&](const auto& held) {
        carat::DiscretizationOptions options;
        options.parts = carat::DiscretizationParts::Matrices;
        const carat::Discretization d = carat::discretize(held.mesh, argv[2], options);
        write(std::string(argv[3]) + "/stiffness", d.stiffness);
        write(std::string(argv[3]) + "/mass", d.mass);
      },
      data);
}
