// Experiments in volumes: Poisson's equation in the cube, eigenvalues of the ball.

#include <cmath>

#include "carat/apps/eigenmodes.h"
#include "carat/base/error.h"
#include "cli/experiments/series.h"

namespace carat::cli {
namespace {

const Families kCubes{"cube-hexahedra", "cube-pyramids", "cube-truncated", "cube-tets",
                      "cube-voronoi"};
const Families kBalls{"ball-hexahedra", "ball-pyramids", "ball-truncated",
                      "ball-voronoi",   "ball-tets",     "ball-tets-adaptive"};

std::vector<Method> cube_methods(const std::string& family) {
  std::vector<Method> methods = compared_methods(family);
  methods.push_back({"diamond", MassKind::MomentExact});
  return methods;
}

/// Those with values at the vertices only.
std::vector<Method> ball_methods(const std::string& family) {
  std::vector<Method> methods = compared_methods(family);
  std::erase_if(methods, [](const Method& method) {
    return !volume_operator(method.name).claims.vertex_unknowns ||
           !volume_operator(method.name).claims.semidefinite;
  });
  methods.push_back({"diamond", MassKind::Lumped});
  return methods;
}

/// The lowest 34 for u = 0 on the unit sphere: squares of the zeros of the spherical Bessel
/// functions, of degree l with multiplicity 2 l + 1.
std::vector<double> ball_eigenvalues() {
  struct Zero {
    double value;
    int multiplicity;
  };
  constexpr Zero kZeros[] = {{3.14159265358979324, 1}, {4.493409457909064, 3},
                             {5.763459196894550, 5},   {6.28318530717958648, 1},
                             {6.987932000500519, 7},   {7.725251836937707, 3},
                             {8.182561452571243, 9},   {9.095011330476355, 5}};
  std::vector<double> values;
  for (const Zero& zero : kZeros)
    for (int k = 0; k < zero.multiplicity; ++k) values.push_back(zero.value * zero.value);
  return values;
}

std::vector<Json> ball_rows(const PolyhedralMesh& mesh, const Discretization& discretization) {
  const std::vector<double> exact = ball_eigenvalues();
  std::vector<Index> fixed;
  const std::vector<bool> boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (boundary[static_cast<std::size_t>(v)]) fixed.push_back(v);
  const Vector values = eigenmodes(discretization, static_cast<Index>(exact.size()), fixed).values;
  double sum = 0;
  for (std::size_t k = 0; k < exact.size(); ++k)
    sum += std::pow(values[static_cast<Eigen::Index>(k)] - exact[k], 2);
  std::vector<Json> rows;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const double value = values[static_cast<Eigen::Index>(k)];
    Json row;
    row["index"] = k + 1;
    row["exact"] = exact[k];
    row["eigenvalue"] = value;
    row["deviation"] = std::abs(value - exact[k]);
    row["rmse"] = std::sqrt(sum / static_cast<double>(exact.size()));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

extern const Experiment franke_cube_experiment = {
    "franke-cube",
    "Poisson's equation in the cube: Franke's function",
    "Figure 11",
    "-laplacian u = f in the unit cube, u Franke's function in space, its values at the boundary; "
    "root mean square error over the inner vertices.",
    columns_with({{"rmse", "error of the solution", "", "number"}}),
    [] {
      return Json::array({line_figure("franke-cube", "Franke's function in the unit cube",
                                      "The diamond's error is a third to six tenths of the others' "
                                      "on most meshes.",
                                      "family", {"operator", "mass"}, "mean_edge", "rmse")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolyhedralMesh>(
          kCubes, extent.levels_from(1, 3, 2), cube_methods, DiscretizationParts::Matrices, extent,
          [](const PolyhedralMesh& mesh, const Discretization& d) {
            return std::vector<Json>{{{"rmse", dirichlet_error(mesh, d, kFranke3d)}}};
          });
    },
    nullptr};

extern const Experiment ball_eigenvalues_experiment = {
    "ball-eigenvalues",
    "Eigenvalues of the unit ball",
    "Figures 12, 13",
    "The 34 lowest eigenvalues of -laplacian with u = 0 on the sphere, against the squares of the "
    "zeros of the spherical Bessel functions; uniform and adaptive tetrahedra among others.",
    columns_with({{"index", "number of the eigenvalue", "", "integer"},
                  {"exact", "exact eigenvalue", "1/length^2", "number"},
                  {"eigenvalue", "eigenvalue", "1/length^2", "number"},
                  {"deviation", "deviation from the exact eigenvalue", "1/length^2", "number"},
                  {"rmse", "error of all 34", "1/length^2", "number"},
                  {"finest", "finest level of the family", "", "integer"}}),
    [] {
      Json values =
          line_figure("ball-eigenvalues", "Eigenvalues of the unit ball", "Finest level measured.",
                      "family", {"operator", "mass"}, "index", "eigenvalue");
      Json deviations =
          line_figure("ball-eigenvalues-deviation", "Their deviations", "Finest level measured.",
                      "family", {"operator", "mass"}, "index", "deviation");
      for (Json* figure : {&values, &deviations}) {
        (*figure)["x_scale"] = "linear";
        (*figure)["slopes"] = false;
        (*figure)["references"] = Json::array();
        (*figure)["filter"] = {{"finest", 1}};
      }
      values["y_scale"] = "linear";
      Json table = {{"id", "ball-eigenvalues-rmse"},
                    {"title", "Root mean square error of all 34"},
                    {"caption", ""},
                    {"kind", "table"},
                    {"columns", {"family", "level", "vertices", "operator", "mass", "rmse"}},
                    {"filter", {{"index", 1}}}};
      return Json::array({values, deviations, table});
    },
    [](const Extent& extent) {
      return convergence_cases<PolyhedralMesh>(kBalls, extent.levels_from(1, 2, 1), ball_methods,
                                               DiscretizationParts::Matrices, extent, ball_rows);
    },
    mark_finest};

}  // namespace carat::cli
