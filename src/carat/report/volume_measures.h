#pragma once
// Measures of volume meshes that the claims are relative to.

#include <span>

#include "carat/prolongation/virtual_cells.h"
#include "carat/report/measures.h"

namespace carat::measures {

inline VirtualCells virtual_cells(const PolyhedralMesh& mesh, const VirtualVertexRule& rule = {}) {
  VirtualCells virtuals;
  update_virtual_cells(mesh, mesh.points(), rule, 1, virtuals);
  return virtuals;
}

/// Calls visit(volume, size) for every virtual tetrahedron: its signed volume, written out here
/// once more, and its longest edge.
template <class Visit>
void for_virtual_tets(const PolyhedralMesh& mesh, const VirtualCells& virtuals,
                      const Visit& visit) {
  for (Index c = 0; c < mesh.n_cells(); ++c)
    for (const Index f : mesh.cell(c)) {
      const auto face = mesh.face(f);
      const Vec3 xc = virtuals.cell_points.row(c).transpose();
      const Vec3 xf = virtuals.face_points.row(f).transpose();
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec3 x[4] = {mesh.point(face[k]), mesh.point(face[(k + 1) % face.size()]), xf, xc};
        const double volume = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[0] - x[3]) / 6;
        double size = 0;
        for (int a = 0; a < 4; ++a)
          for (int b = 0; b < a; ++b) size = std::max(size, (x[a] - x[b]).norm());
        visit(mesh.face_cells()[f].below == c ? volume : -volume, size);
      }
    }
}

/// Sum of hundreds of thousands of equal numbers, to the last digits.
template <class Values>
double accurate_sum(const Values& values) {
  long double sum = 0;
  for (const double value : values) sum += value;
  return static_cast<double>(sum);
}

inline double total(const SparseMatrix& a) {
  return accurate_sum(
      std::span<const double>(a.valuePtr(), static_cast<std::size_t>(a.nonZeros())));
}

/// Volume of the virtual refinement.
inline double refinement_volume(const PolyhedralMesh& mesh, const VirtualVertexRule& rule = {}) {
  long double sum = 0;
  for_virtual_tets(mesh, virtual_cells(mesh, rule), [&](double volume, double) { sum += volume; });
  return static_cast<double>(sum);
}

/// Cubed size over six times the volume of the worst virtual tetrahedron: by this factor the
/// entries of a stiffness magnify rounding of the coordinates.
inline double condition(const PolyhedralMesh& mesh, const VirtualVertexRule& rule = {}) {
  double worst = 1;
  for_virtual_tets(mesh, virtual_cells(mesh, rule), [&](double volume, double size) {
    if (volume > 0) worst = std::max(worst, size * size * size / (6 * volume));
  });
  return worst;
}

inline std::vector<bool> inner_vertices(const PolyhedralMesh& mesh) {
  std::vector<bool> flags = boundary_vertices(mesh);
  flags.flip();
  return flags;
}

/// A colouring of the vertices by +1 and -1 such that every edge joins different colours; empty if
/// there is none. Connected meshes only.
inline Vector checkerboard(const PolyhedralMesh& mesh) {
  Vector colour = Vector::Zero(mesh.n_vertices());
  const auto& edges = mesh.face_mesh().edges();
  colour[edges.vertices[0][0]] = 1;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : edges.vertices) {
      if (colour[a] == 0 && colour[b] == 0) continue;
      if (colour[a] != 0 && colour[a] == colour[b]) return {};
      if (colour[a] != 0 && colour[b] != 0) continue;
      (colour[a] == 0 ? colour[a] : colour[b]) = colour[a] == 0 ? -colour[b] : -colour[a];
      changed = true;
    }
  }
  return colour;
}

}  // namespace carat::measures
