// The linear virtual element method on polyhedra: Beirao da Veiga et al. 2013.
// S_c = |c| G^T K G + tr(K)/3 (I - Pi)^T Lambda (I - Pi), Pi = 1 1^T / n + Y G the projection to
// linear functions at the vertices Y, which are counted from their mean. G integrates over the
// virtual triangles of the cell's boundary. M_c = C^T H C + |c| (I - Pi)^T (I - Pi), C = [1^T / n;
// G] and H the moments of (1, y). As Pi has rank four, an entry takes two scalar products.

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "carat/assembly/cell_assembly.h"
#include "carat/assembly/pattern.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/operators/volume/incidence.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {
namespace {

using Vec4 = Eigen::Vector4d;

class VolumeVemAssembly final : public Assembly {
 public:
  VolumeVemAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options);
  void reassemble(const Points& points) override;

 private:
  struct Corner {
    Vec3 y;          ///< from the mean of the cell's vertices, in its axes  [length]
    Vec3 g;          ///< of the vertex's function, in these axes            [1/length]
    double weight;   ///< Lambda, times tr(K)/3                              [length]
    Vec3 stiffness;  ///< S_ab = g_a . stiffness_b + stiffness_0_b
                     ///< - weight_a (1/n + y_a . g_b - delta_ab)
    double stiffness_0;
    Vec3 mass;  ///< M_ab = g_a . mass_b + mass_0_b - |c| (y_a . g_b - delta_ab)
    double mass_0;
  };

  const Csr& vertices() const { return mesh_.cell_vertices(); }
  const Corner* corners_of(Index c) const { return corners_.data() + vertices().begin(c); }
  static Vec4 one_and(const Vec3& y) {
    Vec4 p;
    p << 1, y;
    return p;
  }

  void measure_cell(Index c, Array<Index>& place);
  void assemble_matrices();
  void make_gradient_pattern();
  void assemble_gradient();
  void collect_frames();
  void report();

  PolyhedralMesh mesh_;
  DiscretizationOptions options_;
  VolumeIncidence incidence_;
  VirtualVertices virtuals_;
  Points face_points_;
  Array<Corner> corners_;
  Array<Eigen::Matrix3d> axes_;  // of the cells
  Vec3 origin_ = Vec3::Zero();
  Points points_;  // relative to the origin, so that no accuracy is lost far from it
};

VolumeVemAssembly::VolumeVemAssembly(const PolyhedralMesh& mesh,
                                     const DiscretizationOptions& options)
    : mesh_(mesh), options_(options), incidence_(volume_incidence(mesh_)) {
  check_cell_coefficient(options_, mesh_.n_cells());
  result_.name = "vem";
  result_.stiffness = cell_pattern(incidence_, options_.threads);
  result_.mass =
      options_.mass == MassKind::Lumped ? diagonal_pattern(mesh_.n_vertices()) : result_.stiffness;
  result_.sample_measure.resize(mesh_.n_cells());
  if (options_.parts >= DiscretizationParts::Gradient) make_gradient_pattern();
}

/// \param place  one entry a vertex, scratch: its place in the cell
void VolumeVemAssembly::measure_cell(Index c, Array<Index>& place) {
  const std::span<const Index> v = vertices().row(c);
  const Index n = static_cast<Index>(v.size());
  Corner* const corners = corners_.data() + vertices().begin(c);
  const Vec3 first = points_.row(v[0]).transpose();
  Vec3 mean = Vec3::Zero();
  for (const Index w : v) mean += (points_.row(w).transpose() - first) / n;
  mean += first;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  for (Index a = 0; a < n; ++a) {
    place[v[static_cast<std::size_t>(a)]] = a;
    corners[a].y = points_.row(v[static_cast<std::size_t>(a)]).transpose() - mean;
    corners[a].g.setZero();
    spread += corners[a].y * corners[a].y.transpose();
  }
  // Coordinates along the principal axes: products y . g are then rounded like themselves on thin
  // cells too, where y is small and g large across the cell.
  axes.compute(spread);  // orthonormal for nearly equal eigenvalues too, unlike computeDirect
  axes_[c] = axes.eigenvectors();
  if (axes_[c].determinant() < 0) axes_[c].col(0) *= -1;  // areas and volumes keep their signs
  for (Index a = 0; a < n; ++a) corners[a].y = axes_[c].transpose() * corners[a].y;
  double size2 = 0;
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < a; ++b)
      size2 = std::max(size2, (corners[a].y - corners[b].y).squaredNorm());

  Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
  const Vec4 o(1, 0, 0, 0);
  double volume = 0;
  for (const Index f : mesh_.cell(c)) {
    const std::span<const Index> face = mesh_.face(f);
    const double sign = mesh_.face_cells()[f].below == c ? 1 : -1;
    const Vec3 yf = axes_[c].transpose() * (face_points_.row(f).transpose() - mean);
    Vec3 of_face = Vec3::Zero();
    for (std::size_t i = 0; i < face.size(); ++i) {
      Corner &a = corners[place[face[i]]], &b = corners[place[face[(i + 1) % face.size()]]];
      const Vec3 area = sign / 2 * (a.y - yf).cross(b.y - yf);
      a.g += area;
      b.g += area;
      of_face += area;
      const double part = area.dot(yf) / 3;
      volume += part;
      const Vec4 p = one_and(a.y), q = one_and(b.y), r = one_and(yf), sum = o + p + q + r;
      moments += part / 20 *
                 (o * o.transpose() + p * p.transpose() + q * q.transpose() + r * r.transpose() +
                  sum * sum.transpose());
    }
    const Index begin = mesh_.face_mesh().faces().begin(f);
    for (std::size_t i = 0; i < face.size(); ++i)
      corners[place[face[i]]].g += virtuals_.weights[static_cast<std::size_t>(begin) + i] * of_face;
  }
  const double limit = options_.eps_rel * size2;
  const bool sound = volume > 0 && volume * volume > limit * limit * size2;
  result_.sample_measure[c] = sound ? volume : 0.0;
  if (!sound) return;
  Eigen::Matrix3d tensor = axes_[c].transpose() * cell_tensor(options_, c) * axes_[c];
  if (options_.coefficient)
    tensor *=
        coefficient_at(options_, origin_ + mean + axes_[c] * (moments.col(0).tail<3>() / volume));
  Eigen::Matrix4d plain = Eigen::Matrix4d::Zero(), weighted = Eigen::Matrix4d::Zero();
  for (Index a = 0; a < n; ++a) {
    Corner& corner = corners[a];
    corner.g /= 3 * volume;
    corner.weight =
        tensor.trace() / 3 * std::max(std::sqrt(size2), volume * corner.g.squaredNorm());
    const Vec4 p = one_and(corner.y);
    plain += p * p.transpose();
    weighted += corner.weight * p * p.transpose();
  }
  moments += volume * plain;
  for (Index a = 0; a < n; ++a) {
    Corner& corner = corners[a];
    Vec4 part;  // the linear function that stands for the vertex's own
    part << 1.0 / n, corner.g;
    const Vec4 s = weighted * part, m = moments * part;
    corner.stiffness = volume * (tensor * corner.g) + s.tail<3>() - corner.weight * corner.y;
    corner.stiffness_0 = (s[0] - corner.weight) / n;
    corner.mass = m.tail<3>() - volume * corner.y;
    corner.mass_0 = (m[0] - 2 * volume) / n;
  }
}

void VolumeVemAssembly::assemble_matrices() {
  assemble_cell_blocks(
      result_.stiffness, false, incidence_, options_.threads, [&](Index c, Index a, Index b) {
        if (!(result_.sample_measure[c] > 0)) return 0.0;
        const Corner &row = corners_of(c)[a], &column = corners_of(c)[b];
        return row.g.dot(column.stiffness) + column.stiffness_0 -
               row.weight * (1.0 / vertices().size(c) + row.y.dot(column.g) - (a == b ? 1.0 : 0.0));
      });
  assemble_cell_blocks(result_.mass, options_.mass == MassKind::Lumped, incidence_,
                       options_.threads, [&](Index c, Index a, Index b) {
                         const double volume = result_.sample_measure[c];
                         if (!(volume > 0)) return 0.0;
                         const Corner &row = corners_of(c)[a], &column = corners_of(c)[b];
                         return row.g.dot(column.mass) + column.mass_0 -
                                volume * (row.y.dot(column.g) - (a == b ? 1.0 : 0.0));
                       });
}

void VolumeVemAssembly::make_gradient_pattern() {
  if (std::int64_t{mesh_.n_cells()} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(mesh_.n_cells()) +
                      " cells has more rows than 32 bits can number; split the mesh");
  result_.gradient_dimension = 3;
  Array<Index> row_sizes(3 * static_cast<std::size_t>(mesh_.n_cells()));
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    std::fill_n(row_sizes.begin() + 3 * std::ptrdiff_t{c}, 3, vertices().size(c));
  result_.gradient =
      allocate_rows(3 * mesh_.n_cells(), mesh_.n_vertices(), row_sizes, "the gradient on cells");
  for (Index c = 0; c < mesh_.n_cells(); ++c) {
    Index* const columns =
        result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[3 * c];
    const Index n = vertices().size(c);
    std::sort(columns, std::copy(vertices().row(c).begin(), vertices().row(c).end(), columns));
    std::copy(columns, columns + n, columns + n);
    std::copy(columns, columns + n, columns + 2 * n);
  }
}

void VolumeVemAssembly::assemble_gradient() {
  double* const values = result_.gradient.valuePtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  parallel_blocks(mesh_.n_cells(), options_.threads, [&](int, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
      const Index first = result_.gradient.outerIndexPtr()[3 * c], n = vertices().size(c);
      for (Index a = 0; a < n; ++a) {
        const Index* const columns = inner + first;
        const Index v = vertices().indices[vertices().begin(c) + a];
        const std::ptrdiff_t place = std::lower_bound(columns, columns + n, v) - columns;
        const Vec3 g = result_.sample_measure[c] > 0 ? Vec3(axes_[c] * corners_of(c)[a].g)
                                                     : Vec3(Vec3::Zero());
        for (Index k = 0; k < 3; ++k) values[first + n * k + place] = g[k];
      }
    }
  });
}

void VolumeVemAssembly::collect_frames() {
  // Every vertex stands for its share of the cell.
  result_.frames.parts.clear();
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (result_.sample_measure[c] > 0)
      for (const Index v : vertices().row(c))
        result_.frames.parts.push_back(
            {result_.sample_measure[c] / vertices().size(c), c, c, {v, -1, -1}});
}

void VolumeVemAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  report_virtual_vertices(virtuals_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index c = 0; c < mesh_.n_cells(); ++c)
    if (!(result_.sample_measure[c] > 0)) excluded.push_back(c);
  report_degenerate(
      std::move(excluded), options_, "cell",
      [&](Index c) {
        return std::to_string(vertices().size(c)) + " vertices, the first " +
               std::to_string(vertices().row(c)[0]);
      },
      result_.diagnostics);
}

void VolumeVemAssembly::reassemble(const Points& points) {
  centre_points(points, points_, origin_);
  update_virtual_vertices(mesh_.face_mesh(), points_, options_.virtual_vertex, options_.threads,
                          virtuals_);
  face_points_ = face_points(mesh_.face_mesh(), points_, virtuals_.weights);
  corners_.resize(vertices().indices.size());
  axes_.resize(static_cast<std::size_t>(mesh_.n_cells()));
  // The caller's function is not asked to be thread-safe.
  const int threads = options_.coefficient ? 1 : options_.threads;
  parallel_blocks(mesh_.n_cells(), threads, [&](int, Index begin, Index end) {
    Array<Index> place(static_cast<std::size_t>(mesh_.n_vertices()));
    for (Index c = begin; c < end; ++c) measure_cell(c, place);
  });
  assemble_matrices();
  if (options_.parts >= DiscretizationParts::Gradient) assemble_gradient();
  if (options_.parts == DiscretizationParts::Frames) collect_frames();
  report();
}

}  // namespace

extern const VolumeOperator vem_volume_operator = {
    "vem",
    "Linear virtual elements",
    "Beirao da Veiga, Brezzi, Cangiani, Manzini, Marini, Russo: Basic principles of Virtual "
    "Element "
    "Methods, 2013",
    {.divergence_of_gradient = false, .equals_cotan_on_simplices = true, .face_local = true},
    {.virtual_vertex = true},
    {"S_c = |c| G^T G + (I - Pi)^T Lambda (I - Pi) for every cell c: G the gradient by the values "
     "on "
     "the virtual triangles of its boundary, Pi the projection to linear functions, Lambda at "
     "least "
     "the cell's diameter. Mass from the same projection.",
     "vertices", "vertices of common cells",
     "The reference of the simulation community, on polyhedra of any shape. One gradient a cell. "
     "Stiff in functions that are not linear on a cell: second order shows from some 16 cells a "
     "side on. With its full mass heat changes sign: for geodesics take --mass lumped.",
     "Beirao da Veiga et al.: Basic principles of Virtual Element Methods, 2013; The Hitchhiker's "
     "Guide to the Virtual Element Method, 2014"},
    [](const PolyhedralMesh& mesh,
       const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<VolumeVemAssembly>(mesh, options);
    }};

}  // namespace carat
