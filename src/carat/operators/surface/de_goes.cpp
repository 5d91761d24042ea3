// Discrete Differential Operators on Polygonal Meshes: de Goes, Butts, Desbrun 2020.
// S_f = d^T (|f| U^T U + lambda P^T P) d, U (sharp) the vector of differences along the sides,
// V (flat) the differences of a vector, P = I - V U what U does not see. U d is the gradient.

#include <Eigen/Core>

#include "carat/assembly/row_assembly.h"
#include "carat/base/parallel.h"
#include "carat/operators/polygon/polygon_assembly.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

class DeGoesAssembly final : public PolygonAssembly {
 public:
  DeGoesAssembly(const PolygonMesh& mesh, const DiscretizationOptions& options)
      : PolygonAssembly("de_goes", mesh, options), lambda_(*options.lambda) {}

 private:
  void compute_terms() override;
  void assemble_matrices() override;

  double lambda_;
  Array<Eigen::Matrix2d> flat_gram_;  // V^T V of every face
};

void DeGoesAssembly::compute_terms() {
  flat_gram_.resize(faces_.size());
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      flat_gram_[f].setZero();
      for (Index a = 0; a < faces().size(f); ++a) {
        const Vec2 along = corners_of(f)[next(f, a)].y - corners_of(f)[a].y;
        flat_gram_[f] += along * along.transpose();
      }
    }
  });
}

void DeGoesAssembly::assemble_matrices() {
  assemble_face_blocks(
      result_.stiffness, incidence_, false, options_.threads, [&](Index f, Index a, Index b) {
        const Face& face = faces_[f];
        if (!(face.area > 0)) return 0.0;
        const Corner* const corner = corners_of(f);
        const Vec2 &g_a = corner[a].gradient, &g_b = corner[b].gradient;
        // d^T V, a second difference of positions.
        const auto bend = [&](Index i) -> Vec2 {
          return 2 * corner[i].y - corner[previous(f, i)].y - corner[next(f, i)].y;
        };
        const double stabilising = side_differences(f, a, b) - bend(a).dot(g_b) - g_a.dot(bend(b)) +
                                   g_a.dot(flat_gram_[f] * g_b);
        return face.coefficient * (face.area * g_a.dot(g_b) + lambda_ * stabilising);
      });
  assemble_face_blocks(
      result_.mass, incidence_, true, options_.threads,
      [&](Index f, Index a, Index b) { return a == b ? faces_[f].area / faces().size(f) : 0.0; });
}

}  // namespace

extern const SurfaceOperator de_goes_surface_operator = {
    "de_goes",
    "Polygonal Laplacian of a gradient a face, stabilised by lambda",
    "de Goes, Butts, Desbrun: Discrete Differential Operators on Polygonal Meshes, 2020",
    {.divergence_of_gradient = false,
     .total_mass = false,
     .equals_cotan_on_simplices = true,
     .face_local = true},
    {.masses = {MassKind::Lumped}, .lambda = 1.0},
    {"S_f = |f| G^T G + lambda d^T P^T P d for every face f: G its gradient in the plane normal to "
     "the vector area, |f| the length of that, d differences along the sides, P d what is left of "
     "them beside those of the gradient. Mass |f| / n to each of n vertices.",
     "vertices", "vertices of common faces: 7 entries a row on regular triangles",
     "Where one vector a face is wanted, and sparse matrices: accurate on planar quads and "
     "hexagons. "
     "On faces that are not planar the mass sums to less than the area of the virtual triangles.",
     "de Goes, Butts, Desbrun: Discrete Differential Operators on Polygonal Meshes, 2020"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<DeGoesAssembly>(mesh, options);
    }};

}  // namespace carat
