// CeVeFE-DDFV, discrete duality finite volumes with values at cells, vertices, faces and edges:
// Coudiere, Hubert 2011. One octahedral diamond for every edge of every face, with
//   g = ((u_2 - u_1) q x d + (u_f - u_e) d x p + (u_r - u_l) p x q) / det(p, q, d),
// p = x_2 - x_1, q = x_f - x_e, d = x_r - x_l, |D| = det / 6.

#include <Eigen/Geometry>
#include <algorithm>

#include "carat/operators/ddfv/ddfv_assembly.h"
#include "carat/operators/registry.h"

namespace carat {
namespace {

class CevefeAssembly final : public DdfvAssembly {
 public:
  CevefeAssembly(const PolyhedralMesh& mesh, const DiscretizationOptions& options)
      : DdfvAssembly("cevefe", mesh, options) {
    const bool keep = *options.boundary_unknowns;
    Numbering numbering{{Site::Face, Site::Cell, Site::Edge}, {}, boundary_edges()};
    for (const FaceCells& cells : mesh_.face_cells())
      numbering.face.push_back(keep || !cells.boundary());
    for (std::size_t e = 0; e < numbering.edge.size(); ++e)
      numbering.edge[e] = keep || !numbering.edge[e];
    mesh_.face_mesh().corner_faces();  // built on first use: here, not in the numeric phase
    build(mesh_.face_mesh().n_corners(), numbering);
  }

 private:
  /// Of a diamond: the face and its edge, in the face's own direction.
  struct Place {
    Index f, e, v1, v2;
  };
  Place place(Index corner) const {
    const PolygonMesh& faces = mesh_.face_mesh();
    const Index f = faces.corner_faces()[corner];
    return {f, faces.edges().of_corner[corner], faces.faces().indices[corner],
            faces.faces().indices[faces.next_corner(f, corner)]};
  }
  double part(const Place& at, const Vec3& towards) const {
    const Vec3 p = position(at.v2) - position(at.v1);
    const Vec3 q = face_point(at.f) - (position(at.v1) + position(at.v2)) / 2;
    return p.cross(q).dot(towards) / 6;
  }

  void collect_terms(Index corner, std::vector<Term>& terms) const override {
    const Place at = place(corner);
    if (!has_cells(at.f)) return;
    const FaceCells cells = mesh_.face_cells()[at.f];
    const auto side = [&](Index cell) {
      terms.push_back({cell < 0 ? Site::Face : Site::Cell, cell < 0 ? at.f : cell, Vec3::Zero()});
    };
    side(cells.below);
    side(cells.above);
    terms.push_back({Site::Vertex, at.v1, Vec3::Zero()});
    terms.push_back({Site::Vertex, at.v2, Vec3::Zero()});
    terms.push_back({Site::Face, at.f, Vec3::Zero()});
    terms.push_back({Site::Edge, at.e, Vec3::Zero()});
  }

  Diamond diamond(Index corner, Term* terms) const override {
    const Place at = place(corner);
    const FaceCells cells = mesh_.face_cells()[at.f];
    const Vec3 x1 = position(at.v1), x2 = position(at.v2), xf = face_point(at.f);
    const Vec3 below = cells.below < 0 ? xf : cell_point(cells.below);
    const Vec3 above = cells.above < 0 ? xf : cell_point(cells.above);
    const Vec3 p = x2 - x1, q = xf - (x1 + x2) / 2, d = above - below;
    const double det = p.cross(q).dot(d);
    Diamond result{det / 6,
                   (x1 + x2 + xf + (below + above) / 2) / 4,
                   {p.cross(q).dot(xf - below) / 6, p.cross(q).dot(above - xf) / 6},
                   at.f};
    const double size2 = std::max({p.squaredNorm(), q.squaredNorm(), d.squaredNorm()});
    const double limit = options_.eps_rel * size2;
    if (!(result.volume > 0 && result.volume * result.volume > limit * limit * size2))
      result.volume = 0;
    if (!(result.volume > 0)) return result;
    const Vec3 tips = p.cross(q) / det, ends = q.cross(d) / det, spoke = d.cross(p) / det;
    terms[0].g = -tips;
    terms[1].g = tips;
    terms[2].g = -ends;
    terms[3].g = ends;
    terms[4].g = spoke;
    terms[5].g = -spoke;
    return result;
  }

  /// A sixth of every diamond to its two vertices, face and edge, a third of its part to a cell.
  void add_weights(Vector& weights) const override {
    for (Index corner = 0; corner < mesh_.face_mesh().n_corners(); ++corner) {
      const Place at = place(corner);
      const FaceCells cells = mesh_.face_cells()[at.f];
      const Vec3 xf = face_point(at.f);
      double volume = 0;
      for (const Index cell : {cells.below, cells.above}) {
        if (cell < 0) continue;
        const Vec3 to_face = xf - cell_point(cell);
        const double own = part(at, cell == cells.below ? to_face : Vec3(-to_face));
        add_weight(weights, Site::Cell, cell, own / 3);
        volume += own;
      }
      add_weight(weights, Site::Vertex, at.v1, volume / 6);
      add_weight(weights, Site::Vertex, at.v2, volume / 6);
      add_weight(weights, Site::Face, at.f, volume / 6);
      add_weight(weights, Site::Edge, at.e, volume / 6);
    }
  }

  std::string describe(Index corner) const override {
    const Place at = place(corner);
    return "face " + std::to_string(at.f) + ", vertices " + std::to_string(at.v1) + " and " +
           std::to_string(at.v2);
  }
  std::vector<Index> vertices_of(Index corner) const override {
    const Place at = place(corner);
    return {at.v1, at.v2};
  }
};

}  // namespace

extern const VolumeOperator cevefe_volume_operator = {
    "cevefe",
    "CeVeFE-DDFV: discrete duality finite volumes with values at cells, vertices, faces and edges",
    "Coudiere, Hubert: A 3D discrete duality finite volume method for nonlinear elliptic "
    "equations, "
    "2011",
    {.kernel_is_constants = false,
     .total_mass = false,
     .face_local = true,
     .vertex_unknowns = false},
    {.masses = {MassKind::Lumped}, .boundary_unknowns = true},
    {"S = G^T M_d G with one gradient for every edge of every face, exact on linear functions, "
     "from "
     "the differences along the edge, from the edge's midpoint to the face's point, and between "
     "the "
     "points of the two cells. At the boundary the face's point stands for the missing cell's. "
     "Mass: "
     "a sixth of every diamond to its vertices, face and edge, a third of its parts to the cells.",
     "vertices, faces, cells and edges; those of the boundary can be eliminated",
     "few entries a row, in four times as many rows and more",
     "For comparison, with Dirichlet data on all of the boundary. Without, eliminate the values of "
     "boundary faces and edges: a second function is in the kernel otherwise.",
     "Coudiere, Hubert: A 3D discrete duality finite volume method for nonlinear elliptic "
     "equations, "
     "2011"},
    [](const PolyhedralMesh& mesh, const DiscretizationOptions& options)
        -> std::unique_ptr<Assembly> { return std::make_unique<CevefeAssembly>(mesh, options); }};

}  // namespace carat
