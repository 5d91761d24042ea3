// The linear virtual element method on polygons: Beirao da Veiga et al. 2013.
// S_f = |f| G^T G + (I - Pi)^T Lambda (I - Pi), Pi = 1 1^T / n + Y G the projection to linear
// functions at the vertices Y, which are counted from their mean. Every entry is of few numbers: Pi
// has rank three.

#include <Eigen/Core>
#include <algorithm>

#include "carat/assembly/row_assembly.h"
#include "carat/base/parallel.h"
#include "carat/operators/polygon/polygon_assembly.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

class VemAssembly final : public PolygonAssembly {
 public:
  VemAssembly(const PolygonMesh& mesh, const DiscretizationOptions& options)
      : PolygonAssembly("vem", mesh, options) {}

 private:
  /// Of (1, y): sums over the vertices, with weights Lambda and 1, and the integral over the face.
  struct Moments {
    Eigen::Matrix3d weighted, vertices, area;
  };

  /// Lambda: a length scale to the power of 0, or the consistent part where that is larger.
  double weight(Index f, Index a) const {
    return std::max(1.0, faces_[f].area * corners_of(f)[a].gradient.squaredNorm());
  }
  /// Mean and gradient of the function of a corner.
  Vec3 linear_part(Index f, Index a) const {
    const Vec2& g = corners_of(f)[a].gradient;
    return {1.0 / faces().size(f), g.x(), g.y()};
  }
  /// Entry of Pi.
  double projection(Index f, Index a, Index b) const {
    return 1.0 / faces().size(f) + corners_of(f)[a].y.dot(corners_of(f)[b].gradient);
  }

  void compute_terms() override;
  void assemble_matrices() override;

  Array<Moments> moments_;
};

void VemAssembly::compute_terms() {
  moments_.resize(faces_.size());
  parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      Moments& m = moments_[f];
      m.weighted.setZero();
      m.vertices.setZero();
      m.area.setZero();
      const auto one_and = [&](const Vec2& y) { return Vec3(1, y.x(), y.y()); };
      for (Index a = 0; a < faces().size(f); ++a) {
        const Vec2 &y = corners_of(f)[a].y, &z = corners_of(f)[next(f, a)].y;
        const Vec3 p = one_and(y), q = one_and(z), o(1, 0, 0);
        m.vertices += p * p.transpose();
        m.weighted += weight(f, a) * p * p.transpose();
        // Exact for quadratic functions on the triangle (mean, y, z), with its sign.
        const double signed_area = (y.x() * z.y() - y.y() * z.x()) / 2;
        const Vec3 sum = o + p + q;
        m.area +=
            signed_area / 12 *
            (o * o.transpose() + p * p.transpose() + q * q.transpose() + sum * sum.transpose());
      }
    }
  });
}

void VemAssembly::assemble_matrices() {
  assemble_face_blocks(
      result_.stiffness, incidence_, false, options_.threads, [&](Index f, Index a, Index b) {
        const Face& face = faces_[f];
        if (!(face.area > 0)) return 0.0;
        const Corner* const corner = corners_of(f);
        const double stabilising = (a == b ? weight(f, a) : 0.0) -
                                   weight(f, a) * projection(f, a, b) -
                                   weight(f, b) * projection(f, b, a) +
                                   linear_part(f, a).dot(moments_[f].weighted * linear_part(f, b));
        return face.coefficient *
               (face.area * corner[a].gradient.dot(corner[b].gradient) + stabilising);
      });
  const auto mass = [&](Index f, Index a, Index b) {
    const Face& face = faces_[f];
    if (!(face.area > 0)) return 0.0;
    const Moments& m = moments_[f];
    return linear_part(f, a).dot((m.area + face.area * m.vertices) * linear_part(f, b)) +
           face.area * ((a == b ? 1.0 : 0.0) - projection(f, a, b) - projection(f, b, a));
  };
  assemble_face_blocks(result_.mass, incidence_, options_.mass == MassKind::Lumped,
                       options_.threads, mass);
}

}  // namespace

extern const SurfaceOperator vem_surface_operator = {
    "vem",
    "Linear virtual elements",
    "Beirao da Veiga, Brezzi, Cangiani, Manzini, Marini, Russo: Basic principles of Virtual "
    "Element "
    "Methods, 2013",
    {.divergence_of_gradient = false,
     .total_mass = false,
     .equals_cotan_on_simplices = true,
     .face_local = true},
    {},
    {"S_f = |f| G^T G + (I - Pi)^T Lambda (I - Pi) for every face f: G the gradient of functions "
     "that are linear on the sides, Pi the projection to linear functions, Lambda at least 1. Mass "
     "from the same projection. Faces lie in the plane normal to their vector area.",
     "vertices", "vertices of common faces: 7 entries a row on regular triangles",
     "The reference of the simulation community: planar polygons of any shape, also not "
     "star-shaped. With its full mass heat may change sign far from the source on hexagons and "
     "concave faces: for geodesics take --mass lumped, or --t-coef 2 or more.",
     "Beirao da Veiga et al.: Basic principles of Virtual Element Methods, 2013; The Hitchhiker's "
     "Guide to the Virtual Element Method, 2014"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<VemAssembly>(mesh, options);
    }};

}  // namespace carat
