// The dual Laplacian of tetrahedral meshes: Alexa, Herholz, Kohlbrenner, Sorkine-Hornung 2020.
// S_ij = -A_ij / |e_ij|, A_ij the signed area of the face dual to the edge ij, between the
// circumcentres of its tetrahedra; the mass holds the signed volumes of the circumcentric cells.

#include <Eigen/Geometry>

#include "carat/assembly/cell_assembly.h"
#include "carat/assembly/pattern.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/tetrahedron.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/operators/volume/incidence.h"

namespace carat {
namespace {

class DualTetAssembly final : public Assembly {
 public:
  DualTetAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  struct Term {
    std::array<double, 16> stiffness;
    std::array<double, 4> mass;
  };
  std::span<const Index> vertices(Index c) const { return mesh_.cell_vertices().row(c); }
  Term term(Index c, double& volume) const;
  void report(const Vector& volumes);

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  VolumeIncidence incidence_;
  Array<Term> terms_;
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

DualTetAssembly::DualTetAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (mesh_.cells().size(c) != 4 || mesh_.cell_vertices().size(c) != 4)
      throw InvalidMesh("cell " + std::to_string(c) + " has " +
                            std::to_string(mesh_.cells().size(c)) + " faces and " +
                            std::to_string(mesh_.cell_vertices().size(c)) +
                            " vertices; the dual_tet operator needs tetrahedra: split the cells, "
                            "or use the operators diamond or bunge",
                        {c});
  check_cell_coefficient(options_, mesh_.n_cells());
  result_.name = "dual_tet";
  result_.stiffness = cell_pattern(incidence_, options_.threads);
  result_.mass = diagonal_pattern(mesh_.n_vertices());
}

/// The parts of the dual faces and cells within a tetrahedron.
DualTetAssembly::Term DualTetAssembly::term(Index c, double& volume) const {
  const std::span<const Index> v = vertices(c);
  const auto position = [&](std::size_t a) -> Vec3 { return points_.row(v[a]).transpose(); };
  Vec3 x[4] = {position(0), position(1), position(2), position(3)};
  const bool turned = mesh_.face_cells()[mesh_.cell(c)[0]].below != c;
  if (turned) std::swap(x[0], x[1]);
  const Tetrahedron t = tetrahedron(x[0], x[1], x[2], x[3], options_.eps_rel);
  Term result{};
  volume = t.volume();
  if (!(t.determinant > 0)) return result;
  double k = options_.cell_coefficient.cols() == 1 ? options_.cell_coefficient(c, 0) : 1.0;
  if (options_.coefficient)
    k *= coefficient_at(options_, origin_ + (x[0] + x[1] + x[2] + x[3]) / 4);
  // The circumcentre, seen from x_0.
  const Vec3 p = x[1] - x[0], q = x[2] - x[0], r = x[3] - x[0];
  const Vec3 pq = p.cross(q), qr = q.cross(r), rp = r.cross(p);
  const Vec3 centre =
      (p.squaredNorm() * qr + q.squaredNorm() * rp + r.squaredNorm() * pq) / (2 * p.dot(qr));
  const auto place = [&](int a) { return static_cast<std::size_t>(turned && a < 2 ? 1 - a : a); };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      // A_ij / |e_ij|: over both faces at the edge, cot of the angle at k times the height of the
      // circumcentre above the face towards l, over 4.
      double area = 0;
      for (int m = 0; m < 4; ++m) {
        if (m == i || m == j) continue;
        const int l = 6 - i - j - m;
        const Vec3& n = t.normal[static_cast<std::size_t>(l)];
        area += (x[i] - x[m]).dot(x[j] - x[m]) * (centre - (x[i] - x[0])).dot(n) /
                (4 * n.squaredNorm());
      }
      const std::size_t a = place(i), b = place(j);
      result.stiffness[4 * a + b] = result.stiffness[4 * b + a] = -k * area;
      result.stiffness[5 * a] += k * area;
      result.stiffness[5 * b] += k * area;
      const double share = area * (x[i] - x[j]).squaredNorm() / 6;
      result.mass[a] += share;
      result.mass[b] += share;
    }
  return result;
}

void DualTetAssembly::reassemble(const Points& points) {
  centre_points(points, points_, origin_);
  terms_.resize(static_cast<std::size_t>(mesh_.n_cells()));
  Vector volumes(mesh_.n_cells());
  // The caller's function is not asked to be thread-safe.
  const int threads = options_.coefficient ? 1 : options_.threads;
  parallel_blocks(mesh_.n_cells(), threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) terms_[c] = term(c, volumes[c]);
  });
  assemble_cell_blocks(result_.stiffness, false, incidence_, options_.threads,
                       [&](Index c, Index a, Index b) {
                         return terms_[c].stiffness[static_cast<std::size_t>(4 * a + b)];
                       });
  assemble_cell_blocks(result_.mass, true, incidence_, options_.threads,
                       [&](Index c, Index a, Index b) {
                         return a == b ? terms_[c].mass[static_cast<std::size_t>(a)] : 0.0;
                       });
  report(volumes);
}

void DualTetAssembly::report(const Vector& volumes) {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  std::vector<Index> excluded, negative;
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (!(volumes[c] > 0)) excluded.push_back(c);
  report_degenerate(
      std::move(excluded), options_, "cell",
      [&](Index c) {
        const std::span<const Index> v = vertices(c);
        return "vertices " + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " +
               std::to_string(v[2]) + " and " + std::to_string(v[3]);
      },
      result_.diagnostics);
  const Vector mass = result_.mass.diagonal();
  for (Index v = 0; v < mesh_.n_vertices(); ++v)
    if (mass[v] < 0) negative.push_back(v);
  result_.diagnostics.add(
      "negative_masses",
      "vertices whose circumcentric cell has a negative volume: the mesh is far "
      "from Delaunay there",
      std::move(negative));
}

}  // namespace

extern const VolumeOperator dual_tet_volume_operator = {
    "dual_tet",
    "Dual Laplacian of tetrahedra: areas between circumcentres",
    "Alexa, Herholz, Kohlbrenner, Sorkine-Hornung: Properties of Laplace Operators for Tetrahedral "
    "Meshes, 2020",
    {.semidefinite = false,
     .gradient = false,
     .divergence_of_gradient = false,
     .positive_mass = false,
     .maximum_principle = true,
     .simplices_only = true,
     .face_local = true},
    {.masses = {MassKind::Voronoi}, .tensor_coefficient = false},
    {"S_ij = -A_ij / |e_ij|, A_ij the signed area of the face dual to the edge ij, between the "
     "circumcentres of the tetrahedra around it. Mass: the signed volumes of the circumcentric "
     "cells, sum over j of A_ij |e_ij| / 6.",
     "vertices", "the vertex and its neighbours: about 15 entries a row",
     "On Delaunay meshes, where a maximum principle counts: no positive coupling of inner "
     "vertices. "
     "Far from Delaunay S has negative eigenvalues and the mass negative entries.",
     "Alexa, Herholz, Kohlbrenner, Sorkine-Hornung: Properties of Laplace Operators for "
     "Tetrahedral "
     "Meshes, 2020"},
    [](const PolyhedralMesh& mesh, const DiscretizationOptions& options)
        -> std::unique_ptr<Assembly> { return std::make_unique<DualTetAssembly>(mesh, options); }};

}  // namespace carat
