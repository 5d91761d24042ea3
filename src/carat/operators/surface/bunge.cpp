// Polygon Laplacian Made Simple: Bunge, Herholz, Kazhdan, Botsch 2020.
// Linear elements on the fan of virtual triangles, with the virtual vertices prolonged from the
// face's own: S = P^T S_tri P, M = P^T M_tri P.

#include <cmath>

#include "carat/assembly/row_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/kernels/cotan.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/operators/surface/incidence.h"
#include "carat/prolongation/virtual_vertices.h"

namespace carat {
namespace {

/// Stiffness and mass of one corner's virtual triangle, and of the spoke to its vertex. With
/// k = spoke, q = side: S_f = diag(q_a + q_{a-1} + k_a) - sides - k p^T - p k^T + (sum k) p p^T.
struct CornerTerm {
  double side;   ///< cotan weight of the side's two ends
  double spoke;  ///< cotan weight between the corner's vertex and the virtual vertex
  double area;   ///< of the virtual triangle  [length^2]
};

class BungeAssembly final : public Assembly {
 public:
  BungeAssembly(const PolygonMesh& mesh, const DiscretizationOptions& options)
      : mesh_(mesh), options_(options), incidence_(surface_incidence(mesh_)) {
    result_.name = "bunge";
    result_.stiffness = face_pattern(incidence_, options_.threads);
    result_.mass = lumped_ ? diagonal_pattern(mesh_.n_vertices()) : result_.stiffness;
    result_.sample_measure.resize(mesh_.n_corners());
    if (options_.parts != DiscretizationParts::Matrices) make_gradient_pattern();
  }

  void reassemble(const Points& points) override {
    update_virtual_vertices(mesh_, points, options_.virtual_vertex, options_.threads, virtuals_);
    face_points_ = face_points(mesh_, points, virtuals_.weights);
    compute_terms(points);
    assemble_matrices();
    if (options_.parts != DiscretizationParts::Matrices) assemble_gradient(points);
    if (options_.parts == DiscretizationParts::Frames) collect_frames();
    report();
  }

 private:
  struct FaceTerm {
    double spokes, area;
  };

  Index previous_in_face(Index f, Index a) const {
    return a == 0 ? mesh_.faces().size(f) - 1 : a - 1;
  }
  Index next_in_face(Index f, Index a) const { return a + 1 == mesh_.faces().size(f) ? 0 : a + 1; }

  void compute_terms(const Points& points);
  void assemble_matrices();
  void make_gradient_pattern();
  void assemble_gradient(const Points& points);
  void collect_frames();
  void report();

  PolygonMesh mesh_;
  DiscretizationOptions options_;
  bool lumped_ = options_.mass == MassKind::Lumped;
  SurfaceIncidence incidence_;
  VirtualVertices virtuals_;
  Points face_points_;
  Array<CornerTerm> corners_;
  Array<FaceTerm> faces_;
};

void BungeAssembly::compute_terms(const Points& points) {
  const Csr& faces = mesh_.faces();
  corners_.resize(static_cast<std::size_t>(mesh_.n_corners()));
  faces_.resize(static_cast<std::size_t>(mesh_.n_faces()));
  Array<double> coefficient;
  if (options_.coefficient) {
    coefficient.resize(corners_.size());
    for (Index f = 0; f < mesh_.n_faces(); ++f)
      for (Index c = faces.begin(f); c < faces.end(f); ++c)
        coefficient[c] = coefficient_at(
            options_, ((points.row(faces.indices[c]) +
                        points.row(faces.indices[mesh_.next_corner(f, c)]) + face_points_.row(f)) /
                       3)
                          .transpose());
  }
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      for (Index c = faces.begin(f); c < faces.end(f); ++c) corners_[c] = {0, 0, 0};
      for (Index c = faces.begin(f); c < faces.end(f); ++c) {
        const Index next = mesh_.next_corner(f, c);
        const VirtualTriangle t = virtuals_.triangles[c];
        const double length2 =
            (points.row(faces.indices[next]) - points.row(faces.indices[c])).squaredNorm();
        const double size2 =
            std::max(length2, t.foot * t.foot * length2 + t.double_area * t.double_area / length2);
        result_.sample_measure[c] = 0;
        if (!(t.double_area > 2 * options_.eps_rel * size2)) continue;
        const double k = options_.coefficient ? coefficient[c] : 1.0;
        const TriangleCotangents cot = triangle_cotangents(length2, t);
        corners_[c].side = k * cot.at_tip / 2;
        corners_[c].spoke += k * cot.at_second / 2;
        corners_[next].spoke += k * cot.at_first / 2;
        corners_[c].area = t.double_area / 2;
        result_.sample_measure[c] = t.double_area / 2;
      }
      faces_[f] = {0, 0};
      for (Index c = faces.begin(f); c < faces.end(f); ++c) {
        faces_[f].spokes += corners_[c].spoke;
        faces_[f].area += corners_[c].area;
      }
    }
  });
}

void BungeAssembly::assemble_matrices() {
  const Csr& faces = mesh_.faces();
  assemble_face_blocks(
      result_.stiffness, incidence_, false, options_.threads, [&](Index f, Index a, Index b) {
        const CornerTerm* const term = corners_.data() + faces.begin(f);
        const double* const p = virtuals_.weights.data() + faces.begin(f);
        double value = faces_[f].spokes * p[a] * p[b] - term[a].spoke * p[b] - term[b].spoke * p[a];
        if (a == b) value += term[a].side + term[previous_in_face(f, a)].side + term[a].spoke;
        if (b == next_in_face(f, a)) value -= term[a].side;
        if (a == next_in_face(f, b)) value -= term[b].side;
        return value;
      });
  assemble_face_blocks(
      result_.mass, incidence_, lumped_, options_.threads, [&](Index f, Index a, Index b) {
        const CornerTerm* const term = corners_.data() + faces.begin(f);
        const double* const p = virtuals_.weights.data() + faces.begin(f);
        const auto around = [&](Index i) {
          return term[i].area + term[previous_in_face(f, i)].area;
        };
        double value =
            faces_[f].area / 6 * p[a] * p[b] + around(a) / 12 * p[b] + around(b) / 12 * p[a];
        if (a == b) value += around(a) / 6;
        if (b == next_in_face(f, a)) value += term[a].area / 12;
        if (a == next_in_face(f, b)) value += term[b].area / 12;
        return value;
      });
}

void BungeAssembly::make_gradient_pattern() {
  if (std::int64_t{mesh_.n_corners()} * 3 > std::numeric_limits<Index>::max())
    throw InvalidMesh("the gradient of " + std::to_string(mesh_.n_corners()) +
                      " virtual triangles has more rows than 32 bits can number; split the mesh");
  result_.gradient_dimension = 3;
  Array<Index> row_sizes(3 * static_cast<std::size_t>(mesh_.n_corners()));
  std::vector<Index> columns;
  const auto collect = [&](Index f) {
    columns.assign(mesh_.face(f).begin(), mesh_.face(f).end());
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  };
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    collect(f);
    for (Index row = 3 * mesh_.faces().begin(f); row < 3 * mesh_.faces().end(f); ++row)
      row_sizes[row] = static_cast<Index>(columns.size());
  }
  result_.gradient = allocate_rows(3 * mesh_.n_corners(), mesh_.n_vertices(), row_sizes,
                                   "the gradient on virtual triangles");
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    collect(f);
    for (Index row = 3 * mesh_.faces().begin(f); row < 3 * mesh_.faces().end(f); ++row)
      std::copy(columns.begin(), columns.end(),
                result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[row]);
  }
}

void BungeAssembly::assemble_gradient(const Points& points) {
  const Csr& faces = mesh_.faces();
  const Index* const outer = result_.gradient.outerIndexPtr();
  const Index* const inner = result_.gradient.innerIndexPtr();
  double* const values = result_.gradient.valuePtr();
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      for (Index c = faces.begin(f); c < faces.end(f); ++c) {
        std::fill(values + outer[3 * c], values + outer[3 * c + 3], 0.0);
        if (!(result_.sample_measure[c] > 0)) continue;
        const Index v1 = faces.indices[c], v2 = faces.indices[mesh_.next_corner(f, c)];
        const Eigen::Matrix3d hats =
            hat_gradients(points.row(v1).transpose(), points.row(v2).transpose(),
                          face_points_.row(f).transpose());
        const auto add = [&](Index v, const Vec3& g) {
          for (Index k = 0; k < 3; ++k) {
            const Index *first = inner + outer[3 * c + k], *last = inner + outer[3 * c + k + 1];
            values[std::lower_bound(first, last, v) - inner] += g[k];
          }
        };
        add(v1, hats.col(0));
        add(v2, hats.col(1));
        for (Index a = faces.begin(f); a < faces.end(f); ++a)
          add(faces.indices[a], virtuals_.weights[a] * hats.col(2));
      }
    }
  });
}

void BungeAssembly::collect_frames() {
  result_.frames.parts.clear();
  for (Index f = 0; f < mesh_.n_faces(); ++f)
    for (Index c = mesh_.faces().begin(f); c < mesh_.faces().end(f); ++c)
      if (result_.sample_measure[c] > 0)
        result_.frames.parts.push_back(
            {result_.sample_measure[c],
             c,
             f,
             {mesh_.faces().indices[c], mesh_.faces().indices[mesh_.next_corner(f, c)], -1}});
}

void BungeAssembly::report() {
  result_.diagnostics = {};
  report_unreferenced(mesh_, result_.diagnostics);
  report_virtual_vertices(virtuals_, result_.diagnostics);
  std::vector<Index> excluded;
  for (Index c = 0; c < mesh_.n_corners(); ++c)
    if (!(result_.sample_measure[c] > 0)) excluded.push_back(c);
  report_degenerate(
      std::move(excluded), options_, "virtual triangle",
      [&](Index c) {
        const Index f = mesh_.corner_faces()[c];
        return "face " + std::to_string(f) + ", vertices " +
               std::to_string(mesh_.faces().indices[c]) + " and " +
               std::to_string(mesh_.faces().indices[mesh_.next_corner(f, c)]);
      },
      result_.diagnostics);
}

}  // namespace

extern const SurfaceOperator bunge_surface_operator = {
    "bunge",
    "Polygon Laplacian: linear elements on virtual triangles",
    "Bunge, Herholz, Kazhdan, Botsch: Polygon Laplacian Made Simple, 2020",
    {.equals_cotan_on_simplices = true, .face_local = true},
    {.virtual_vertex = true},
    {"S = P^T S_tri P, M = P^T M_tri P: linear elements on the fan of triangles about every face's "
     "virtual vertex, which P expresses by the face's own.",
     "vertices", "vertices of common faces: 7 entries a row on regular triangles",
     "Where sparsity counts more than accuracy, and where results must agree with cotan on "
     "triangles.",
     "Bunge, Herholz, Kazhdan, Botsch: Polygon Laplacian Made Simple, 2020"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<BungeAssembly>(mesh, options);
    }};

}  // namespace carat
