// The cotan Laplacian of tetrahedral meshes, see Crane 2019: linear elements,
// S_ij = -1/6 of the sum of l_kl cot(theta_kl), kl the edges opposite to ij; the mass is lumped by
// quarters of tetrahedra, or that of linear elements: V/10, V/20.

#include <algorithm>

#include "carat/assembly/pattern.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/tetrahedron.h"
#include "carat/operators/common.h"
#include "carat/operators/linear_tets.h"
#include "carat/operators/registry.h"
#include "carat/operators/volume/incidence.h"

namespace carat {
namespace {

class PrimalTetAssembly final : public Assembly {
 public:
  PrimalTetAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  void make_gradient_pattern();
  void compute_terms();
  void assemble_gradient();
  void collect_frames();
  void report();

  std::span<const Index> vertices(Index c) const { return mesh_.cell_vertices().row(c); }
  Tetrahedron tet(Index c) const {
    return cell_tetrahedron(points_, incidence_, c, options_.eps_rel);
  }

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  bool with_mass_ = options_.parts != DiscretizationParts::Stiffness;
  bool lumped_ = options_.mass == MassKind::Lumped;
  VolumeIncidence incidence_;
  Array<LinearTet> tets_;
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

PrimalTetAssembly::PrimalTetAssembly(const PolyhedralMesh& mesh,
                                     const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (mesh_.cells().size(c) != 4 || mesh_.cell_vertices().size(c) != 4)
      throw InvalidMesh(
          "cell " + std::to_string(c) + " has " + std::to_string(mesh_.cells().size(c)) +
              " faces and " + std::to_string(mesh_.cell_vertices().size(c)) +
              " vertices; the primal_tet operator needs tetrahedra: split the cells, or "
              "use the operators diamond or bunge",
          {c});
  check_cell_coefficient(options_, mesh_.n_cells());
  result_.name = "primal_tet";
  result_.stiffness = cell_pattern(incidence_, options_.threads);
  if (with_mass_) result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : result_.stiffness;
  result_.sample_measure.resize(mesh_.n_cells());
  if (options_.parts >= DiscretizationParts::Gradient) make_gradient_pattern();
}

void PrimalTetAssembly::compute_terms() {
  // The caller's function is not asked to be thread-safe.
  const int threads = options_.coefficient ? 1 : options_.threads;
  // Near the limit one way of computing the volume has to decide, here and for the gradient.
  const double safe = 2 * std::max(options_.eps_rel, 1e-14);
  const Eigen::Index components = options_.cell_coefficient.cols();
  compute_linear_tets(points_, incidence_, threads, tets_, [&](Index c, LinearTet& t) {
    const double volume = t.volume;
    const bool thin = !is_thicker(t, safe);
    if (thin || components == 6) {
      t = linear_tet(tet(c), cell_tensor(options_, c));
      if (!thin) t.volume = volume;  // the same bits with any K
    } else if (components == 1) {
      for (double& pair : t.pair) pair *= options_.cell_coefficient(c, 0);
    }
    result_.sample_measure[c] = t.volume;
    if (!options_.coefficient || !(t.volume > 0)) return;
    Vec3 sum = Vec3::Zero();
    for (const Index v : vertices(c)) sum += points_.row(v).transpose();
    const double k = coefficient_at(options_, origin_ + sum / 4);
    for (double& pair : t.pair) pair *= k;
  });
}

void PrimalTetAssembly::make_gradient_pattern() {
  if (std::int64_t{mesh_.n_cells()} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(mesh_.n_cells()) +
                      " tetrahedra has more rows than 32 bits can number; split the mesh");
  result_.gradient_dimension = 3;
  result_.gradient = allocate_rows(3 * mesh_.n_cells(), mesh_.n_vertices(),
                                   Array<Index>(3 * static_cast<std::size_t>(mesh_.n_cells()), 4),
                                   "the gradient on tetrahedra");
  for (Index c = 0; c < mesh_.n_cells(); ++c) {
    Index* const columns =
        result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[3 * c];
    std::sort(columns, std::copy(vertices(c).begin(), vertices(c).end(), columns));
    std::copy(columns, columns + 4, columns + 4);
    std::copy(columns, columns + 4, columns + 8);
  }
}

void PrimalTetAssembly::assemble_gradient() {
  double* const values = result_.gradient.valuePtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  parallel_blocks(mesh_.n_cells(), options_.threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      const Index first = result_.gradient.outerIndexPtr()[3 * c];
      const Tetrahedron t = tet(c);
      for (std::size_t a = 0; a < 4; ++a) {
        const Index* const columns = inner + first;
        const std::ptrdiff_t place = std::find(columns, columns + 4, vertices(c)[a]) - columns;
        for (Index d = 0; d < 3; ++d)
          values[first + 4 * d + place] = t.determinant > 0 ? t.normal[a][d] / t.determinant : 0.0;
      }
    }
  });
}

void PrimalTetAssembly::collect_frames() {
  // A part names up to three vertices: every tetrahedron is two halves with two vertices each.
  result_.frames.parts.clear();
  for (Index c = 0; c < mesh_.n_cells(); ++c) {
    const double half = result_.sample_measure[c] / 2;
    const std::span<const Index> v = vertices(c);
    if (!(half > 0)) continue;
    result_.frames.parts.push_back({half, c, c, {v[0], v[1], -1}});
    result_.frames.parts.push_back({half, c, c, {v[2], v[3], -1}});
  }
}

void PrimalTetAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (!(result_.sample_measure[c] > 0)) excluded.push_back(c);
  report_degenerate(
      std::move(excluded), options_, "cell",
      [&](Index c) {
        const std::span<const Index> v = vertices(c);
        return "vertices " + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " +
               std::to_string(v[2]) + " and " + std::to_string(v[3]);
      },
      result_.diagnostics);
}

void PrimalTetAssembly::reassemble(const Points& points) {
  centre_points(points, points_, origin_);
  compute_terms();
  assemble_linear_tets(result_.stiffness, with_mass_ ? &result_.mass : nullptr, lumped_, incidence_,
                       tets_, options_.threads);
  if (options_.parts >= DiscretizationParts::Gradient) assemble_gradient();
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

}  // namespace

extern const VolumeOperator primal_tet_volume_operator = {
    "primal_tet",
    "Cotan Laplacian of tetrahedra: linear elements",
    "Crane: The n-dimensional cotangent formula, 2019",
    {.equals_cotan_on_simplices = true, .simplices_only = true, .face_local = true},
    {.masses = {MassKind::Lumped, MassKind::Full}, .stiffness_alone = true},
    {"S_ij = -1/6 of the sum of l_kl cot(theta_kl) over the tetrahedra of the edge ij, kl the "
     "opposite edge. Mass: quarters of the tetrahedra; full: linear elements.",
     "vertices", "the vertex and its neighbours: about 15 entries a row",
     "The reference on tetrahedra.", "Crane: The n-dimensional cotangent formula, 2019"},
    [](const PolyhedralMesh& mesh,
       const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<PrimalTetAssembly>(mesh, options);
    }};

}  // namespace carat
