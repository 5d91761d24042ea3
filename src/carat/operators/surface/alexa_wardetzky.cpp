// Discrete Laplacians on General Polygonal Meshes: Alexa, Wardetzky 2011.
// S_f = d^T (B B^T / |f| + lambda C C^T) d, B the midpoints of the sides, C an orthonormal basis of
// the differences that no vector in the face's plane has. C C^T is the identity less the projector
// to those that one has: of rank 2, w w^T.

#include <Eigen/Cholesky>
#include <limits>

#include "carat/assembly/row_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/polygon/polygon_assembly.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

class AlexaWardetzkyAssembly final : public PolygonAssembly {
 public:
  AlexaWardetzkyAssembly(const PolygonMesh& mesh, const DiscretizationOptions& options)
      : PolygonAssembly("alexa_wardetzky", mesh, options), lambda_(*options.lambda) {}

 private:
  /// Of the side that begins at a corner.
  struct Side {
    Vec3 midpoint;  ///< from the mean of the vertices, axes and height
    Vec2 w;
  };

  double inner_product(Index f, Index a, Index b) const {
    const Side* const side = sides_.data() + faces().begin(f);
    return side[a].midpoint.dot(side[b].midpoint) / faces_[f].area +
           lambda_ * ((a == b ? 1.0 : 0.0) - side[a].w.dot(side[b].w));
  }

  void compute_terms() override;
  void assemble_matrices() override;
  void make_gradient_pattern() override;
  void assemble_gradient() override;

  double lambda_;
  Array<Side> sides_;
};

void AlexaWardetzkyAssembly::compute_terms() {
  sides_.resize(corners_.size());
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      Side* const side = sides_.data() + faces().begin(f);
      const Corner* const corner = corners_of(f);
      const Index n = faces().size(f);
      Eigen::Matrix2d gram = Eigen::Matrix2d::Zero();
      for (Index a = 0; a < n; ++a) {
        const Corner &first = corner[a], &second = corner[next(f, a)];
        const Vec2 along = second.y - first.y;
        side[a].midpoint << (first.y + second.y) / 2, (first.height + second.height) / 2;
        side[a].w = along;
        gram += along * along.transpose();
      }
      if (!(faces_[f].area > 0)) continue;
      const Eigen::LLT<Eigen::Matrix2d> factor(gram);
      for (Index a = 0; a < n; ++a) factor.matrixL().solveInPlace(side[a].w);
    }
  });
}

void AlexaWardetzkyAssembly::assemble_matrices() {
  assemble_face_blocks(
      result_.stiffness, incidence_, false, options_.threads, [&](Index f, Index a, Index b) {
        if (!(faces_[f].area > 0)) return 0.0;
        const Side* const side = sides_.data() + faces().begin(f);
        const Index before_a = previous(f, a), before_b = previous(f, b);
        const double rank_two = (side[before_a].w - side[a].w).dot(side[before_b].w - side[b].w);
        const Vec3 across_a = side[before_a].midpoint - side[a].midpoint;
        const Vec3 across_b = side[before_b].midpoint - side[b].midpoint;
        return faces_[f].coefficient * (across_a.dot(across_b) / faces_[f].area +
                                        lambda_ * (side_differences(f, a, b) - rank_two));
      });
  assemble_face_blocks(
      result_.mass, incidence_, true, options_.threads,
      [&](Index f, Index a, Index b) { return a == b ? faces_[f].area / faces().size(f) : 0.0; });
}

void AlexaWardetzkyAssembly::make_gradient_pattern() {
  result_.gradient_dimension = 1;
  const Index n_sides = mesh_.n_corners();
  result_.gradient =
      allocate_rows(n_sides, mesh_.n_vertices(), Array<Index>(static_cast<std::size_t>(n_sides), 2),
                    "the differences along sides");
  OneForms& forms = result_.one_forms;
  forms.first.assign(faces().offsets.begin(), faces().offsets.end());
  Array<Index> row_sizes(static_cast<std::size_t>(n_sides));
  Array<Index> sharp_sizes(3 * static_cast<std::size_t>(mesh_.n_faces()));
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    const Index n = faces().size(f);
    std::fill_n(row_sizes.begin() + faces().begin(f), n, n);
    std::fill_n(sharp_sizes.begin() + 3 * std::ptrdiff_t{f}, 3, n);
  }
  forms.inner_product =
      allocate_rows(n_sides, n_sides, row_sizes, "the inner product of differences");
  forms.flat =
      allocate_rows(n_sides, 3 * mesh_.n_faces(),
                    Array<Index>(static_cast<std::size_t>(n_sides), 3), "differences of vectors");
  forms.sharp = allocate_rows(3 * mesh_.n_faces(), n_sides, sharp_sizes, "vectors of differences");
  for (Index f = 0; f < mesh_.n_faces(); ++f) {
    const auto fill = [&](SparseMatrix& matrix, Index row) {
      Index* columns = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row];
      for (Index c = faces().begin(f); c < faces().end(f); ++c) *columns++ = c;
    };
    for (Index k = 0; k < 3; ++k) fill(forms.sharp, 3 * f + k);
    for (Index c = faces().begin(f); c < faces().end(f); ++c) {
      fill(forms.inner_product, c);
      for (Index k = 0; k < 3; ++k)
        forms.flat.innerIndexPtr()[forms.flat.outerIndexPtr()[c] + k] = 3 * f + k;
      const Index v1 = faces().indices[c], v2 = faces().indices[mesh_.next_corner(f, c)];
      Index* const columns = result_.gradient.innerIndexPtr() + result_.gradient.outerIndexPtr()[c];
      columns[0] = std::min(v1, v2);
      columns[1] = std::max(v1, v2);
    }
  }
}

void AlexaWardetzkyAssembly::assemble_gradient() {
  OneForms& forms = result_.one_forms;
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index first, Index last) {
    for (Index f = first; f < last; ++f) {
      const Face& face = faces_[f];
      const Corner* const corner = corners_of(f);
      const Index begin = faces().begin(f), n = faces().size(f);
      for (Index a = 0; a < n; ++a) {
        const Index c = begin + a;
        const Index v1 = faces().indices[c], v2 = faces().indices[mesh_.next_corner(f, c)];
        double* const difference =
            result_.gradient.valuePtr() + result_.gradient.outerIndexPtr()[c];
        difference[0] = v1 < v2 ? -1 : 1;
        difference[1] = -difference[0];
        double* const row = forms.inner_product.valuePtr() + forms.inner_product.outerIndexPtr()[c];
        for (Index b = 0; b < n; ++b) row[b] = face.area > 0 ? inner_product(f, a, b) : 0.0;
        // n x midpoint / |f|
        const Vec3 m = sides_[c].midpoint;
        const Vec3 vector =
            face.area > 0 ? Vec3(face.axes * Vec2(-m.y(), m.x()) / face.area) : Vec3(Vec3::Zero());
        const Vec3 along = face.axes * (corner[next(f, a)].y - corner[a].y);
        for (Index k = 0; k < 3; ++k) {
          forms.flat.valuePtr()[forms.flat.outerIndexPtr()[c] + k] = along[k];
          forms.sharp.valuePtr()[forms.sharp.outerIndexPtr()[3 * f + k] + a] = vector[k];
        }
      }
    }
  });
}

}  // namespace

extern const SurfaceOperator alexa_wardetzky_surface_operator = {
    "alexa_wardetzky",
    "Polygonal Laplacian of differences along sides, stabilised by lambda",
    "Alexa, Wardetzky: Discrete Laplacians on General Polygonal Meshes, 2011",
    {.total_mass = false, .equals_cotan_on_simplices = true, .face_local = true},
    {.masses = {MassKind::Lumped}, .lambda = 2.0},
    {"S_f = d^T (B B^T / |f| + lambda C C^T) d for every face f: d differences along its sides, B "
     "their midpoints, |f| the length of the vector area, C an orthonormal basis of the "
     "differences "
     "that no vector in the face's plane has. Mass |f| / n to each of n vertices.",
     "vertices", "vertices of common faces: 7 entries a row on regular triangles",
     "For comparison, and where differences along edges are wanted as gradients. On faces that"
     " are not planar the maximal projection counts, so the mass sums to less than the area of"
     " the virtual triangles. Being stiff, it lets heat change sign far from the source unless"
     " faces are triangles: for geodesics take --lambda 1 or less, or --t-coef 4 or more.",
     "Alexa, Wardetzky: Discrete Laplacians on General Polygonal Meshes, 2011"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<AlexaWardetzkyAssembly>(mesh, options);
    }};

}  // namespace carat
