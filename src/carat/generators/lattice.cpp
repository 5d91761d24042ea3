#include "carat/generators/lattice.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat {

Index lattice_size(int level, Index base, double corners_per_square) {
  const double n = std::ldexp(static_cast<double>(base), level);
  const double n_corners = corners_per_square * n * n;
  if (!(n_corners <= static_cast<double>(std::numeric_limits<Index>::max())))
    throw InvalidOption("level " + std::to_string(level) +
                        ": the mesh would have more than 2^31 face corners; choose a lower level");
  return static_cast<Index>(n);
}

double grade(double t, double anisotropy) {
  if (anisotropy == 1) return t;
  const double rate = std::log(anisotropy);
  return std::expm1(rate * t) / std::expm1(rate);
}

PolygonMesh square_quads(Index n, double anisotropy) {
  const Index row = n + 1;
  Points points(static_cast<Eigen::Index>(row) * row, 3);
  for (Index j = 0; j <= n; ++j)
    for (Index i = 0; i <= n; ++i)
      points.row(static_cast<Eigen::Index>(j) * row + i) << grade(double(i) / n, anisotropy),
          double(j) / n, 0;
  Csr faces;
  faces.offsets.reserve(static_cast<std::size_t>(n) * static_cast<std::size_t>(n) + 1);
  faces.indices.reserve(4 * static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index v = j * row + i;
      faces.indices.insert(faces.indices.end(), {v, v + 1, v + 1 + row, v + row});
      faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
    }
  return PolygonMesh(std::move(points), std::move(faces));
}

PolygonMesh number_by_first_use(const Points& points, Csr faces) {
  Array<Index> number(static_cast<std::size_t>(points.rows()), -1);
  Points ordered(points.rows(), 3);
  Index count = 0;
  for (Index& v : faces.indices) {
    if (number[v] < 0) {
      ordered.row(count) = points.row(v);
      number[v] = count++;
    }
    v = number[v];
  }
  ordered.conservativeResize(count, 3);
  return PolygonMesh(std::move(ordered), std::move(faces));
}

Points squeeze_sphere(const Points& points, double anisotropy) {
  if (anisotropy == 1) return points;
  Points squeezed = points;
  squeezed.col(2) /= anisotropy;
  squeezed.rowwise().normalize();
  return squeezed;
}

}  // namespace carat
