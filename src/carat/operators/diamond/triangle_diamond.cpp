#include "carat/operators/diamond/triangle_diamond.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>

#include "carat/assembly/triangle_diamond_assembly.h"
#include "carat/base/parallel.h"
#include "carat/kernels/diamond_split.h"
#include "carat/kernels/triangle_diamond_block.h"
#include "carat/operators/common.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {
namespace {

class TriangleDiamondAssembly final : public Assembly {
 public:
  TriangleDiamondAssembly(const char* name, const PolygonMesh& mesh,
                          const DiscretizationOptions& options)
      : mesh_(mesh), options_(options), incidence_(incidence(mesh_, options.threads)) {
    check_own_interfaces(options_, mesh_.n_edges());
    result_.name = name;
    TriangleDiamondPatterns made = triangle_diamond_patterns(incidence_, options_.threads);
    result_.stiffness = std::move(made.patterns.stiffness);
    result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : std::move(made.patterns.mass);
    sources_ = std::move(made.sources);
    result_.sample_measure.resize(mesh_.n_edges());
    for (Index v = 0; v < mesh_.n_vertices(); ++v)
      if (sources_.stiffness_diagonal[v] < 0) unreferenced_.push_back(v);
  }
  static TriangleIncidence incidence(const PolygonMesh& mesh, int threads) {
    const EdgeTopology& edges = mesh.edges(threads);
    return {mesh.n_vertices(), mesh.faces(), edges.vertices, edges.corners, edges.of_corner};
  }
  void reassemble(const Points& points) override;

 private:
  using Block = TriangleDiamondBlock;
  struct Diamond {
    Index v1, v2, left, right;  // vertices, right is -1 at the boundary
  };
  Diamond diamond(Index e) const;
  bool is_left_out(Index e) const {
    return !options_.own_interfaces.empty() &&
           !options_.own_interfaces[static_cast<std::size_t>(e)];
  }
  void compute_terms(const Points& points);
  void gather(const Points& points, Index first, Index size, Block& block) const;
  void leave_out(Index first, Index size, Block& block) const;
  void set_halves(Index e, double scale, const Block& block, const TriangleCrossingBlock& crossing,
                  Index lane);
  Array<double> coefficients(const Points& points) const;
  void report(const Points& points);

  PolygonMesh mesh_;
  DiscretizationOptions options_;
  bool lumped_ = options_.mass == MassKind::Lumped;
  bool moment_exact_ = options_.mass == MassKind::MomentExact;
  double theta_ = options_.theta.value_or(1.0);
  bool halves_ = theta_ < 1 || moment_exact_;  // of diamonds differ
  TriangleIncidence incidence_;
  TriangleDiamondSources sources_;
  TriangleDiamondTerms terms_;
  Array<double> coefficient_;  // of every diamond; empty: 1
  std::vector<Index> unreferenced_;
  bool any_excluded_ = false, any_thin_ = false;  // diamonds; triangles, perhaps
};

inline TriangleDiamondAssembly::Diamond TriangleDiamondAssembly::diamond(Index e) const {
  // The side of the first corner runs along the hinge, so its face is to the left.
  const Index* const corners = incidence_.edge_corners.indices.data();
  const Index* const vertices = incidence_.faces.indices.data();
  const Index k = incidence_.edge_corners.begin(e);
  const Index l = corners[k];
  const auto [next, previous] = triangle_neighbours(l);
  Diamond result{vertices[l], vertices[next], vertices[previous], -1};
  if (incidence_.edge_corners.end(e) - k == 2)
    result.right = vertices[triangle_neighbours(corners[k + 1]).previous];
  return result;
}

void TriangleDiamondAssembly::gather(const Points& points, Index first, Index size,
                                     Block& block) const {
  const double* const x = points.data();
  for (Index k = 0; k < size; ++k) {
    const Diamond d = diamond(first + k);
    block.inner[k] = d.right >= 0 ? 1.0 : 0.0;
    const double* const at[4] = {x + 3 * std::ptrdiff_t{d.v1}, x + 3 * std::ptrdiff_t{d.v2},
                                 x + 3 * std::ptrdiff_t{d.left},
                                 x + 3 * std::ptrdiff_t{d.right >= 0 ? d.right : d.v1}};
    for (int i = 0; i < 4; ++i)
      for (int c = 0; c < 3; ++c) block.x[i][c][k] = at[i][c];
  }
}

/// Diamonds of other parts add nothing.
void TriangleDiamondAssembly::leave_out(Index first, Index size, Block& block) const {
  for (Index k = 0; k < size; ++k)
    if (is_left_out(first + k)) block.alpha[k] = block.beta[k] = block.gamma[k] = block.area[k] = 0;
}

/// With u_l = (u1 + u2 + o_l) / 3 the jump is c . (u1, u2, o_l, o_r); masses of its four vertices.
void TriangleDiamondAssembly::set_halves(Index e, double scale, const Block& block,
                                         const TriangleCrossingBlock& crossing, Index lane) {
  const Index n_edges = mesh_.n_edges();
  const Index left = incidence_.edge_corners.begin(e), right = left + 1;
  TriangleDiamondTerms::Half& to_left = terms_.halves[incidence_.edge_corners.indices[left]];
  const double beta = scale * block.beta[lane] / 3, area = block.area[lane];
  to_left.start = beta;
  to_left.end = -beta;
  if (!(block.inner[lane] > 0)) {
    to_left.tip = area / 27;
    terms_.ends[e] = {area / 3, area / 3};
    return;
  }
  TriangleDiamondTerms::Half& to_right = terms_.halves[incidence_.edge_corners.indices[right]];
  to_right.start = beta;
  to_right.end = -beta;
  if (!(area > 0)) {
    to_left.tip = to_right.tip = 0;
    terms_.ends[e] = {0, 0};
    return;
  }
  const double l = crossing.left_fraction[lane], r = crossing.right_fraction[lane];
  const double foot = crossing.foot[lane];
  const double jump = (1 - theta_) * scale * crossing.stiffness[lane];
  const double at_1 = foot - 2.0 / 3, at_2 = 1.0 / 3 - foot, at_left = r / 3, at_right = l / 3;
  terms_.values[e] += jump * at_1 * at_2;
  terms_.values[n_edges + e] += jump * at_left * at_right;
  to_left.start += jump * at_1 * at_left;
  to_left.end += jump * at_2 * at_left;
  to_right.start += jump * at_2 * at_right;
  to_right.end += jump * at_1 * at_right;
  DiamondMass<2> mass{{0.25, 0.25}, 0.25, 0.25};
  if (moment_exact_) mass = moment_exact_mass<2>({r, l, {1 - foot, foot}, 0, l}, *options_.tau);
  to_left.tip = area * mass.left / 9;
  to_right.tip = area * mass.right / 9;
  const bool ascending = incidence_.faces.indices[incidence_.edge_corners.indices[left]] ==
                         incidence_.edge_vertices[e][0];
  terms_.ends[e] = {area * mass.base[ascending ? 0 : 1], area * mass.base[ascending ? 1 : 0]};
}

void TriangleDiamondAssembly::compute_terms(const Points& points) {
  const Index n_edges = mesh_.n_edges();
  terms_.resize(n_edges, mesh_.n_corners(), halves_, sources_);
  if (options_.coefficient) coefficient_ = coefficients(points);
  std::atomic<bool> any_excluded{false}, any_thin{false};
  parallel_blocks(n_edges, options_.threads, [&](int, Index begin, Index end) {
    Block block{};  // lanes without a diamond hold numbers as well
    TriangleCrossingBlock crossing;
    bool excluded = false, thin = false;
    for (Index first = begin; first < end; first += kBlockDiamonds) {
      const Index size = std::min<Index>(kBlockDiamonds, end - first);
      gather(points, first, size, block);
      if (halves_)
        triangle_diamond_block(block, options_.eps_rel, crossing);
      else
        triangle_diamond_block(block, options_.eps_rel);
      if (!options_.own_interfaces.empty()) leave_out(first, size, block);
      for (Index k = 0; k < size; ++k) {
        const Index e = first + k;
        const double scale = coefficient_.empty() || is_left_out(e) ? 1.0 : coefficient_[e];
        terms_.values[e] = -scale * block.alpha[k];
        terms_.values[n_edges + e] = -scale * block.gamma[k] / 9;
        if (halves_) {
          set_halves(e, scale, block, crossing, k);
        } else {
          // The literal quarter of (23) would lose a quarter of every boundary diamond, which has
          // three vertices.   [BBA21 (23)]
          const double share = block.inner[k] > 0 ? 1.0 / 36 : 1.0 / 27;
          terms_.around[e] = {scale * block.beta[k] / 3, share * block.area[k]};
        }
        result_.sample_measure[e] = block.area[k];
        excluded |= !(block.area[k] > 0) && !is_left_out(e);
        thin |= block.thin[k] > 0;
      }
    }
    if (excluded) any_excluded = true;
    if (thin) any_thin = true;
  });
  any_excluded_ = any_excluded;
  any_thin_ = any_thin;
}

/// The coefficient at the centroids of the diamonds. One thread: the caller's function is not asked
/// to be thread-safe.
Array<double> TriangleDiamondAssembly::coefficients(const Points& points) const {
  Array<double> result(static_cast<std::size_t>(mesh_.n_edges()));
  for (Index e = 0; e < mesh_.n_edges(); ++e) {
    if (is_left_out(e)) continue;
    const Diamond d = diamond(e);
    const Vec3 x1 = points.row(d.v1).transpose();
    const Vec3 hinge = Vec3(points.row(d.v2).transpose()) - x1;
    Vec3 moment = Vec3::Zero();
    double weight = 0;
    for (const Index opposite : {d.left, d.right}) {
      if (opposite < 0) continue;
      const Vec3 side = Vec3(points.row(opposite).transpose()) - x1;
      const double area = hinge.cross(side).norm();
      moment += area * (hinge + (hinge + side) / 3) / 3;
      weight += area;
    }
    result[e] = weight > 0 ? coefficient_at(options_, x1 + moment / weight) : 1.0;
  }
  return result;
}

void TriangleDiamondAssembly::report(const Points& points) {
  result_.diagnostics = {};
  report_unreferenced(unreferenced_, result_.diagnostics);
  std::vector<Index> degenerate, excluded;
  if (any_thin_) {
    VirtualVertexKernel kernel(options_.virtual_vertex);
    std::array<double, 3> weights;
    std::array<VirtualTriangle, 3> triangles;
    for (Index f = 0; f < mesh_.n_faces(); ++f)
      if (kernel.compute(points, mesh_.face(f), weights.data(), triangles.data()) ==
          VirtualVertexStatus::Degenerate)
        degenerate.push_back(f);
  }
  report_virtual_vertices({}, {}, std::move(degenerate), result_.diagnostics);
  if (any_excluded_)
    for (Index e = 0; e < mesh_.n_edges(); ++e)
      if (!(result_.sample_measure[e] > 0) && !is_left_out(e)) excluded.push_back(e);
  report_degenerate(
      std::move(excluded), options_, "diamond",
      [&](Index e) {
        return "edge " + std::to_string(e) + " between vertices " +
               std::to_string(incidence_.edge_vertices[e][0]) + " and " +
               std::to_string(incidence_.edge_vertices[e][1]);
      },
      result_.diagnostics);
}

void TriangleDiamondAssembly::reassemble(const Points& points) {
  compute_terms(points);
  assemble_triangle_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, sources_,
                             options_.threads, terms_);
  report(points);
}

}  // namespace

std::unique_ptr<Assembly> make_triangle_diamond(const char* name, const PolygonMesh& mesh,
                                                const DiscretizationOptions& options) {
  if (mesh.n_faces() == 0) return nullptr;
  // No face has fewer than three corners.
  if (mesh.n_corners() != 3 * std::int64_t{mesh.n_faces()} ||
      !has_triangle_diamonds(TriangleDiamondAssembly::incidence(mesh, options.threads),
                             options.threads))
    return nullptr;
  return std::make_unique<TriangleDiamondAssembly>(name, mesh, options);
}

}  // namespace carat
