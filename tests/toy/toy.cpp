// The smallest operator there can be: one file, and one line in operators.def. The graph Laplacian
// of the edges with unit weights; a third of every triangle's, a quarter of every quad's area, and
// so on, to its vertices.

#include <Eigen/Geometry>

#include "carat/assembly/row_assembly.h"
#include "carat/operators/registry.h"
#include "carat/operators/surface/incidence.h"

namespace carat {
namespace {

class ToyAssembly final : public Assembly {
 public:
  explicit ToyAssembly(const PolygonMesh& mesh)
      : mesh_(mesh), incidence_(surface_incidence(mesh_)) {
    result_.name = "toy";
    result_.stiffness = face_pattern(incidence_, 1);
    result_.mass = diagonal_pattern(mesh_.n_vertices());
  }

  void reassemble(const Points& points) override {
    assemble_face_blocks(result_.stiffness, incidence_, false, 1, [&](Index f, Index a, Index b) {
      const Index n = mesh_.faces().size(f);
      if (a == b) return 2.0;
      return b == (a + 1) % n || a == (b + 1) % n ? -1.0 : 0.0;
    });
    assemble_face_blocks(result_.mass, incidence_, true, 1, [&](Index f, Index a, Index b) {
      return a == b ? area(points, f) / static_cast<double>(mesh_.faces().size(f)) : 0.0;
    });
  }

 private:
  double area(const Points& points, Index f) const {
    const auto face = mesh_.face(f);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vec3 x = points.row(face[0]), y = points.row(face[i]), z = points.row(face[i + 1]);
      sum += (y - x).cross(z - x);
    }
    return sum.norm() / 2;
  }

  PolygonMesh mesh_;
  SurfaceIncidence incidence_;
};

}  // namespace

extern const SurfaceOperator toy_surface_operator = {
    "toy",
    "Graph Laplacian: unit weights on the edges",
    "a test",
    {.linear_precision = false,
     .gradient = false,
     .divergence_of_gradient = false,
     .total_mass = false,
     .second_order = false,
     .face_local = true},
    {.masses = {MassKind::Lumped}},
    {"S_ij = -1 for every face at the edge ij.", "vertices", "neighbours along edges", "Never.",
     "none"},
    [](const PolygonMesh& mesh, const DiscretizationOptions&) -> std::unique_ptr<Assembly> {
      return std::make_unique<ToyAssembly>(mesh);
    }};

}  // namespace carat
