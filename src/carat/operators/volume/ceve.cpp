// CeVe-DDFV, discrete duality finite volumes with values at cells and vertices: Hermeline 2009.
// One diamond a face, between the two cells' points, with
//   g = ((u_r - u_l) A + 1/2 sum of u_i (x_{i+1} - x_{i-1}) x d) / (3 |D|),  |D| = A . d / 3,
// A the face's vector area from l to r, d = x_r - x_l.

#include <Eigen/Geometry>
#include <algorithm>

#include "carat/operators/ddfv/ddfv_assembly.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

class CeveAssembly final : public DdfvAssembly {
 public:
  CeveAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options)
      : DdfvAssembly("ceve", mesh, options) {
    Numbering numbering{{Site::Cell}, {}, {}};
    if (*options.boundary_unknowns) {
      numbering.order.push_back(Site::Face);
      for (const FaceCells& cells : mesh_.face_cells()) numbering.face.push_back(cells.boundary());
    }
    build(mesh_.n_faces(), numbering);
  }

 private:
  void collect_terms(Index f, std::vector<Term>& terms) const override {
    if (!has_cells(f)) return;
    const FaceCells cells = mesh_.face_cells()[f];
    const auto side = [&](Index cell) {
      terms.push_back({cell < 0 ? Site::Face : Site::Cell, cell < 0 ? f : cell, Vec3::Zero()});
    };
    side(cells.below);
    side(cells.above);
    for (const Index v : mesh_.face(f)) terms.push_back({Site::Vertex, v, Vec3::Zero()});
  }

  Diamond diamond(Index f, Term* terms) const override {
    const FaceCells cells = mesh_.face_cells()[f];
    const std::span<const Index> face = mesh_.face(f);
    const std::size_t n = face.size();
    const Vec3 xf = face_point(f);
    const Vec3 below = cells.below < 0 ? xf : cell_point(cells.below);
    const Vec3 above = cells.above < 0 ? xf : cell_point(cells.above);
    const Vec3 d = above - below;
    Vec3 area = Vec3::Zero();
    double size2 = d.squaredNorm();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 x = position(face[i]) - xf, y = position(face[(i + 1) % n]) - xf;
      area += x.cross(y) / 2;
      size2 = std::max({size2, x.squaredNorm(), (y - x).squaredNorm()});
    }
    Diamond result{area.dot(d) / 3,
                   (3 * xf + (below + above) / 2) / 4,
                   {area.dot(xf - below) / 3, area.dot(above - xf) / 3},
                   f};
    const double limit = options_.eps_rel * size2;
    if (!(result.volume > 0 && result.volume * result.volume > limit * limit * size2))
      result.volume = 0;
    if (!(result.volume > 0)) return result;
    const double scale = 1 / (3 * result.volume);
    terms[0].g = -scale * area;
    terms[1].g = scale * area;
    for (std::size_t i = 0; i < n; ++i)
      terms[2 + i].g =
          scale / 2 * (position(face[(i + 1) % n]) - position(face[(i + n - 1) % n])).cross(d);
    return result;
  }

  /// A third of every tetrahedron (x_c, x_i, x_{i+1}, x_f) to its cell and its two vertices.
  void add_weights(Vector& weights) const override {
    for (Index c = 0; c < mesh_.n_cells(); ++c)
      for (const Index f : mesh_.cell(c)) {
        const std::span<const Index> face = mesh_.face(f);
        const Vec3 xf = face_point(f), to_cell = cell_point(c) - xf;
        const double sign = mesh_.face_cells()[f].below == c ? -1 : 1;
        for (std::size_t i = 0; i < face.size(); ++i) {
          const Index v1 = face[i], v2 = face[(i + 1) % face.size()];
          const double third =
              sign * (position(v1) - xf).cross(position(v2) - xf).dot(to_cell) / 18;
          add_weight(weights, Site::Cell, c, third);
          add_weight(weights, Site::Vertex, v1, third);
          add_weight(weights, Site::Vertex, v2, third);
        }
      }
  }

  std::string describe(Index f) const override {
    return "face " + std::to_string(f) + " between its cells";
  }
  std::vector<Index> vertices_of(Index f) const override {
    return {mesh_.face(f).begin(), mesh_.face(f).end()};
  }
};

}  // namespace

extern const VolumeOperator ceve_volume_operator = {
    "ceve",
    "CeVe-DDFV: discrete duality finite volumes with values at cells and vertices",
    "Hermeline: A finite volume method for approximating 3D diffusion operators on general meshes, "
    "2009",
    {.kernel_is_constants = false,
     .total_mass = false,
     .face_local = true,
     .vertex_unknowns = false},
    {.masses = {MassKind::Lumped}, .boundary_unknowns = false},
    {"S = G^T M_d G with one gradient for every face, exact on linear functions, from the values "
     "at "
     "its vertices and the points of its two cells, the means of their vertices. Values of "
     "boundary "
     "faces are the means of their vertices, or unknowns. Mass: a third of every tetrahedron of an "
     "edge, its face's and its cell's point to the cell and to both vertices.",
     "vertices and cells; on request boundary faces",
     "vertices of common cells, the cells around, and cells with a common face",
     "For comparison, with Dirichlet data on all of the boundary: where all faces have even "
     "numbers "
     "of vertices a checkerboard is in the kernel.",
     "Hermeline: A finite volume method for approximating 3D diffusion operators on general "
     "meshes, "
     "2009; Andreianov, Bendahmane, Hubert, Krell: On 3D DDFV discretization of gradient and "
     "divergence operators, 2012"},
    [](const PolyhedralMesh& mesh, const DiscretizationOptions& options)
        -> std::unique_ptr<Assembly> { return std::make_unique<CeveAssembly>(mesh, options); }};

}  // namespace carat
