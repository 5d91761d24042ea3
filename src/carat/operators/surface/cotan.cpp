// The cotan Laplacian of triangle meshes: Pinkall, Polthier 1993; Desbrun, Meyer, Schroeder,
// Barr 1999. S_ij = -(cot a + cot b)/2; the mass is lumped by thirds of triangles,
// or mixed Voronoi areas, or that of linear elements.

#include "carat/kernels/cotan.h"

#include "carat/assembly/row_assembly.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/operators/common.h"
#include "carat/operators/registry.h"
#include "carat/operators/surface/incidence.h"

namespace carat {
namespace {

class CotanAssembly final : public Assembly {
 public:
  CotanAssembly(const PolygonMesh& mesh, const DiscretizationOptions& options)
      : mesh_(mesh), options_(options), incidence_(surface_incidence(mesh_)) {
    for (Index f = 0; f < mesh_.n_faces(); ++f)
      if (mesh_.faces().size(f) != 3)
        throw InvalidMesh("face " + std::to_string(f) + " has " +
                              std::to_string(mesh_.faces().size(f)) +
                              " vertices; the cotan operator needs triangles: triangulate the "
                              "mesh, or use the operators diamond or bunge",
                          {f});
    result_.name = "cotan";
    result_.stiffness = face_pattern(incidence_, options_.threads);
    result_.mass =
        options_.mass == MassKind::Full ? result_.stiffness : diagonal_pattern(mesh_.n_vertices());
    result_.sample_measure.resize(mesh_.n_faces());
    if (options_.parts != DiscretizationParts::Matrices) make_gradient_pattern();
  }

  void reassemble(const Points& points) override {
    compute_terms(points);
    assemble_face_blocks(result_.stiffness, incidence_, false, options_.threads,
                         [&](Index f, Index a, Index b) {
                           const double* const cot = cotangents_.data() + 3 * f;
                           if (a == b) return (cot[(a + 1) % 3] + cot[(a + 2) % 3]) / 2;
                           return -cot[3 - a - b] / 2;
                         });
    assemble_mass();
    if (options_.parts != DiscretizationParts::Matrices) assemble_gradient(points);
    if (options_.parts == DiscretizationParts::Frames) collect_frames();
    report();
  }

 private:
  Vec3 corner_point(const Points& points, Index f, Index a) const {
    return points.row(mesh_.face(f)[static_cast<std::size_t>(a)]).transpose();
  }

  void assemble_mass() {
    if (options_.mass == MassKind::Voronoi)
      assemble_face_blocks(
          result_.mass, incidence_, true, options_.threads,
          [&](Index f, Index a, Index b) { return a == b ? voronoi_areas_[3 * f + a] : 0.0; });
    else
      assemble_face_blocks(
          result_.mass, incidence_, options_.mass == MassKind::Lumped, options_.threads,
          [&](Index f, Index a, Index b) { return result_.sample_measure[f] / (a == b ? 6 : 12); });
  }

  /// Where the triangle is not obtuse, the part of it that is nearest to corner a; otherwise half
  /// of it to the obtuse corner and a quarter to the others.
  static double voronoi_area(const double* squared_sides, double double_area, Index a) {
    const auto cosine = [&](Index k) {  // up to the product of two sides
      return squared_sides[(k + 1) % 3] + squared_sides[(k + 2) % 3] - squared_sides[k];
    };
    for (Index k = 0; k < 3; ++k)
      if (cosine(k) < 0) return double_area / (k == a ? 4 : 8);
    const Index b = (a + 1) % 3, c = (a + 2) % 3;
    return (squared_sides[b] * cosine(b) + squared_sides[c] * cosine(c)) / (16 * double_area);
  }

  void compute_terms(const Points& points) {
    cotangents_.resize(3 * static_cast<std::size_t>(mesh_.n_faces()));
    if (options_.mass == MassKind::Voronoi) voronoi_areas_.resize(cotangents_.size());
    Array<double> coefficient;
    if (options_.coefficient) {
      coefficient.resize(static_cast<std::size_t>(mesh_.n_faces()));
      for (Index f = 0; f < mesh_.n_faces(); ++f)
        coefficient[f] = coefficient_at(
            options_,
            (corner_point(points, f, 0) + corner_point(points, f, 1) + corner_point(points, f, 2)) /
                3);
    }
    parallel_blocks(mesh_.n_faces(), options_.threads, [&](int, Index begin, Index end) {
      for (Index f = begin; f < end; ++f) {
        Vec3 side[3];  // opposite to corner a
        for (Index a = 0; a < 3; ++a)
          side[a] = corner_point(points, f, (a + 2) % 3) - corner_point(points, f, (a + 1) % 3);
        const double double_area = side[0].cross(side[1]).norm();
        const double size2 =
            std::max({side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm()});
        const bool sound = double_area > 2 * options_.eps_rel * size2;
        const double k = sound && options_.coefficient ? coefficient[f] : 1.0;
        result_.sample_measure[f] = sound ? double_area / 2 : 0;
        if (options_.mass == MassKind::Voronoi) {
          const double squared[3] = {side[0].squaredNorm(), side[1].squaredNorm(),
                                     side[2].squaredNorm()};
          for (Index a = 0; a < 3; ++a)
            voronoi_areas_[3 * f + a] = sound ? voronoi_area(squared, double_area, a) : 0;
        }
        for (Index a = 0; a < 3; ++a)
          cotangents_[3 * f + a] =
              sound ? -k * side[(a + 1) % 3].dot(side[(a + 2) % 3]) / double_area : 0;
      }
    });
  }

  void make_gradient_pattern() {
    if (std::int64_t{mesh_.n_faces()} * 3 > std::numeric_limits<Index>::max())
      throw InvalidMesh("the gradient of " + std::to_string(mesh_.n_faces()) +
                        " triangles has more rows than 32 bits can number; split the mesh");
    result_.gradient_dimension = 3;
    result_.gradient = allocate_rows(3 * mesh_.n_faces(), mesh_.n_vertices(),
                                     Array<Index>(3 * static_cast<std::size_t>(mesh_.n_faces()), 3),
                                     "the gradient on triangles");
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      std::array<Index, 3> v{mesh_.face(f)[0], mesh_.face(f)[1], mesh_.face(f)[2]};
      std::sort(v.begin(), v.end());
      for (Index k = 0; k < 3; ++k)
        std::copy(v.begin(), v.end(), result_.gradient.innerIndexPtr() + 9 * f + 3 * k);
    }
  }

  void assemble_gradient(const Points& points) {
    double* const values = result_.gradient.valuePtr();
    const Index* const inner = result_.gradient.innerIndexPtr();
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      Eigen::Matrix3d hats = Eigen::Matrix3d::Zero();
      if (result_.sample_measure[f] > 0)
        hats = hat_gradients(corner_point(points, f, 0), corner_point(points, f, 1),
                             corner_point(points, f, 2));
      for (Index a = 0; a < 3; ++a)
        for (Index k = 0; k < 3; ++k) {
          const Index* const row = inner + 9 * f + 3 * k;
          const Index v = mesh_.face(f)[static_cast<std::size_t>(a)];
          values[std::find(row, row + 3, v) - inner] = hats(k, a);
        }
    }
  }

  void collect_frames() {
    result_.frames.parts.clear();
    for (Index f = 0; f < mesh_.n_faces(); ++f)
      if (result_.sample_measure[f] > 0)
        result_.frames.parts.push_back({result_.sample_measure[f],
                                        f,
                                        f,
                                        {mesh_.face(f)[0], mesh_.face(f)[1], mesh_.face(f)[2]}});
  }

  void report() {
    result_.diagnostics = {};
    report_unreferenced(mesh_, result_.diagnostics);
    std::vector<Index> excluded;
    for (Index f = 0; f < mesh_.n_faces(); ++f)
      if (!(result_.sample_measure[f] > 0)) excluded.push_back(f);
    report_degenerate(
        std::move(excluded), options_, "face",
        [&](Index f) {
          return "vertices " + std::to_string(mesh_.face(f)[0]) + ", " +
                 std::to_string(mesh_.face(f)[1]) + " and " + std::to_string(mesh_.face(f)[2]);
        },
        result_.diagnostics);
  }

  PolygonMesh mesh_;
  DiscretizationOptions options_;
  SurfaceIncidence incidence_;
  Array<double> cotangents_;  // of the angle at each corner, times K
  Array<double> voronoi_areas_;
};

}  // namespace

extern const SurfaceOperator cotan_surface_operator = {
    "cotan",
    "Cotan Laplacian: linear elements on triangles",
    "Pinkall, Polthier 1993; Desbrun, Meyer, Schroeder, Barr 1999",
    {.maximum_principle = true,
     .equals_cotan_on_simplices = true,
     .simplices_only = true,
     .face_local = true},
    {.masses = {MassKind::Lumped, MassKind::Voronoi, MassKind::Full}},
    {"S_ij = -(cot a + cot b) / 2, a and b opposite to the edge ij. Mass: thirds of the triangles; "
     "voronoi: mixed Voronoi areas; full: linear elements.",
     "vertices", "7 entries a row on regular triangles",
     "The reference on triangle meshes; polygons have to be triangulated first.",
     "Pinkall, Polthier: Computing Discrete Minimal Surfaces and Their Conjugates, 1993; Meyer, "
     "Desbrun, Schroeder, Barr: Discrete Differential-Geometry Operators for Triangulated "
     "2-Manifolds, 2003 (Voronoi areas)"},
    [](const PolygonMesh& mesh, const DiscretizationOptions& options) -> std::unique_ptr<Assembly> {
      return std::make_unique<CotanAssembly>(mesh, options);
    }};

}  // namespace carat
