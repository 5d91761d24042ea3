// The Diamond Laplacian in volumes: Bunge, Botsch, Alexa 2021, section 6. Stabilised, it has one
// more row of the gradient a diamond, for the jump between the diamond's halves.

#include "carat/operators/volume/diamond.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carat/assembly/diamond_product.h"
#include "carat/assembly/pattern.h"
#include "carat/assembly/volume_diamond_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/diamond_3d.h"
#include "carat/kernels/diamond_split.h"
#include "carat/kernels/face_diamond_block.h"
#include "carat/kernels/virtual_cell.h"
#include "carat/operators/common.h"
#include "carat/operators/linear_tets.h"
#include "carat/operators/registry.h"
#include "carat/operators/tet_diamonds.h"
#include "carat/operators/volume/incidence.h"
#include "carat/prolongation/virtual_cells.h"

namespace carat {
namespace {

class VolumeDiamondAssembly final : public Assembly {
 public:
  VolumeDiamondAssembly(const char* name, const PolyhedralMesh& mesh,
                        const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  /// A face with its two tips; where a cell is missing its own virtual vertex stands in.
  struct FaceTips {
    Vec3 face_point, below, above;
  };

  // Symbolic.
  void make_gradient_pattern();
  void collect_columns(Index f, Array<Index>& columns) const;

  // Numeric.
  void compute_faces();
  void add_split(const Diamond3d& diamond, const DiamondCrossing<3>& crossing, double gamma,
                 Index corner, Index next, VolumeDiamondWorkspace::Face& face);
  template <class Conductivity>
  void compute_face(Index f, const Conductivity& conductivity);
  struct FaceBlock;
  void compute_isotropic_face(Index f);
  void compute_block(FaceBlock& block, Index valence);
  void fold_missing_tip(Index f);
  void assemble_gradient();
  void collect_frames();
  void report();

  FaceTips tips(Index f) const {
    const FaceCells cells = mesh_.face_cells()[f];
    const Vec3 xf = virtuals_.face_points.row(f).transpose();
    const auto tip = [&](Index c) -> Vec3 {
      return c < 0 ? xf : Vec3(virtuals_.cell_points.row(c).transpose());
    };
    return {xf, tip(cells.below), tip(cells.above)};
  }
  Vec3 position(Index v) const { return points_.row(v).transpose(); }
  /// Has cells, and is not another part's.
  bool has_diamonds(Index f) const {
    return (mesh_.face_cells()[f].below >= 0 || mesh_.face_cells()[f].above >= 0) &&
           (options_.own_interfaces.empty() || options_.own_interfaces[f]);
  }
  Index n_diamonds() const { return mesh_.face_mesh().n_corners(); }

  /// As in the paper.
  bool plain() const { return theta_ == 1 && !moment_exact_; }

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  double theta_ = options_.theta.value_or(1.0);
  bool moment_exact_ = options_.mass == MassKind::MomentExact;
  Index n_rows_ = theta_ < 1 ? 4 : 3;  // of the gradient, a diamond
  bool lumped_ = options_.mass == MassKind::Lumped;
  VolumeIncidence incidence_;
  std::shared_ptr<const ElementStructure> structure_;  // only of products, like the pattern
  SparseMatrix interface_pattern_;
  CellRings rings_;
  VirtualCells virtuals_;
  VolumeDiamondWorkspace workspace_;
  bool tets_;  // all cells are tetrahedra, K = 1: the closed form serves
  TetTopology tet_topology_;
  TetDiamondTerms tet_diamonds_;
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

VolumeDiamondAssembly::VolumeDiamondAssembly(const char* name, const PolyhedralMesh& mesh,
                                             const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  check_cell_coefficient(options_, mesh_.n_cells());
  check_own_interfaces(options_, mesh_.n_faces());
  result_.name = name;
  const bool products = options_.form == OperatorForm::Products;
  tets_ = !products && !options_.coefficient && options_.cell_coefficient.size() == 0 &&
          mesh_.n_cells() > 0 && all_tetrahedra(incidence_);
  VolumeDiamondPatterns patterns;
  if (tets_) {
    tet_topology_ = tet_topology(incidence_, options_.own_interfaces, options_.threads);
    patterns = diamond_patterns(incidence_, tet_topology_, options_.threads);
  } else {
    if (products) {
      structure_ = diamond_structure(incidence_);
      interface_pattern_ = interface_pattern(incidence_, mesh_.face_mesh().vertex_corners(),
                                             mesh_.face_mesh().corner_faces(), options_.threads);
    } else {
      rings_ = cell_rings(incidence_, options_.threads);
      patterns = diamond_patterns(incidence_, rings_, options_.threads);
    }
    mesh_.face_mesh().vertex_corners();  // built on first use: here, not in the numeric phase
    mesh_.face_mesh().corner_faces();
  }
  if (!products) {
    result_.stiffness = std::move(patterns.stiffness);
    result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : std::move(patterns.mass);
  }
  result_.sample_measure.setZero(n_diamonds());  // of faces without cells, for good
  if (options_.parts >= DiscretizationParts::Gradient) make_gradient_pattern();
}

/// K of a diamond is that of its cells by their parts of it, times the function at its centroid.
struct DiamondConductivity {
  const DiscretizationOptions& options;
  const Vec3& origin;
  FaceCells cells;

  Eigen::Matrix3d operator()(const Diamond3d& diamond, const Vec3& base, const Vec3& below,
                             const Vec3& above) const {
    // Parts of the volume below and above the base, from the heights of the tips.
    const double under = std::max(0.0, diamond.w.dot(base - below));
    const double over = std::max(0.0, diamond.w.dot(above - base));
    const double part = under + over > 0 ? under / (under + over) : 0.5;
    Eigen::Matrix3d k = Eigen::Matrix3d::Zero();
    if (cells.below >= 0) k += (cells.above >= 0 ? part : 1.0) * cell_tensor(options, cells.below);
    if (cells.above >= 0)
      k += (cells.below >= 0 ? 1.0 - part : 1.0) * cell_tensor(options, cells.above);
    if (options.coefficient)
      k *= coefficient_at(options,
                          origin + 0.75 * base + 0.25 * (part * below + (1 - part) * above));
    return k;
  }
};

/// The jump between the halves of a diamond, and masses that its halves tell apart.
/// \param gamma  |D| times the square of the gradient's derivative by u_above - u_below
void VolumeDiamondAssembly::add_split(const Diamond3d& diamond, const DiamondCrossing<3>& crossing,
                                      double gamma, Index corner, Index next,
                                      VolumeDiamondWorkspace::Face& face) {
  VolumeDiamondWorkspace::Corner &a = workspace_.corners[corner], &b = workspace_.corners[next];
  VolumeDiamondWorkspace::Tips &tips_a = workspace_.tips[corner], &tips_b = workspace_.tips[next];
  // Stiffness (left u_l + right u_r - sum of base u)^2; gamma brings K across the base.
  const auto& [at_a, at_b, at_f] = crossing.base;
  const double jump =
      crossing.stiffness > 0
          ? (1 - theta_) * gamma / (crossing.left_fraction * (1 - crossing.left_fraction))
          : 0.0;
  a.side -= jump * at_a * at_b;
  a.spoke -= jump * at_a * at_f;
  b.spoke -= jump * at_b * at_f;
  a.diagonal += jump * at_a * at_a;
  b.diagonal += jump * at_b * at_b;
  face.spokes += jump * at_f * at_f;
  tips_a.below -= jump * crossing.left * at_a;
  tips_b.below -= jump * crossing.left * at_b;
  face.below -= jump * crossing.left * at_f;
  tips_a.above -= jump * crossing.right * at_a;
  tips_b.above -= jump * crossing.right * at_b;
  face.above -= jump * crossing.right * at_f;
  face.gamma_below += jump * crossing.left * crossing.left;
  face.gamma_above += jump * crossing.right * crossing.right;
  face.gamma_across -= jump * crossing.left * crossing.right;
  const double volume = diamond.volume();
  DiamondMass<3> mass{{1.0 / 6, 1.0 / 6, 1.0 / 6}, 0.25, 0.25};  // [BBA21 (33)]
  if (moment_exact_) mass = moment_exact_mass(crossing, *options_.tau);
  a.mass += volume * mass.base[0];
  b.mass += volume * mass.base[1];
  face.mass += volume * mass.base[2];
  face.mass_below += volume * mass.left;
  face.mass_above += volume * mass.right;
}

template <class Conductivity>
void VolumeDiamondAssembly::compute_face(Index f, const Conductivity& conductivity) {
  const Csr& faces = mesh_.face_mesh().faces();
  const Index first = faces.begin(f), last = faces.end(f);
  const FaceCells cells = mesh_.face_cells()[f];
  VolumeDiamondWorkspace::Corner* const corners = workspace_.corners.data();
  VolumeDiamondWorkspace::Face face{};
  VolumeDiamondWorkspace::Tips* const corner_tips = workspace_.tips.data();
  std::fill(corners + first, corners + last, VolumeDiamondWorkspace::Corner{});
  std::fill(corner_tips + first, corner_tips + last, VolumeDiamondWorkspace::Tips{});
  if (has_diamonds(f)) {
    const FaceTips tip = tips(f);
    const bool inner = cells.below >= 0 && cells.above >= 0;
    for (Index corner = first; corner < last; ++corner) {
      const Index next = corner + 1 == last ? first : corner + 1;
      const Vec3 x1 = position(faces.indices[corner]), x2 = position(faces.indices[next]);
      const Diamond3d diamond =
          diamond_3d(x1, x2, tip.face_point, tip.below, tip.above, options_.eps_rel);
      const double volume = diamond.volume();
      result_.sample_measure[corner] = volume;
      if (!(volume > 0)) continue;
      // |D| g^T K g = (s, t, w) (products)^T K (products) (s, t, w)^T / (6 det)
      const double scale = 1 / (6 * diamond.determinant);
      Vec3 ks, kt, kw;
      conductivity(diamond, (x1 + x2 + tip.face_point) / 3, tip, ks, kt, kw);
      const double ss = scale * diamond.s.dot(ks), tt = scale * diamond.t.dot(kt),
                   st = scale * diamond.s.dot(kt), sw = scale * diamond.s.dot(kw),
                   tw = scale * diamond.t.dot(kw);
      VolumeDiamondWorkspace::Corner &a = corners[corner], &b = corners[next];
      VolumeDiamondWorkspace::Tips &tips_a = corner_tips[corner], &tips_b = corner_tips[next];
      const double side = ss + st, spoke_a = tt + st, spoke_b = -st;
      a.side = side;
      a.spoke += spoke_a;
      b.spoke += spoke_b;
      a.diagonal += side + spoke_a;
      b.diagonal += side + spoke_b;
      const double gamma = scale * diamond.w.dot(kw);
      tips_a.above -= sw + tw;
      tips_a.below += sw + tw;
      tips_b.above += sw;
      tips_b.below -= sw;
      face.above += tw;
      face.below -= tw;
      face.spokes += tt;
      face.gamma_below += gamma;
      face.gamma_above += gamma;
      face.gamma_across += gamma;
      if (!inner || plain()) {
        // Boundary diamonds have four vertices, not five.   [BBA21 (33)]
        const double share = inner ? volume / 6 : volume / 4;
        a.mass += share;
        b.mass += share;
        face.mass += share;
        face.mass_below += volume / 4;
        face.mass_above += volume / 4;
      } else {
        add_split(diamond,
                  diamond_crossing(diamond, x1, x2, tip.face_point, tip.below, tip.above,
                                   options_.eps_rel),
                  gamma, corner, next, face);
      }
    }
  } else {
    std::fill(result_.sample_measure.begin() + first, result_.sample_measure.begin() + last, 0.0);
  }
  workspace_.faces[f] = face;
  fold_missing_tip(f);
}

/// At the boundary u at the missing tip is that of the face point: folds its part into A and a.
void VolumeDiamondAssembly::fold_missing_tip(Index f) {
  const FaceCells cells = mesh_.face_cells()[f];
  if (!cells.boundary()) return;
  const Csr& faces = mesh_.face_mesh().faces();
  const bool no_above = cells.above < 0;
  for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
    const VolumeDiamondWorkspace::Tips& tip = workspace_.tips[corner];
    workspace_.corners[corner].spoke -= no_above ? tip.above : tip.below;
  }
  VolumeDiamondWorkspace::Face& face = workspace_.faces[f];
  const double gamma = face.gamma_across;
  face.spokes += 2 * (no_above ? face.above : face.below) + gamma;
  (no_above ? face.below : face.above) -= gamma;
}

void VolumeDiamondAssembly::compute_isotropic_face(Index f) {
  compute_face(f,
               [](const Diamond3d& d, const Vec3&, const FaceTips&, Vec3& ks, Vec3& kt, Vec3& kw) {
                 ks = d.s;
                 kt = d.t;
                 kw = d.w;
               });
}

/// Faces of one valence that wait until a block is full.
struct VolumeDiamondAssembly::FaceBlock {
  std::array<Index, kBlockDiamondFaces> faces;
  int size = 0;
};

/// Computes the waiting faces. A block that is not full repeats its last face, so that every face
/// gets the same bits wherever it stands.
void VolumeDiamondAssembly::compute_block(FaceBlock& block, Index valence) {
  if (block.size == 0) return;
  const Csr& faces = mesh_.face_mesh().faces();
  std::array<FaceDiamondInput, kBlockDiamondFaces> input;
  for (int l = 0; l < kBlockDiamondFaces; ++l) {
    const Index f = block.faces[std::min(l, block.size - 1)];
    const FaceCells cells = mesh_.face_cells()[f];
    const double* const point = virtuals_.face_points.data() + 3 * std::ptrdiff_t{f};
    const auto tip = [&](Index c) {
      return c < 0 ? point : virtuals_.cell_points.data() + 3 * std::ptrdiff_t{c};
    };
    // Boundary diamonds have four vertices, not five.   [BBA21 (33)]
    input[l] = {faces.indices.data() + faces.begin(f), point, tip(cells.below), tip(cells.above),
                cells.boundary() ? 4.0 : 6.0};
  }
  FaceDiamonds sums;
  const unsigned degenerate =
      face_diamond_block(valence, points_.data(), input.data(), options_.eps_rel, sums);
  for (int l = 0; l < block.size; ++l) {
    const Index f = block.faces[l], first = faces.begin(f);
    if ((degenerate >> l & 1U) != 0) {
      compute_isotropic_face(f);
      continue;
    }
    for (int i = 0; i < valence; ++i) {
      workspace_.corners[first + i] = {sums.side[i][l], sums.spoke[i][l], sums.diagonal[i][l],
                                       sums.mass[i][l]};
      workspace_.tips[first + i] = {-sums.tip[i][l], sums.tip[i][l]};
      result_.sample_measure[first + i] = sums.volume[i][l];
    }
    workspace_.faces[f] = {.spokes = sums.point_diagonal[l],
                           .mass = sums.point_mass[l],
                           .below = -sums.point_tip[l],
                           .above = sums.point_tip[l],
                           .gamma_below = sums.gamma[l],
                           .gamma_above = sums.gamma[l],
                           .gamma_across = sums.gamma[l],
                           .mass_below = sums.tip_mass[l],
                           .mass_above = sums.tip_mass[l]};
    fold_missing_tip(f);
  }
  block.size = 0;
}

void VolumeDiamondAssembly::compute_faces() {
  workspace_.corners.resize(static_cast<std::size_t>(n_diamonds()));
  workspace_.tips.resize(static_cast<std::size_t>(n_diamonds()));
  workspace_.faces.resize(static_cast<std::size_t>(mesh_.n_faces()));
  if (!options_.coefficient && options_.cell_coefficient.size() == 0) {
    parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
      std::array<FaceBlock, kMostDiamondCorners + 1> waiting;  // by valence
      for (Index f = begin; f < end; ++f) {
        const Index valence = mesh_.face_mesh().faces().size(f);
        if (!plain() || !has_diamonds(f) || !has_face_diamond_block(valence)) {
          compute_isotropic_face(f);
          continue;
        }
        FaceBlock& block = waiting[static_cast<std::size_t>(valence)];
        block.faces[block.size++] = f;
        if (block.size == kBlockDiamondFaces) compute_block(block, valence);
      }
      for (Index valence = 0; valence <= kMostDiamondCorners; ++valence)
        compute_block(waiting[static_cast<std::size_t>(valence)], valence);
    });
    return;
  }
  const auto compute = [&](Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      const DiamondConductivity conductivity{options_, origin_, mesh_.face_cells()[f]};
      compute_face(f, [&](const Diamond3d& d, const Vec3& base, const FaceTips& tip, Vec3& ks,
                          Vec3& kt, Vec3& kw) {
        const Eigen::Matrix3d k = conductivity(d, base, tip.below, tip.above);
        ks = k * d.s;
        kt = k * d.t;
        kw = k * d.w;
      });
    }
  };
  // The caller's function is not asked to be thread-safe.
  if (options_.coefficient)
    compute(0, mesh_.n_faces());
  else
    parallel_blocks(mesh_.n_faces(), options_.threads,
                    [&](int, Index begin, Index end) { compute(begin, end); });
}

void VolumeDiamondAssembly::collect_columns(Index f, Array<Index>& columns) const {
  columns.clear();
  if (!has_diamonds(f)) return;
  const FaceCells cells = mesh_.face_cells()[f];
  for (const Index c : {cells.below, cells.above}) {
    if (c < 0) continue;
    const std::span<const Index> vertices = mesh_.cell_vertices().row(c);
    columns.insert(columns.end(), vertices.begin(), vertices.end());
  }
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
}

void VolumeDiamondAssembly::make_gradient_pattern() {
  result_.gradient_dimension = n_rows_;
  result_.jump_components = n_rows_ - 3;
  result_.jump_weight = 1 - theta_;
  const Csr& faces = mesh_.face_mesh().faces();
  if (std::int64_t{n_diamonds()} * n_rows_ > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(n_diamonds()) +
                      " diamonds has more rows than 32 bits can number; split the mesh");
  Array<Index> row_sizes(static_cast<std::size_t>(n_rows_) *
                         static_cast<std::size_t>(n_diamonds()));
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index f = begin; f < end; ++f) {
      collect_columns(f, columns);
      std::fill(row_sizes.begin() + std::ptrdiff_t{n_rows_} * faces.begin(f),
                row_sizes.begin() + std::ptrdiff_t{n_rows_} * faces.end(f),
                static_cast<Index>(columns.size()));
    }
  });
  result_.gradient =
      allocate_rows(n_rows_ * n_diamonds(), mesh_.n_vertices(), row_sizes, "the diamond gradient");
  Index* const inner = result_.gradient.innerIndexPtr();
  const Index* const outer = result_.gradient.outerIndexPtr();
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index f = begin; f < end; ++f) {
      collect_columns(f, columns);
      for (Index row = n_rows_ * faces.begin(f); row < n_rows_ * faces.end(f); ++row)
        std::copy(columns.begin(), columns.end(), inner + outer[row]);
    }
  });
}

void VolumeDiamondAssembly::assemble_gradient() {
  // G = G^ P     [BBA21 (27), (31)]
  const Csr& faces = mesh_.face_mesh().faces();
  const Csr& cells = mesh_.cell_vertices();
  const Index* const outer = result_.gradient.outerIndexPtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  double* const values = result_.gradient.valuePtr();
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    // Of the columns of a face: the weights of u_f and u_above - u_below.
    Vector of_face, of_below, of_above;
    Array<Index> place;
    for (Index f = begin; f < end; ++f) {
      if (!has_diamonds(f)) continue;
      const Index first = faces.begin(f), last = faces.end(f);
      const Index* const columns = inner + outer[n_rows_ * first];
      const Index n = outer[n_rows_ * first + 1] - outer[n_rows_ * first];
      const auto find = [&](Index v) {
        return static_cast<Index>(std::lower_bound(columns, columns + n, v) - columns);
      };
      of_face.setZero(n);
      place.clear();
      for (Index k = first; k < last; ++k) {
        place.push_back(find(faces.indices[k]));
        of_face[place.back()] += virtuals_.faces.weights[k];
      }
      const auto set_tip = [&](Index c, Vector& of_tip) {
        if (c < 0) {
          of_tip = of_face;
          return;
        }
        of_tip.setZero(n);
        for (Index k = cells.begin(c); k < cells.end(c); ++k)
          of_tip[find(cells.indices[k])] += virtuals_.cell_weights[k];
      };
      const FaceCells sides = mesh_.face_cells()[f];
      set_tip(sides.above, of_above);
      set_tip(sides.below, of_below);
      const bool inner_face = sides.above >= 0 && sides.below >= 0;
      const FaceTips tip = tips(f);
      for (Index corner = first; corner < last; ++corner) {
        double* const rows = values + outer[n_rows_ * corner];
        const Index next = corner + 1 == last ? first : corner + 1;
        const Vec3 x1 = position(faces.indices[corner]), x2 = position(faces.indices[next]);
        const Diamond3d diamond =
            diamond_3d(x1, x2, tip.face_point, tip.below, tip.above, options_.eps_rel);
        std::fill(rows, rows + n_rows_ * n, 0.0);
        if (!(diamond.determinant > 0)) continue;
        const auto fill_row = [&](Index row, double at_1, double at_2, double at_f, double at_below,
                                  double at_above) {
          double* const out = rows + row * n;
          for (Index k = 0; k < n; ++k)
            out[k] = at_f * of_face[k] + at_below * of_below[k] + at_above * of_above[k];
          out[place[corner - first]] += at_1;
          out[place[next - first]] += at_2;
        };
        const Eigen::Matrix<double, 3, 5> g = diamond_gradient(diamond);
        for (Index d = 0; d < 3; ++d) fill_row(d, g(d, 0), g(d, 1), g(d, 2), g(d, 3), g(d, 4));
        if (n_rows_ == 3 || !inner_face) continue;
        // Times |D| in its square it is the jump's energy.
        const DiamondCrossing<3> crossing = diamond_crossing(
            diamond, x1, x2, tip.face_point, tip.below, tip.above, options_.eps_rel);
        const double scale = std::sqrt((1 - theta_) * crossing.stiffness / diamond.volume());
        fill_row(3, -scale * crossing.base[0], -scale * crossing.base[1], -scale * crossing.base[2],
                 scale * crossing.left, scale * crossing.right);
      }
    }
  });
}

void VolumeDiamondAssembly::collect_frames() {
  const Csr& faces = mesh_.face_mesh().faces();
  result_.frames = {};
  result_.frames.parts.reserve(2 * static_cast<std::size_t>(n_diamonds()));
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    const FaceCells cells = mesh_.face_cells()[f];
    const FaceTips tip = tips(f);
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
      if (!(result_.sample_measure[corner] > 0)) continue;
      const Index next = mesh_.face_mesh().next_corner(f, corner);
      const Index v1 = faces.indices[corner], v2 = faces.indices[next];
      const Vec3 area = (position(v2) - position(v1)).cross(tip.face_point - position(v1));
      const auto add = [&](Index c, double volume) {
        if (c >= 0 && volume > 0) result_.frames.parts.push_back({volume, corner, c, {v1, v2, -1}});
      };
      add(cells.below, area.dot(tip.face_point - tip.below) / 6);
      add(cells.above, area.dot(tip.above - tip.face_point) / 6);
    }
  }
}

void VolumeDiamondAssembly::report() {
  const Csr& faces = mesh_.face_mesh().faces();
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  report_virtual_cells(virtuals_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index f = 0; f < mesh_.n_faces(); ++f)
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner)
      if (has_diamonds(f) && !(result_.sample_measure[corner] > 0)) excluded.push_back(corner);
  report_degenerate(
      std::move(excluded), options_, "diamond",
      [&](Index corner) {
        const Index f = mesh_.face_mesh().corner_faces()[corner];
        const FaceCells cells = mesh_.face_cells()[f];
        std::string text = "face " + std::to_string(f) + ", vertices " +
                           std::to_string(faces.indices[corner]) + " and " +
                           std::to_string(faces.indices[mesh_.face_mesh().next_corner(f, corner)]);
        for (const Index c : {cells.below, cells.above})
          if (c >= 0) text += ", cell " + std::to_string(c);
        return text;
      },
      result_.diagnostics);
}

void VolumeDiamondAssembly::reassemble(const Points& points) {
  centre_points(points, points_, origin_);
  const TetHalves halves{1 - theta_, moment_exact_, options_.tau.value_or(0.0)};
  const bool all_sound =
      tets_ && compute_tet_diamonds(points_, incidence_, tet_topology_, options_.eps_rel,
                                    plain() ? nullptr : &halves, options_.threads, tet_diamonds_,
                                    result_.sample_measure);
  if (!all_sound || options_.parts >= DiscretizationParts::Gradient) {
    update_virtual_cells(mesh_, points_, options_.virtual_vertex, options_.threads, virtuals_);
  } else {
    // In closed form tetrahedra need no virtual vertices, only the gradient and reports do.
    virtuals_.cell_status.clear();
    virtuals_.faces.status.clear();
  }
  // S = -L and M = P^T M^ P   [BBA21 (31), (32)]
  if (tets_) {
    assemble_tet_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, tet_topology_,
                          tet_diamonds_, options_.threads);
  } else {
    compute_faces();
  }
  if (structure_) {
    DiamondProducts products = diamond_products(
        structure_, interface_pattern_, lumped_, incidence_, mesh_.face_mesh().vertex_corners(),
        mesh_.face_mesh().corner_faces(), virtuals_.faces.weights, virtuals_.cell_weights,
        workspace_, options_.threads);
    result_.stiffness_product = std::move(products.stiffness);
    result_.mass_product = std::move(products.mass);
  } else if (!tets_) {
    assemble_volume_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, rings_,
                             mesh_.face_mesh().vertex_corners(), mesh_.face_mesh().corner_faces(),
                             virtuals_.faces.weights, virtuals_.cell_weights, options_.threads,
                             workspace_);
  }
  if (options_.parts >= DiscretizationParts::Gradient) assemble_gradient();
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

}  // namespace

std::unique_ptr<Assembly> make_diamond(const char* name, const PolyhedralMesh& mesh,
                                       const DiscretizationOptions& options) {
  return std::make_unique<VolumeDiamondAssembly>(name, mesh, options);
}

extern const VolumeOperator diamond_volume_operator = {
    "diamond",
    "Diamond Laplacian: gradients on the minimal diamonds of faces",
    "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    {.masses = {MassKind::Full, MassKind::MomentExact, MassKind::Lumped},
     .virtual_vertex = true,
     .tau = 1.0,
     .products = true,
     .own_interfaces = true},
    {"S = G^T M_d G with one gradient for every edge of every face: linear on the edge, the face's "
     "virtual vertex and those of the two cells, which are affine combinations of their vertices. "
     "Mass "
     "P^T M P, a sixth of a diamond to each vertex of its base and a quarter to each tip.",
     "vertices", "all vertices of the two cells of a face",
     "The default: the lowest error with the full mass. Rows couple vertices of neighbouring "
     "cells, so "
     "direct solvers take longer than with bunge.",
     "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021, "
     "equations (24) to (33)"},
    [](const PolyhedralMesh& mesh, const DiscretizationOptions& options) {
      return make_diamond("diamond", mesh, options);
    }};

}  // namespace carat
