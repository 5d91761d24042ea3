// The call carat.stiffness(points, faces) of Python as C++ does it; driven by binding.py.
// binding POINTS FACES THREADS: raw files of (n, 3) doubles and (m, 3) 32-bit integers. For every
// line of input one call: prints its seconds; at the end the peak memory above that at the start.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "carat/base/memory.h"
#include "carat/operators/registry.h"

namespace {

using namespace carat;
using Faces = Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Rows>
Rows read(const char* path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const auto bytes = static_cast<std::size_t>(in.tellg());
  Rows rows(static_cast<Eigen::Index>(bytes / (3 * sizeof(typename Rows::Scalar))), 3);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(bytes));
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const Points points = read<Points>(argv[1]);
  const Faces faces = read<Faces>(argv[2]);
  DiscretizationOptions options;
  options.parts = DiscretizationParts::Matrices;
  options.threads = std::atoi(argv[3]);
  restart_peak_memory();
  const std::size_t before = peak_memory();
  for (std::string line; std::getline(std::cin, line);) {
    const auto start = std::chrono::steady_clock::now();
    const Discretization d =
        discretize(PolygonMesh::from_padded(points, faces), "diamond", options);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%.9f %lld\n", seconds.count(), static_cast<long long>(d.stiffness.nonZeros()));
    std::fflush(stdout);
  }
  std::printf("%zu\n", peak_memory() - before);
}
