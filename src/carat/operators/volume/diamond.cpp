// The Diamond Laplacian in volumes: Bunge, Botsch, Alexa 2021, section 6.

#include <algorithm>
#include <atomic>
#include <cmath>

#include "carat/assembly/pattern.h"
#include "carat/assembly/tet_diamond_assembly.h"
#include "carat/assembly/volume_diamond_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/diamond_3d.h"
#include "carat/kernels/tet_diamond.h"
#include "carat/kernels/virtual_cell.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/operators/volume/incidence.h"
#include "carat/prolongation/virtual_cells.h"

namespace carat {
namespace {

class VolumeDiamondAssembly final : public Assembly {
 public:
  VolumeDiamondAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options);
  void update(const Points& points) override;

 private:
  /// A face with its two tips; where a cell is missing its own virtual vertex stands in.
  struct FaceTips {
    Vec3 face_point, below, above;
  };

  // Symbolic.
  void make_gradient_pattern();
  void collect_columns(Index f, Array<Index>& columns) const;

  // Numeric.
  bool compute_tets();
  TetFaceDiamonds tet_face(Index f, Index own, Index across, bool above) const;
  void compute_faces();
  template <class Conductivity>
  void compute_face(Index f, const Conductivity& conductivity);
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
  bool has_cells(Index f) const {
    return mesh_.face_cells()[f].below >= 0 || mesh_.face_cells()[f].above >= 0;
  }
  Index n_diamonds() const { return mesh_.face_mesh().n_corners(); }

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  bool lumped_ = options_.mass == MassKind::Lumped;
  VolumeIncidence incidence_;
  CellRings rings_;
  VirtualCells virtuals_;
  VolumeDiamondWorkspace workspace_;
  bool tets_;  // all cells are tetrahedra and K = 1: the closed form serves
  TetTopology tet_topology_;
  TetDiamondWorkspace tet_workspace_;
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

VolumeDiamondAssembly::VolumeDiamondAssembly(const PolyhedralMesh& mesh,
                                             const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  check_cell_coefficient(options_, mesh_.n_cells());
  result_.name = "diamond";
  tets_ = !options_.coefficient && options_.cell_coefficient.size() == 0 && mesh_.n_cells() > 0;
  for (Index c = 0; c < mesh_.n_cells() && tets_; ++c)
    tets_ = mesh_.cells().size(c) == 4 && mesh_.cell_vertices().size(c) == 4;
  VolumeDiamondPatterns patterns;
  if (tets_) {
    tet_topology_ = tet_topology(incidence_, options_.threads);
    patterns = diamond_patterns(incidence_, tet_topology_, options_.threads);
  } else {
    rings_ = cell_rings(incidence_, options_.threads);
    patterns = diamond_patterns(incidence_, rings_, options_.threads);
    mesh_.face_mesh().vertex_corners();  // built on first use: here, not in the numeric phase
    mesh_.face_mesh().corner_faces();
  }
  result_.stiffness = std::move(patterns.stiffness);
  result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : std::move(patterns.mass);
  result_.sample_measure.resize(n_diamonds());
  if (options_.parts != DiscretizationParts::Matrices) make_gradient_pattern();
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

template <class Conductivity>
void VolumeDiamondAssembly::compute_face(Index f, const Conductivity& conductivity) {
  const Csr& faces = mesh_.face_mesh().faces();
  const Index first = faces.begin(f), last = faces.end(f);
  const FaceCells cells = mesh_.face_cells()[f];
  VolumeDiamondWorkspace::Corner* const corners = workspace_.corners.data();
  VolumeDiamondWorkspace::Face face{0, 0, 0, 0, 0};
  std::fill(corners + first, corners + last, VolumeDiamondWorkspace::Corner{0, 0, 0, 0, 0});
  if (cells.below >= 0 || cells.above >= 0) {
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
      const double side = ss + st, spoke_a = tt + st, spoke_b = -st;
      a.side = side;
      a.spoke += spoke_a;
      b.spoke += spoke_b;
      a.diagonal += side + spoke_a;
      b.diagonal += side + spoke_b;
      a.alpha -= sw + tw;
      b.alpha += sw;
      face.alpha += tw;
      face.spokes += tt;
      face.gamma += scale * diamond.w.dot(kw);
      // Boundary diamonds have four vertices, not five.   [BBA21 (33)]
      const double share = inner ? volume / 6 : volume / 4;
      a.mass += share;
      b.mass += share;
      face.mass += share;
      face.tip_mass += volume / 4;
    }
    if (!inner) {
      // u at the missing tip is that of the face point: fold its part into A and a.
      const double sign = cells.above < 0 ? 1.0 : -1.0;
      for (Index corner = first; corner < last; ++corner)
        corners[corner].spoke -= sign * corners[corner].alpha;
      face.spokes += 2 * sign * face.alpha + face.gamma;
      face.alpha += sign * face.gamma;
    }
  } else {
    std::fill(result_.sample_measure.begin() + first, result_.sample_measure.begin() + last, 0.0);
  }
  workspace_.faces[f] = face;
}

void VolumeDiamondAssembly::compute_faces() {
  workspace_.corners.resize(static_cast<std::size_t>(n_diamonds()));
  workspace_.faces.resize(static_cast<std::size_t>(mesh_.n_faces()));
  const bool plain = !options_.coefficient && options_.cell_coefficient.size() == 0;
  if (plain) {
    parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
      for (Index f = begin; f < end; ++f)
        compute_face(
            f, [](const Diamond3d& d, const Vec3&, const FaceTips&, Vec3& ks, Vec3& kt, Vec3& kw) {
              ks = d.s;
              kt = d.t;
              kw = d.w;
            });
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

/// \param own, across  the vertices opposite to the face; across < 0: none
TetFaceDiamonds VolumeDiamondAssembly::tet_face(Index f, Index own, Index across,
                                                bool above) const {
  // The same operations from either cell, so that both get the same bits.
  const std::span<const Index> face = mesh_.face(f);
  const Vec3 a = position(face[0]), b = position(face[1]), c = position(face[2]);
  const Vec3 x_own = position(own);
  const Vec3 x_across = across < 0 ? Vec3(a + ((b - a) + (c - a)) / 3) : position(across);
  const Vec3 tip = 0.25 * (above ? x_own - x_across : x_across - x_own);
  return tet_face_diamonds(a, b, c, tip, options_.eps_rel);
}

/// \return whether all tetrahedra have a volume: then there is nothing to report of their points
bool VolumeDiamondAssembly::compute_tets() {
  std::atomic<bool> sound = true;
  const Csr& cells = mesh_.cells();
  const Csr& faces = mesh_.face_mesh().faces();
  tet_workspace_.terms.resize(static_cast<std::size_t>(mesh_.n_cells()));
  // Faces without cells; the others are overwritten.
  result_.sample_measure.setZero();
  parallel_blocks(mesh_.n_cells(), options_.threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      TetTerm term{};
      const Index* const vertices =
          mesh_.cell_vertices().indices.data() + mesh_.cell_vertices().begin(c);
      if (is_flat_tetrahedron(position(vertices[0]), position(vertices[1]), position(vertices[2]),
                              position(vertices[3])))
        sound = false;
      for (std::size_t k = 0; k < 4; ++k) {
        const Index f = cells.indices[cells.begin(c) + static_cast<Index>(k)];
        const FaceCells sides = mesh_.face_cells()[f];
        const bool above = sides.above == c;
        const auto& place = tet_topology_.places[c][k];
        const Index across = tet_topology_.across[c][k];
        TetFaceDiamonds d = tet_face(f, vertices[place[3]], across, above);
        if (!above)
          for (double& alpha : d.alpha) alpha = -alpha;
        term.add_face(k, place, across < 0, d.ab, d.ac, d.bc, d.alpha, d.gamma, d.volume);
        if (!above || sides.below < 0)
          result_.sample_measure.segment<3>(faces.begin(f)).setConstant(d.volume);
      }
      tet_workspace_.terms[c] = term;
    }
  });
  return sound;
}

void VolumeDiamondAssembly::collect_columns(Index f, Array<Index>& columns) const {
  columns.clear();
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
  result_.gradient_dimension = 3;
  const Csr& faces = mesh_.face_mesh().faces();
  if (std::int64_t{n_diamonds()} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(n_diamonds()) +
                      " diamonds has more rows than 32 bits can number; split the mesh");
  Array<Index> row_sizes(3 * static_cast<std::size_t>(n_diamonds()));
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index f = begin; f < end; ++f) {
      collect_columns(f, columns);
      std::fill(row_sizes.begin() + 3 * std::ptrdiff_t{faces.begin(f)},
                row_sizes.begin() + 3 * std::ptrdiff_t{faces.end(f)},
                static_cast<Index>(columns.size()));
    }
  });
  result_.gradient =
      allocate_rows(3 * n_diamonds(), mesh_.n_vertices(), row_sizes, "the diamond gradient");
  Index* const inner = result_.gradient.innerIndexPtr();
  const Index* const outer = result_.gradient.outerIndexPtr();
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index f = begin; f < end; ++f) {
      collect_columns(f, columns);
      for (Index row = 3 * faces.begin(f); row < 3 * faces.end(f); ++row)
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
    Vector of_face, of_tips;
    Array<Index> place;
    for (Index f = begin; f < end; ++f) {
      if (!has_cells(f)) continue;
      const Index first = faces.begin(f), last = faces.end(f);
      const Index* const columns = inner + outer[3 * first];
      const Index n = outer[3 * first + 1] - outer[3 * first];
      const auto find = [&](Index v) {
        return static_cast<Index>(std::lower_bound(columns, columns + n, v) - columns);
      };
      of_face.setZero(n);
      of_tips.setZero(n);
      place.clear();
      for (Index k = first; k < last; ++k) {
        place.push_back(find(faces.indices[k]));
        of_face[place.back()] += virtuals_.faces.weights[k];
      }
      const auto add_tip = [&](Index c, double sign) {
        if (c < 0) {
          of_tips += sign * of_face;
          return;
        }
        for (Index k = cells.begin(c); k < cells.end(c); ++k)
          of_tips[find(cells.indices[k])] += sign * virtuals_.cell_weights[k];
      };
      add_tip(mesh_.face_cells()[f].above, 1);
      add_tip(mesh_.face_cells()[f].below, -1);
      const FaceTips tip = tips(f);
      for (Index corner = first; corner < last; ++corner) {
        double* const rows = values + outer[3 * corner];
        const Index next = corner + 1 == last ? first : corner + 1;
        const Diamond3d diamond =
            diamond_3d(position(faces.indices[corner]), position(faces.indices[next]),
                       tip.face_point, tip.below, tip.above, options_.eps_rel);
        if (!(diamond.determinant > 0)) {
          std::fill(rows, rows + 3 * n, 0.0);
          continue;
        }
        const Eigen::Matrix<double, 3, 5> g = diamond_gradient(diamond);
        for (Index d = 0; d < 3; ++d) {
          for (Index k = 0; k < n; ++k)
            rows[d * n + k] = g(d, 2) * of_face[k] + g(d, 4) * of_tips[k];
          rows[d * n + place[corner - first]] += g(d, 0);
          rows[d * n + place[next - first]] += g(d, 1);
        }
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
      if (has_cells(f) && !(result_.sample_measure[corner] > 0)) excluded.push_back(corner);
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

void VolumeDiamondAssembly::update(const Points& points) {
  centre_points(points, points_, origin_);
  // In closed form tetrahedra need no virtual vertices, only the gradient and reports do.
  virtuals_.cell_status.clear();
  virtuals_.faces.status.clear();
  if (!tets_ || !compute_tets() || options_.parts != DiscretizationParts::Matrices)
    update_virtual_cells(mesh_, points_, options_.virtual_vertex, options_.threads, virtuals_);
  // S = -L and M = P^T M^ P   [BBA21 (31), (32)]
  if (tets_) {
    assemble_tet_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, tet_topology_,
                          options_.threads, tet_workspace_);
  } else {
    compute_faces();
    assemble_volume_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, rings_,
                             mesh_.face_mesh().vertex_corners(), mesh_.face_mesh().corner_faces(),
                             virtuals_.faces.weights, virtuals_.cell_weights, options_.threads,
                             workspace_);
  }
  if (options_.parts != DiscretizationParts::Matrices) assemble_gradient();
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

}  // namespace

extern const VolumeOperator diamond_volume_operator = {
    "diamond",
    "Diamond Laplacian: gradients on the minimal diamonds of faces",
    "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    {.virtual_vertex = true},
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
    [](const PolyhedralMesh& mesh,
       const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<VolumeDiamondAssembly>(mesh, options);
    }};

}  // namespace carat
