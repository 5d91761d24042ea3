#include "carat/mesh/volume_statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "carat/mesh/accumulate.h"
#include "carat/mesh/hanging_vertices.h"

namespace carat {
namespace {

using detail::DisjointSets;
using detail::RangeOf;

constexpr double kFlatCell = 1e-13;  // |volume| over the cubed diameter
constexpr double kShortEdge = 1e-4;  // length over the diameter of a cell
constexpr double kTinyFace = 1e-8;   // area over the squared diameter of a cell

/// Upper bound of volume^2 / area^3 over polyhedra of n faces: Goldberg 1935.
double goldberg_bound(double n) {
  const double angle = std::numbers::pi * n / (6 * (n - 2));
  const double sine = std::sin(angle);
  return 1 / (54 * (n - 2) * std::tan(angle) * (4 * sine * sine - 1));
}

/// Six times the volume between `origin` and a face, cut into triangles about its mean; positive
/// where the face points away from the origin.
double six_volumes_below(const PolyhedralMesh& mesh, std::span<const Index> face,
                         const Vec3& origin) {
  Vec3 mean = Vec3::Zero();
  for (const Index v : face) mean += mesh.point(v) - origin;
  mean /= static_cast<double>(face.size());
  double sum = 0;
  Vec3 a = mesh.point(face.back()) - origin;
  for (const Index v : face) {
    const Vec3 b = mesh.point(v) - origin;
    sum += a.cross(b).dot(mean);
    a = b;
  }
  return sum;
}

/// Which elements were found to be something; an element may be found twice.
class Marks {
 public:
  explicit Marks(Index n) : marked_(static_cast<std::size_t>(n), false) {}
  void mark(Index i) { marked_[static_cast<std::size_t>(i)] = true; }
  std::vector<Index> ids() const {
    std::vector<Index> list;
    for (std::size_t i = 0; i < marked_.size(); ++i)
      if (marked_[i]) list.push_back(static_cast<Index>(i));
    return list;
  }

 private:
  std::vector<bool> marked_;
};

struct CellMeasure {
  double volume = 0, area = 0, diameter = 0;
};

CellMeasure measure_cell(const PolyhedralMesh& mesh, const Points& area_vectors, Index c) {
  const Vec3 origin = mesh.point(mesh.face(mesh.cell(c)[0])[0]);
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  for (const Index v : mesh.cell_vertices().row(c)) {
    const Vec3 x = mesh.point(v) - origin;
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  CellMeasure measure;
  measure.diameter = (upper - lower).norm();
  for (const Index f : mesh.cell(c)) {
    const double below = six_volumes_below(mesh, mesh.face(f), origin) / 6;
    measure.volume += mesh.face_cells()[f].below == c ? below : -below;
    measure.area += area_vectors.row(f).norm();
  }
  return measure;
}

void measure_cells(const PolyhedralMesh& mesh, VolumeStatistics& s) {
  const Points area_vectors = face_area_vectors(mesh.face_mesh());
  const EdgeTopology& edges = mesh.face_mesh().edges();
  const Csr& faces = mesh.face_mesh().faces();
  RangeOf volumes, qualities;
  std::vector<Index> inverted, flat;
  Marks short_edges(mesh.n_edges()), tiny_faces(mesh.n_faces());
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    const std::size_t size = mesh.cell(c).size();
    if (s.cells_of_size.size() <= size) s.cells_of_size.resize(size + 1, 0);
    ++s.cells_of_size[size];
    ++s.cells_of_kind[static_cast<std::size_t>(cell_kind(mesh, c))];

    const auto [volume, area, diameter] = measure_cell(mesh, area_vectors, c);
    const double noise = kFlatCell * diameter * diameter * diameter;
    volumes.add(volume);
    if (volume < -noise) inverted.push_back(c);
    if (std::abs(volume) <= noise) flat.push_back(c);
    const double shape = volume > noise ? volume / area * (volume / area) / area : 0;
    qualities.add(std::min(1.0, shape / goldberg_bound(static_cast<double>(size))));
    for (const Index f : mesh.cell(c)) {
      if (area_vectors.row(f).norm() < kTinyFace * diameter * diameter) tiny_faces.mark(f);
      for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
        const Index e = edges.of_corner[corner];
        const auto [a, b] = edges.vertices[e];
        if ((mesh.point(b) - mesh.point(a)).norm() < kShortEdge * diameter) short_edges.mark(e);
      }
    }
  }
  s.volume = volumes.sum();
  s.cell_volume = volumes.range();
  s.cell_quality = qualities.range();
  s.findings.add("inverted_cells", "inverted cells, of negative volume", std::move(inverted));
  s.findings.add("flat_cells", "cells without volume", std::move(flat));
  s.findings.add("short_edges", "edges shorter than 1e-4 of the diameter of a cell at them",
                 short_edges.ids());
  s.findings.add("tiny_faces", "faces smaller than 1e-8 of the squared diameter of a cell at them",
                 tiny_faces.ids());
}

/// \return faces without a cell
std::vector<Index> count_faces(const PolyhedralMesh& mesh, VolumeStatistics& s) {
  std::vector<Index> without_cells;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const FaceCells& cells = mesh.face_cells()[f];
    if (cells.boundary()) {
      ++s.boundary_faces;
    } else if (cells.below >= 0) {
      ++s.inner_faces;
    } else {
      without_cells.push_back(f);
    }
  }
  return without_cells;
}

Index count_roots(DisjointSets& sets, Index n) {
  Index count = 0;
  for (Index i = 0; i < n; ++i) count += sets.root(i) == i ? 1 : 0;
  return count;
}

void count_components(const PolyhedralMesh& mesh, VolumeStatistics& s) {
  DisjointSets by_faces(mesh.n_cells());
  for (const FaceCells& cells : mesh.face_cells())
    if (cells.below >= 0 && cells.above >= 0) by_faces.join(cells.below, cells.above);
  s.components = count_roots(by_faces, mesh.n_cells());
  DisjointSets by_vertices(mesh.n_cells());
  Array<Index> cell_at(static_cast<std::size_t>(mesh.n_vertices()), -1);
  for (Index c = 0; c < mesh.n_cells(); ++c)
    for (const Index v : mesh.cell_vertices().row(c)) {
      if (cell_at[v] >= 0) by_vertices.join(cell_at[v], c);
      cell_at[v] = c;
    }
  s.vertex_components = count_roots(by_vertices, mesh.n_cells());
}

std::vector<Index> unreferenced_vertices(const PolyhedralMesh& mesh) {
  std::vector<Index> list;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.vertex_cell_corners().size(v) == 0) list.push_back(v);
  return list;
}

/// Vertices where only two faces of a cell meet: they cut one of its edges in two.
std::vector<Index> subdividing_vertices(const PolyhedralMesh& mesh) {
  Marks subdividing(mesh.n_vertices());
  Array<Index> n_faces(static_cast<std::size_t>(mesh.n_vertices()), 0);
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    for (const Index f : mesh.cell(c))
      for (const Index v : mesh.face(f)) ++n_faces[v];
    for (const Index v : mesh.cell_vertices().row(c)) {
      if (n_faces[v] == 2) subdividing.mark(v);
      n_faces[v] = 0;
    }
  }
  return subdividing.ids();
}

}  // namespace

VolumeStatistics volume_statistics(const PolyhedralMesh& mesh) {
  VolumeStatistics s;
  s.cells = mesh.n_cells();
  s.all_faces = mesh_statistics(mesh.face_mesh());
  s.boundary = mesh_statistics(boundary_surface(mesh).mesh);
  count_components(mesh, s);
  measure_cells(mesh, s);
  s.findings.add("faces_without_cells", "faces without a cell, left out", count_faces(mesh, s));
  s.findings.add("unreferenced_vertices",
                 "vertices without a cell: empty rows, excluded from every solve",
                 unreferenced_vertices(mesh));
  HangingVertices hanging = hanging_vertices(mesh);
  s.hanging_vertices_complete = hanging.complete;
  s.findings.add("hanging_vertices",
                 "hanging vertices, inside an edge or face of another cell that is not connected "
                 "there",
                 std::move(hanging.vertices));
  s.findings.add("subdividing_vertices",
                 "vertices where only two faces of a cell meet: they cut one of its edges in two",
                 subdividing_vertices(mesh));
  const MeshRepairs& repairs = mesh.repairs();
  s.findings.add("turned_cells", "cells given inside out, turned on reading", repairs.turned_cells);
  s.findings.add("turned_faces",
                 "faces given from their neighbour to their owner, turned on reading",
                 repairs.turned_faces);
  s.findings.add("merged_faces", "faces given more than once, merged on reading",
                 repairs.merged_faces);
  return s;
}

}  // namespace carat
