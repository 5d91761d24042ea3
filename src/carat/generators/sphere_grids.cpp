#include "carat/generators/sphere_grids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "carat/generators/lattice.h"

namespace carat {
namespace {

/// Numbers the vertices of patches that share corners and sides: corners, then the inner vertices
/// of the sides, then those of the patches.
class PatchNumbering {
 public:
  PatchNumbering(Index n_corners, Index n_sides, Index n, Index inner_of_patch)
      : n_(n),
        first_of_sides_(n_corners),
        first_of_patches_(n_corners + n_sides * (n - 1)),
        inner_of_patch_(inner_of_patch) {
    for (auto& row : side_) row.fill(-1);
  }
  /// The k-th vertex of the n + 1 from corner a to b.
  Index on_side(Index a, Index b, Index k) {
    if (k == 0) return a;
    if (k == n_) return b;
    const Index low = std::min(a, b), high = std::max(a, b);
    if (side_[low][high] < 0) side_[low][high] = n_sides_++;
    return first_of_sides_ + side_[low][high] * (n_ - 1) + (a < b ? k : n_ - k) - 1;
  }
  Index inside(Index patch, Index k) const {
    return first_of_patches_ + patch * inner_of_patch_ + k;
  }

 private:
  static constexpr int kMostCorners = 12;
  Index n_, first_of_sides_, first_of_patches_, inner_of_patch_;
  Index n_sides_ = 0;
  std::array<std::array<Index, kMostCorners>, kMostCorners> side_;
};

std::vector<Vec3> icosahedron_corners() {
  std::vector<Vec3> corners;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-1.0, 1.0})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 x = Vec3::Zero();
        x[(axis + 1) % 3] = s;
        x[(axis + 2) % 3] = t * std::numbers::phi;
        corners.push_back(x.normalized());
      }
  return corners;
}

/// All triples of neighbours, counter-clockwise from outside.
std::vector<std::array<Index, 3>> icosahedron_faces(const std::vector<Vec3>& x) {
  const auto adjacent = [&](Index a, Index b) { return x[a].dot(x[b]) > 0; };
  std::vector<std::array<Index, 3>> faces;
  for (Index a = 0; a < 12; ++a)
    for (Index b = a + 1; b < 12; ++b)
      for (Index c = b + 1; c < 12; ++c) {
        if (!adjacent(a, b) || !adjacent(b, c) || !adjacent(c, a)) continue;
        if (x[a].cross(x[b]).dot(x[c]) > 0)
          faces.push_back({a, b, c});
        else
          faces.push_back({a, c, b});
      }
  return faces;
}

void add_face(Csr& faces, std::initializer_list<Index> face) {
  faces.indices.insert(faces.indices.end(), face);
  faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
}

}  // namespace

PolygonMesh icosahedral_triangles(Index n) {
  const std::vector<Vec3> corners = icosahedron_corners();
  const auto patches = icosahedron_faces(corners);
  const auto inner = static_cast<Index>(static_cast<std::int64_t>(n - 1) * (n - 2) / 2);
  PatchNumbering numbering(12, 30, n, inner);
  Points points(numbering.inside(20, 0), 3);
  Csr faces;
  std::vector<Index> row, next_row;
  for (Index patch = 0; patch < 20; ++patch) {
    const Index a = patches[patch][0], b = patches[patch][1], c = patches[patch][2];
    Index k = 0;
    const auto number_row = [&](Index j) {
      next_row.clear();
      for (Index i = 0; i <= n - j; ++i) {
        const Index v = j == 0       ? numbering.on_side(a, b, i)
                        : i == 0     ? numbering.on_side(a, c, j)
                        : i == n - j ? numbering.on_side(b, c, j)
                                     : numbering.inside(patch, k++);
        const Vec3 x =
            double(n - i - j) * corners[a] + double(i) * corners[b] + double(j) * corners[c];
        points.row(v) = x.normalized().transpose();
        next_row.push_back(v);
      }
      std::swap(row, next_row);
    };
    number_row(0);
    for (Index j = 0; j < n; ++j) {
      number_row(j + 1);
      const std::vector<Index>&below = next_row, &above = row;
      for (Index i = 0; i < n - j; ++i) {
        add_face(faces, {below[i], below[i + 1], above[i]});
        if (i + 1 < n - j) add_face(faces, {below[i + 1], above[i + 1], above[i]});
      }
    }
  }
  return number_by_first_use(points, std::move(faces));
}

PolygonMesh cubed_sphere_quads(Index n) {
  const auto inner = static_cast<Index>(static_cast<std::int64_t>(n - 1) * (n - 1));
  PatchNumbering numbering(8, 12, n, inner);
  Points points(numbering.inside(6, 0), 3);
  Csr faces;
  std::vector<Index> row, next_row;
  std::vector<double> tangent;
  for (Index i = 0; i <= n; ++i)
    tangent.push_back(std::tan(std::numbers::pi / 4 * (2 * i - n) / n));
  tangent.front() = -1;
  tangent.back() = 1;
  for (Index patch = 0; patch < 6; ++patch) {
    // The patch at +1 or -1 along `axis`; u x v points outwards.
    const int axis = patch / 2, side = patch % 2;
    const int u = (axis + (side == 1 ? 1 : 2)) % 3, v = 3 - axis - u;
    const auto corner = [&](int at_u, int at_v) -> Index {
      return side << axis | at_u << u | at_v << v;
    };
    Index k = 0;
    const auto number_row = [&](Index j) {
      next_row.clear();
      for (Index i = 0; i <= n; ++i) {
        const Index id = j == 0   ? numbering.on_side(corner(0, 0), corner(1, 0), i)
                         : j == n ? numbering.on_side(corner(0, 1), corner(1, 1), i)
                         : i == 0 ? numbering.on_side(corner(0, 0), corner(0, 1), j)
                         : i == n ? numbering.on_side(corner(1, 0), corner(1, 1), j)
                                  : numbering.inside(patch, k++);
        Vec3 x;
        x[axis] = side == 1 ? 1 : -1;
        x[u] = tangent[i];
        x[v] = tangent[j];
        points.row(id) = x.normalized().transpose();
        next_row.push_back(id);
      }
      std::swap(row, next_row);
    };
    number_row(0);
    for (Index j = 0; j < n; ++j) {
      number_row(j + 1);
      const std::vector<Index>&below = next_row, &above = row;
      for (Index i = 0; i < n; ++i)
        add_face(faces, {below[i], below[i + 1], above[i + 1], above[i]});
    }
  }
  return number_by_first_use(points, std::move(faces));
}

}  // namespace carat
