#pragma once
// Readers for the reference files of the tests: plain OBJ and Matrix Market, independent of the
// library's own.

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "carat/mesh/polygon_mesh.h"

namespace carat::test {

inline std::ifstream open_reference(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error("missing reference file " + path);
  return in;
}

inline PolygonMesh read_plain_obj(const std::string& path) {
  std::ifstream in = open_reference(path);
  std::vector<double> coordinates;
  std::vector<std::vector<Index>> faces;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string tag;
    words >> tag;
    if (tag == "v")
      for (double x; words >> x;) coordinates.push_back(x);
    if (tag == "f") {
      faces.emplace_back();
      for (Index v; words >> v;) faces.back().push_back(v - 1);
    }
  }
  const Points points = Eigen::Map<const Points>(
      coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
  return PolygonMesh::from_faces(points, faces);
}

inline Matrix read_dense_mtx(const std::string& path) {
  std::ifstream in = open_reference(path);
  std::string line;
  while (std::getline(in, line) && line[0] == '%') {
  }
  std::istringstream size(line);
  Index rows = 0, cols = 0, entries = 0;
  size >> rows >> cols >> entries;
  Matrix matrix = Matrix::Zero(rows, cols);
  Index i = 0, j = 0;
  double value = 0;
  for (Index k = 0; k < entries; ++k) {
    if (!(in >> i >> j >> value)) throw std::runtime_error("short reference file " + path);
    matrix(i - 1, j - 1) = value;
  }
  return matrix;
}

/// Rows of numbers behind one header line.
inline std::vector<std::vector<double>> read_csv(const std::string& path) {
  std::ifstream in = open_reference(path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

}  // namespace carat::test
