// The Diamond Laplacian on surfaces: Bunge, Botsch, Alexa 2021, section 5. Stabilised, it has one
// more row of the gradient a diamond, for the jump between the diamond's halves.

#include "carat/operators/surface/diamond.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "carat/assembly/diamond_assembly.h"
#include "carat/assembly/diamond_product.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/diamond_2d.h"
#include "carat/kernels/diamond_split.h"
#include "carat/operators/common.h"
#include "carat/operators/diamond/triangle_diamond.h"
#include "carat/operators/registry.h"
#include "carat/operators/surface/incidence.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {
namespace {

/// The two corners of a diamond; -1 where the hinge's midpoint stands in for a missing face.
struct Sides {
  Index left, right;
};

/// \tparam Term  DiamondTerm as in the paper, GeneralDiamondTerm with jumps or a moment-exact mass
template <class Term>
class DiamondAssembly final : public Assembly {
 public:
  DiamondAssembly(const char* name, const PolygonMesh& mesh, const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  static constexpr bool kGeneral = std::is_same_v<Term, GeneralDiamondTerm>;

  // Symbolic.
  void find_diamonds();
  void make_gradient_pattern();

  // Numeric.
  void order_nonmanifold_faces(const Points& points);
  void compute_terms(const Points& points);
  void set_term(Term& term, const Diamond2d& value, double scale, double area,
                const Points& points) const;
  void assemble_gradient(const Points& points);
  void collect_frames(const Points& points);
  void report();

  Index first_diamond(Index e) const { return edge_diamonds_.empty() ? e : edge_diamonds_[e]; }
  Index end_diamond(Index e) const {
    return edge_diamonds_.empty() ? e + 1 : edge_diamonds_[e + 1];
  }
  Index n_diamonds() const { return static_cast<Index>(terms_.size()); }
  Index edge_of(Index diamond) const {
    const Term& term = terms_[diamond];
    return mesh_.edges().of_corner[term.left >= 0 ? term.left : term.right];
  }
  bool is_left_out(Index diamond) const {
    return !options_.own_interfaces.empty() && !options_.own_interfaces[edge_of(diamond)];
  }
  /// Face edges of more than two faces: each face is in two diamonds, so each counts half.
  double share(Index edge) const { return mesh_.edges().corners.size(edge) > 2 ? 0.5 : 1.0; }
  VirtualTriangle triangle(Index corner, Index v1) const {
    if (corner < 0) return kHingeMidpoint;
    VirtualTriangle t = virtuals_.triangles[corner];
    if (mesh_.faces().indices[corner] != v1) t.foot = 1 - t.foot;
    return t;
  }
  Diamond2d diamond(const Term& term, const Points& points) const {
    const double length2 = (points.row(term.v2) - points.row(term.v1)).squaredNorm();
    return diamond_2d(length2, triangle(term.left, term.v1), triangle(term.right, term.v1),
                      options_.eps_rel);
  }
  DiamondCrossing<2> crossing(const Term& term, const Points& points) const {
    const double length2 = (points.row(term.v2) - points.row(term.v1)).squaredNorm();
    return diamond_crossing(length2, triangle(term.left, term.v1), triangle(term.right, term.v1),
                            options_.eps_rel);
  }

  /// The matrices are the result's own between two calls of reassemble().
  void exchange_matrices() {
    result_.stiffness.swap(result_of(*triangles_).stiffness);
    result_.mass.swap(result_of(*triangles_).mass);
  }

  PolygonMesh mesh_;
  DiscretizationOptions options_;
  double theta_ = options_.theta.value_or(1.0);
  Index n_rows_ = theta_ < 1 ? 3 : 2;  // of the gradient, a diamond
  bool lumped_ = options_.mass == MassKind::Lumped;
  SurfaceIncidence incidence_;
  std::shared_ptr<const ElementStructure> structure_;  // only of products
  std::unique_ptr<Assembly> triangles_;  // makes the matrices of triangles, as without a gradient
  FaceRings rings_;
  Array<Index> edge_diamonds_;  // empty: diamond e belongs to edge e
  Array<Term> terms_;
  VirtualVertices virtuals_;
  DiamondWorkspace workspace_;
  Points face_points_;  // only where frames or a coefficient need them
};

/// The matrices do not depend on whether a gradient is asked for beside them, not in the last bit.
std::unique_ptr<Assembly> closed_form(const char* name, const PolygonMesh& mesh,
                                      DiscretizationOptions options) {
  options.parts = DiscretizationParts::Matrices;
  return make_triangle_diamond(name, mesh, options);
}

template <class Term>
DiamondAssembly<Term>::DiamondAssembly(const char* name, const PolygonMesh& mesh,
                                       const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(surface_incidence(mesh_, options.threads)) {
  check_own_interfaces(options_, mesh_.n_edges());
  result_.name = name;
  if (options_.form == OperatorForm::Products) {
    structure_ = diamond_structure(incidence_);
  } else if ((triangles_ = closed_form(name, mesh_, options_))) {
    exchange_matrices();
  } else {
    rings_ = face_rings(incidence_, options_.threads);
    DiamondPatterns patterns = diamond_patterns(incidence_, rings_, options_.threads);
    result_.stiffness = std::move(patterns.stiffness);
    result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : std::move(patterns.mass);
  }
  find_diamonds();
  result_.sample_measure.resize(n_diamonds());
  if (options_.parts != DiscretizationParts::Matrices) make_gradient_pattern();
}

template <class Term>
void DiamondAssembly<Term>::find_diamonds() {
  const EdgeTopology& edges = mesh_.edges();
  const Csr& corners = edges.corners;
  bool manifold = true;
  for (Index e = 0; e < edges.size() && manifold; ++e) manifold = corners.size(e) <= 2;
  if (!manifold) {
    edge_diamonds_.resize(static_cast<std::size_t>(edges.size()) + 1);
    std::int64_t total = 0;
    for (Index e = 0; e <= edges.size(); ++e) {
      edge_diamonds_[e] = static_cast<Index>(total);
      if (e < edges.size()) total += corners.size(e) <= 2 ? 1 : corners.size(e);
    }
  }
  terms_.resize(static_cast<std::size_t>(manifold ? edges.size() : edge_diamonds_.back()));
  parallel_blocks(edges.size(), options_.threads, [&](int, Index begin, Index end) {
    for (Index e = begin; e < end; ++e) {
      const Index v1 = edges.vertices[e][0], v2 = edges.vertices[e][1];
      const std::span<const Index> around = corners.row(e);
      // Left is the face that runs along the hinge from v1 to v2. Where both do, or neither, it
      // is the one that comes first.
      const auto runs_along = [&](Index c) { return mesh_.faces().indices[c] == v1; };
      Sides sides{around[0], around.size() > 1 ? around[1] : -1};
      if (!runs_along(around[0]) && (around.size() == 1 || runs_along(around[1])))
        std::swap(sides.left, sides.right);
      for (Index d = first_diamond(e); d < end_diamond(e); ++d) {
        Term term{};
        term.v1 = v1;
        term.v2 = v2;
        term.left = sides.left;
        term.right = sides.right;
        terms_[d] = term;
      }
    }
  });
}

template <class Term>
void DiamondAssembly<Term>::order_nonmanifold_faces(const Points& points) {
  if (edge_diamonds_.empty()) return;
  const EdgeTopology& edges = mesh_.edges();
  const Points face_points = carat::face_points(mesh_, points, virtuals_.weights);
  struct Around {
    double angle;
    Index corner;
  };
  std::vector<Around> around;
  for (Index e = 0; e < edges.size(); ++e) {
    if (edges.corners.size(e) <= 2) continue;
    const Vec3 x1 = points.row(edges.vertices[e][0]).transpose();
    const Vec3 hinge = Vec3(points.row(edges.vertices[e][1]).transpose()) - x1;
    around.clear();
    Vec3 reference = Vec3::Zero();
    for (const Index corner : edges.corners.row(e)) {
      const Vec3 to_face = Vec3(face_points.row(mesh_.corner_faces()[corner]).transpose()) - x1;
      const Vec3 normal = hinge.cross(to_face);
      if (reference.isZero(0)) reference = normal;
      double angle =
          std::atan2(reference.cross(normal).dot(hinge.normalized()), reference.dot(normal));
      if (angle < 0) angle += 2 * std::numbers::pi;
      around.push_back({angle, corner});
    }
    std::sort(around.begin(), around.end(), [](const Around& a, const Around& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.corner < b.corner;
    });
    for (std::size_t k = 0; k < around.size(); ++k) {
      Term& term = terms_[edge_diamonds_[e] + static_cast<Index>(k)];
      term.left = around[k].corner;
      term.right = around[(k + 1) % around.size()].corner;
    }
  }
}

template <class Term>
void DiamondAssembly<Term>::compute_terms(const Points& points) {
  Array<double> coefficient;
  if (options_.coefficient) {
    // The caller's function is not asked to be thread-safe.
    coefficient.resize(terms_.size());
    for (Index d = 0; d < n_diamonds(); ++d) {
      if (is_left_out(d)) continue;
      const Term& term = terms_[d];
      const Vec3 x1 = points.row(term.v1).transpose(), x2 = points.row(term.v2).transpose();
      Vec3 moment = Vec3::Zero();
      double weight = 0;
      for (const Index corner : {term.left, term.right}) {
        if (corner < 0) continue;
        const double area = virtuals_.triangles[corner].double_area;
        const Vec3 xf = face_points_.row(mesh_.corner_faces()[corner]).transpose();
        moment += area * ((x2 - x1) + (xf - x1)) / 3;
        weight += area;
      }
      coefficient[d] = weight > 0 ? coefficient_at(options_, x1 + moment / weight) : 1.0;
    }
  }
  parallel_blocks(n_diamonds(), options_.threads, [&](int, Index begin, Index end) {
    for (Index d = begin; d < end; ++d) {
      Term& term = terms_[d];
      if (is_left_out(d)) {
        Term nothing{};
        nothing.v1 = term.v1;
        nothing.v2 = term.v2;
        nothing.left = term.left;
        nothing.right = term.right;
        term = nothing;
        result_.sample_measure[d] = 0;
        continue;
      }
      const Diamond2d value = diamond(term, points);
      const double part = edge_diamonds_.empty() ? 1.0 : share(edge_of(d));
      const double scale = options_.coefficient ? part * coefficient[d] : part;
      set_term(term, value, scale, part * value.area, points);
      result_.sample_measure[d] = part * value.area;
    }
  });
}

template <class Term>
void DiamondAssembly<Term>::set_term(Term& term, const Diamond2d& value, double scale, double area,
                                     const Points& points) const {
  // The literal quarter of (23) would lose a quarter of every boundary diamond, which has three
  // vertices.   [BBA21 (23)]
  const bool inner = term.left >= 0 && term.right >= 0;
  const double share = area / (inner ? 4 : 3);
  if constexpr (!kGeneral) {
    term.alpha = scale * value.alpha;
    term.beta = scale * value.beta;
    term.gamma = scale * value.gamma;
    term.mass_share = share;
  } else {
    const double alpha = scale * value.alpha, beta = scale * value.beta,
                 gamma = scale * value.gamma;
    term.k12 = alpha;
    term.k1l = term.k2r = -beta;
    term.k2l = term.k1r = beta;
    term.klr = gamma;
    term.mass1 = term.mass2 = term.mass_left = term.mass_right = share;
    if (!inner) {
      // u at the midpoint of the hinge is the mean of its ends.
      const bool left = term.left >= 0;
      double &to_1 = left ? term.k1l : term.k1r, &to_2 = left ? term.k2l : term.k2r;
      to_1 += gamma / 2;
      to_2 += gamma / 2;
      term.k12 -= gamma / 4;
      (left ? term.k1r : term.k1l) = (left ? term.k2r : term.k2l) = term.klr = 0;
      (left ? term.mass_right : term.mass_left) = 0;
      return;
    }
    if (!(value.area > 0)) return;
    const DiamondCrossing<2> crossing = this->crossing(term, points);
    const double jump = (1 - theta_) * scale * crossing.stiffness;
    const double at_1 = jump * crossing.base[0], at_2 = jump * crossing.base[1];
    term.k12 -= at_1 * crossing.base[1];
    term.k1l += at_1 * crossing.left;
    term.k2l += at_2 * crossing.left;
    term.k1r += at_1 * crossing.right;
    term.k2r += at_2 * crossing.right;
    term.klr -= jump * crossing.left * crossing.right;
    if (options_.mass == MassKind::MomentExact) {
      const DiamondMass<2> mass = moment_exact_mass(crossing, *options_.tau);
      term.mass1 = area * mass.base[0];
      term.mass2 = area * mass.base[1];
      term.mass_left = area * mass.left;
      term.mass_right = area * mass.right;
    }
  }
}

template <class Term>
void DiamondAssembly<Term>::make_gradient_pattern() {
  // Its first row (along the hinge) holds the two ends, the others (across; jump) all vertices of
  // the faces.
  const EdgeTopology& edges = mesh_.edges();
  result_.gradient_dimension = n_rows_;
  result_.jump_components = n_rows_ - 2;
  result_.jump_weight = 1 - theta_;
  if (std::int64_t{n_diamonds()} * n_rows_ > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(n_diamonds()) +
                      " diamonds has more rows than 32 bits can number; split the mesh");
  Array<Index> row_sizes(static_cast<std::size_t>(n_rows_) * terms_.size());
  const auto collect = [&](Index d, Array<Index>& columns) {
    columns.clear();
    for (const Index corner : edges.corners.row(edge_of(d))) {
      const std::span<const Index> face = mesh_.face(mesh_.corner_faces()[corner]);
      columns.insert(columns.end(), face.begin(), face.end());
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  };
  parallel_blocks(n_diamonds(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index d = begin; d < end; ++d) {
      collect(d, columns);
      row_sizes[n_rows_ * d] = 2;
      for (Index row = n_rows_ * d + 1; row < n_rows_ * (d + 1); ++row)
        row_sizes[row] = static_cast<Index>(columns.size());
    }
  });
  result_.gradient =
      allocate_rows(n_rows_ * n_diamonds(), mesh_.n_vertices(), row_sizes, "the diamond gradient");
  Index* const inner = result_.gradient.innerIndexPtr();
  const Index* const outer = result_.gradient.outerIndexPtr();
  parallel_blocks(n_diamonds(), options_.threads, [&](int, Index begin, Index end) {
    Array<Index> columns;
    for (Index d = begin; d < end; ++d) {
      inner[outer[n_rows_ * d]] = terms_[d].v1;
      inner[outer[n_rows_ * d] + 1] = terms_[d].v2;
      collect(d, columns);
      for (Index row = n_rows_ * d + 1; row < n_rows_ * (d + 1); ++row)
        std::copy(columns.begin(), columns.end(), inner + outer[row]);
    }
  });
}

template <class Term>
void DiamondAssembly<Term>::assemble_gradient(const Points& points) {
  // G = G^ P, columns of G^ as in (13): along the hinge (u2-u1)/l, across
  // (ul - ur - (u2-u1) shear) / (hl + hr).   [BBA21 (13), (18)]
  // The jump's row times |D| in its square is the jump's energy.
  const Index* const outer = result_.gradient.outerIndexPtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  double* const values = result_.gradient.valuePtr();
  parallel_blocks(n_diamonds(), options_.threads, [&](int, Index begin, Index end) {
    for (Index d = begin; d < end; ++d) {
      const Term& term = terms_[d];
      const Index first_row = n_rows_ * d;
      std::fill(values + outer[first_row], values + outer[first_row + n_rows_], 0.0);
      const Diamond2d value = diamond(term, points);
      if (!(value.area > 0) || is_left_out(d)) continue;
      const double length = (points.row(term.v2) - points.row(term.v1)).norm();
      values[outer[first_row]] = -1 / length;
      values[outer[first_row] + 1] = 1 / length;
      const auto fill_row = [&](Index row, double at_1, double at_2, double at_left,
                                double at_right) {
        const Index* const first = inner + outer[row];
        const Index* const last = inner + outer[row + 1];
        const auto add = [&](Index v, double x) {
          values[std::lower_bound(first, last, v) - inner] += x;
        };
        add(term.v1, at_1);
        add(term.v2, at_2);
        const auto add_side = [&](Index corner, double factor) {
          if (corner < 0) {
            add(term.v1, factor / 2);
            add(term.v2, factor / 2);
            return;
          }
          const Index f = mesh_.corner_faces()[corner];
          for (Index c = mesh_.faces().begin(f); c < mesh_.faces().end(f); ++c)
            add(mesh_.faces().indices[c], factor * virtuals_.weights[c]);
        };
        add_side(term.left, at_left);
        add_side(term.right, at_right);
      };
      const double over_height = length / (2 * value.area);
      fill_row(first_row + 1, value.shear * over_height, -value.shear * over_height, over_height,
               -over_height);
      if (n_rows_ == 2 || term.left < 0 || term.right < 0) continue;
      const DiamondCrossing<2> crossing = this->crossing(term, points);
      const double scale = std::sqrt((1 - theta_) * crossing.stiffness / value.area);
      fill_row(first_row + 2, -scale * crossing.base[0], -scale * crossing.base[1],
               scale * crossing.left, scale * crossing.right);
    }
  });
}

template <class Term>
void DiamondAssembly<Term>::collect_frames(const Points& points) {
  result_.frames = {};
  result_.frames.parts.reserve(2 * terms_.size());
  result_.frames.axes.reserve(2 * terms_.size());
  for (Index d = 0; d < n_diamonds(); ++d) {
    const Term& term = terms_[d];
    if (!(result_.sample_measure[d] > 0)) continue;
    const Vec3 x1 = points.row(term.v1).transpose();
    const Vec3 u = (Vec3(points.row(term.v2).transpose()) - x1).normalized();  // (10)
    const double part = edge_diamonds_.empty() ? 1.0 : share(edge_of(d));
    for (const bool left : {true, false}) {
      const Index corner = left ? term.left : term.right;
      if (corner < 0) continue;
      const Index f = mesh_.corner_faces()[corner];
      const Vec3 to_face = Vec3(face_points_.row(f).transpose()) - x1;
      Vec3 v = to_face - u * u.dot(to_face);  // (11)
      const double height = v.norm();
      if (!(height > 0)) continue;
      v *= (left ? 1 : -1) / height;
      result_.frames.parts.push_back(
          {part * virtuals_.triangles[corner].double_area / 2, d, f, {term.v1, term.v2, -1}});
      result_.frames.axes.emplace_back() << u, v;
    }
  }
}

template <class Term>
void DiamondAssembly<Term>::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  report_virtual_vertices(virtuals_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index d = 0; d < n_diamonds(); ++d)
    if (!(result_.sample_measure[d] > 0) && !is_left_out(d)) excluded.push_back(d);
  report_degenerate(
      std::move(excluded), options_, "diamond",
      [&](Index d) {
        return "edge " + std::to_string(edge_of(d)) + " between vertices " +
               std::to_string(terms_[d].v1) + " and " + std::to_string(terms_[d].v2);
      },
      result_.diagnostics);
}

template <class Term>
void DiamondAssembly<Term>::reassemble(const Points& points) {
  update_virtual_vertices(mesh_, points, options_.virtual_vertex, options_.threads, virtuals_);
  if (options_.coefficient || options_.parts == DiscretizationParts::Frames)
    face_points_ = face_points(mesh_, points, virtuals_.weights);
  order_nonmanifold_faces(points);
  compute_terms(points);
  // S = -L and M = P^T M^ P   [BBA21 (21), (22)]
  if (triangles_) {
    exchange_matrices();
    triangles_->reassemble(points);
    exchange_matrices();
  } else if (structure_) {
    DiamondProducts products =
        diamond_products(structure_, lumped_, incidence_, terms_, edge_diamonds_, virtuals_.weights,
                         options_.threads);
    result_.stiffness_product = std::move(products.stiffness);
    result_.mass_product = std::move(products.mass);
  } else {
    assemble_diamonds(result_.stiffness, result_.mass, lumped_, incidence_, rings_, terms_,
                      edge_diamonds_, virtuals_.weights, options_.threads, workspace_);
  }
  if (options_.parts != DiscretizationParts::Matrices) assemble_gradient(points);
  if (options_.parts == DiscretizationParts::Frames) collect_frames(points);
  report();
}

}  // namespace

std::unique_ptr<Assembly> make_diamond(const char* name, const PolygonMesh& mesh,
                                       const DiscretizationOptions& options) {
  if (options.parts == DiscretizationParts::Matrices && options.form == OperatorForm::Matrices)
    if (std::unique_ptr<Assembly> triangles = make_triangle_diamond(name, mesh, options))
      return triangles;
  if (options.theta.value_or(1.0) < 1 || options.mass == MassKind::MomentExact)
    return std::make_unique<DiamondAssembly<GeneralDiamondTerm>>(name, mesh, options);
  return std::make_unique<DiamondAssembly<DiamondTerm>>(name, mesh, options);
}

extern const SurfaceOperator diamond_surface_operator = {
    "diamond",
    "Diamond Laplacian: gradients on the diamonds of edges",
    "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021",
    {},
    {.masses = {MassKind::Full, MassKind::MomentExact, MassKind::Lumped},
     .virtual_vertex = true,
     .tau = 0.75,
     .products = true,
     .own_interfaces = true},
    {"S = G^T M_d G with one gradient per edge: linear on the diamond of the edge's two ends and "
     "the "
     "virtual vertices of its two faces, the two halves unfolded into one plane; virtual vertices "
     "are "
     "affine combinations of their faces' vertices. Mass P^T M P, a quarter of a diamond to each "
     "of "
     "its four vertices before the prolongation P.",
     "vertices", "all vertices of the two faces of an edge: 13 entries a row on regular triangles",
     "The default: the most accurate of these operators for Poisson's equation on most meshes. "
     "Rows "
     "are longer than with bunge, so factorisations take longer.",
     "Bunge, Botsch, Alexa: The Diamond Laplace for Polygonal and Polyhedral Meshes, 2021, "
     "equations (6) to (23)"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) {
      return make_diamond("diamond", mesh, options);
    }};

}  // namespace carat
