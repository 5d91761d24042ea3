// Experiments on surfaces: convergence of the problems of the paper's section 8.1 and 8.2, and what
// the time step and the virtual vertices do.

#include <Eigen/Geometry>
#include <cmath>

#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "cli/experiments/series.h"

namespace carat::cli {
namespace {

const Families kPlanes{"plane-triangles", "plane-quads", "plane-voronoi", "plane-concave"};
const Families kSpheres{"sphere-triangles", "sphere-quads", "sphere-hexagons", "sphere-concave"};

std::vector<Method> with_lumped_masses(const std::string& family) {
  std::vector<Method> methods = compared_methods(family);
  for (const char* const name : {"diamond", "stabilized_diamond"})
    methods.push_back({name, MassKind::Lumped});
  return methods;
}

std::vector<Method> with_moment_exact_masses(const std::string& family) {
  std::vector<Method> methods = compared_methods(family);
  for (const char* const name : {"diamond", "stabilized_diamond"})
    methods.push_back({name, MassKind::MomentExact});
  return methods;
}

/// Root mean square error over great-circle distances between the positions.
double great_circle_error(const PolygonMesh& mesh, const Vector& distance, Index source) {
  Vector error(mesh.n_vertices());
  const Vec3 a = mesh.point(source);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    error[v] = distance[v] - std::atan2(a.cross(mesh.point(v)).norm(), a.dot(mesh.point(v)));
  return root_mean_square(error);
}

/// Of six vertices spread over the mesh.
Json mean_distance_error(const PolygonMesh& mesh, Discretization discretization,
                         HeatGeodesicsOptions options) {
  constexpr Index kSources = 6;
  options.solver = {.right_hand_sides = kSources, .threads = discretization.options.threads};
  std::vector<std::vector<GeodesicSource>> sources;
  for (std::int64_t k = 0; k < kSources; ++k)
    sources.push_back({{static_cast<Index>(k * mesh.n_vertices() / kSources)}});
  double sum = 0;
  HeatGeodesics(mesh, std::move(discretization), options)
      .distances(sources, [&](Index k, GeodesicDistance&& distance) {
        const Index source = sources[static_cast<std::size_t>(k)].front().vertex;
        sum += std::pow(great_circle_error(mesh, distance.values, source), 2);
        return true;
      });
  return std::sqrt(sum / kSources);
}

std::vector<Method> eigenvalue_methods(const std::string& family) {
  std::vector<Method> methods = with_moment_exact_masses(family);
  methods.push_back({"bunge", MassKind::Lumped});
  return methods;
}

/// The lowest of the unit sphere, l (l + 1) with multiplicity 2 l + 1, to l = 5.
std::vector<Json> eigenvalue_rows(const PolygonMesh&, const Discretization& discretization) {
  std::vector<double> exact;
  for (int l = 0; l <= 5; ++l)
    exact.insert(exact.end(), 2 * static_cast<std::size_t>(l) + 1, l * (l + 1));
  Vector error = eigenmodes(discretization, static_cast<Index>(exact.size()))
                     .values.head(static_cast<Eigen::Index>(exact.size()));
  error -= Eigen::Map<const Vector>(exact.data(), error.size());
  return {{{"rmse", root_mean_square(error)}}};
}

}  // namespace

extern const Experiment curvature_sphere_experiment = {
    "curvature-sphere",
    "Mean curvature of the unit sphere",
    "Figure 5",
    "Root mean square of H - 1 over the vertices of meshes of the unit sphere, H = |M^-1 L x| / 2 "
    "with its sign.",
    columns_with({{"rmse", "error of the mean curvature", "1/length", "number"}}),
    [] {
      return Json::array({line_figure(
          "curvature-sphere", "Mean curvature of the unit sphere",
          "Pointwise curvature converges on regular neighbourhoods only; on concave faces for no "
          "method. Lumped masses damp what full ones amplify.",
          "family", {"operator", "mass"}, "mean_edge", "rmse")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolygonMesh>(
          kSpheres, extent.levels_from(1, 4, 3), with_lumped_masses, DiscretizationParts::Matrices,
          extent, [](const PolygonMesh& mesh, const Discretization& d) {
            return std::vector<Json>{{{"rmse", sphere_curvature_error(mesh, d)}}};
          });
    },
    nullptr};

extern const Experiment geodesics_sphere_experiment = {
    "geodesics-sphere",
    "Geodesic distance on the unit sphere",
    "Figure 7",
    "The heat method with t = h^2, h the longest edge, from six vertices; root mean square "
    "deviation from great-circle distances between the positions.",
    columns_with({{"rmse", "error of the distance", "length", "number"}}),
    [] {
      return Json::array({line_figure("geodesics-sphere", "Geodesic distance on the unit sphere",
                                      "The smoothing of a time t = h^2 makes first order the most "
                                      "that can be had.",
                                      "family", {"operator", "mass"}, "mean_edge", "rmse")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolygonMesh>(
          kSpheres, extent.levels_from(1, 4, 3),
          [](const std::string& family) {
            std::vector<Method> methods = compared_methods(family);
            // Full masses of virtual elements let heat become negative.
            for (Method& method : methods)
              if (method.name == "vem") method.mass = MassKind::Lumped;
            return methods;
          },
          DiscretizationParts::Gradient, extent,
          [](const PolygonMesh& mesh, const Discretization& d) {
            return std::vector<Json>{{{"rmse", mean_distance_error(mesh, d, {})}}};
          });
    },
    nullptr};

extern const Experiment franke_plane_experiment = {
    "franke-plane",
    "Poisson's equation in the plane: Franke's function",
    "Figure 8",
    "-laplacian u = f on the unit square, u Franke's function, its values at the boundary; root "
    "mean square error over the inner vertices. Load: mass times f at the vertices.",
    columns_with({{"rmse", "error of the solution", "", "number"}}),
    [] {
      return Json::array({line_figure("franke-plane", "Franke's function on the unit square",
                                      "Second order for all methods; how much error remains "
                                      "depends on the mass as much as on the stiffness.",
                                      "family", {"operator", "mass"}, "mean_edge", "rmse")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolygonMesh>(
          kPlanes, extent.levels_from(1, 4, 3), with_moment_exact_masses,
          DiscretizationParts::Matrices, extent,
          [](const PolygonMesh& mesh, const Discretization& d) {
            return std::vector<Json>{
                {{"rmse", dirichlet_errors(mesh, d.stiffness, {&d.mass}, kFranke)[0]}}};
          });
    },
    nullptr};

extern const Experiment harmonic_sphere_experiment = {
    "harmonic-sphere",
    "A spherical harmonic: the Laplacian applied, and Poisson's equation solved",
    "Figure 9",
    "Y = y (4 z^2 - x^2 - y^2) on the unit sphere has laplacian Y = -12 Y. Applied, as in the "
    "paper: root mean square of M^-1 S Y - 12 Y. Solved: S u = M Y against Y / 12, up to a "
    "constant. The two rank the methods differently.",
    columns_with({{"applied", "error of the Laplacian applied to Y", "", "number"},
                  {"solved", "error of the solution of Poisson's equation", "", "number"}}),
    [] {
      return Json::array(
          {line_figure("harmonic-sphere-applied", "The Laplacian applied to a spherical harmonic",
                       "The paper's form of the problem.", "family", {"operator", "mass"},
                       "mean_edge", "applied"),
           line_figure("harmonic-sphere-solved", "Poisson's equation on the sphere",
                       "Second order for all methods.", "family", {"operator", "mass"}, "mean_edge",
                       "solved")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolygonMesh>(
          kSpheres, extent.levels_from(1, 4, 3), with_lumped_masses, DiscretizationParts::Matrices,
          extent, [](const PolygonMesh& mesh, const Discretization& d) {
            const Vector y = values_at(mesh, third_harmonic);
            return std::vector<Json>{
                {{"applied", applied_error(d.stiffness, d.mass, y, 12)},
                 {"solved", sphere_poisson_errors(d.stiffness, {&d.mass}, y, 12)[0]}}};
          });
    },
    nullptr};

extern const Experiment timestep_experiment = {
    "timestep",
    "The time step of the heat method",
    nullptr,
    "Error of geodesics-sphere against t_coef in t = t_coef h^2, h the longest or the mean edge.",
    columns_with({{"h", "h", "", "text"},
                  {"t_coef", "t_coef", "", "number"},
                  {"rmse", "error of the distance", "length", "number"}}),
    [] {
      Json longest = line_figure("timestep", "Error against the time step",
                                 "Steps below h^2 of the longest edge are not resolved on "
                                 "irregular faces; longer ones smooth.",
                                 "family", {"operator", "h"}, "t_coef", "rmse");
      longest["slopes"] = false;
      longest["references"] = Json::array();
      return Json::array({longest});
    },
    [](const Extent& extent) {
      std::vector<ExperimentCase> cases;
      const auto source = std::make_shared<MeshSource<PolygonMesh>>();
      for (const char* const family : kSpheres)
        for (const Method& method :
             {Method{"diamond"}, Method{"stabilized_diamond"}, Method{"bunge"}, Method{"de_goes"}})
          for (const bool longest : {true, false})
            for (const double t_coef : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
              const FamilyOptions options{.level = extent.quick ? 2 : 3};
              Json parameters{{"family", family}, {"level", options.level}};
              parameters.update(parameters_of<PolygonMesh>(method));
              parameters["h"] = longest ? "max" : "mean";
              parameters["t_coef"] = t_coef;
              cases.push_back(
                  {parameters, [=, threads = extent.threads] {
                     const PolygonMesh& mesh = source->get(family, options);
                     Json row = sizes_of(mesh);
                     row["rmse"] = mean_distance_error(
                         mesh,
                         discretize(mesh, method.name,
                                    options_of(method, DiscretizationParts::Gradient, threads)),
                         {.t_coef = t_coef,
                          .length = longest ? TimeStepLength::MaxEdge : TimeStepLength::MeanEdge});
                     return std::vector<Json>{row};
                   }});
            }
      return cases;
    },
    nullptr};

extern const Experiment virtual_vertices_experiment = {
    "virtual-vertices",
    "Where virtual vertices lie",
    "Section 8.1",
    "Franke's function on non-convex faces, and curvature and the applied harmonic on spheres of "
    "them, with virtual vertices of least squared area, at the mean of the vertices, and of least "
    "trace.",
    columns_with({{"virtual_vertex", "virtual vertex", "", "text"},
                  {"problem", "problem", "", "text"},
                  {"error", "error", "", "number"}}),
    [] {
      Json figures = Json::array();
      for (const auto& [problem, title] :
           {std::pair{"franke", "Franke's problem on concave faces"},
            std::pair{"harmonic", "A spherical harmonic, solved, on concave faces"},
            std::pair{"curvature", "Mean curvature on concave faces"}}) {
        Json figure = line_figure((std::string("virtual-vertices-") + problem).c_str(), title,
                                  "Virtual vertices of least squared area, at the mean of the "
                                  "vertices, and of least trace.",
                                  "family", {"operator", "virtual_vertex"}, "mean_edge", "error");
        figure["filter"] = {{"problem", problem}};
        figures.push_back(figure);
      }
      return figures;
    },
    [](const Extent& extent) {
      std::vector<ExperimentCase> cases;
      const auto source = std::make_shared<MeshSource<PolygonMesh>>();
      for (const char* const family : {"plane-concave", "plane-lshape", "sphere-concave"})
        for (const int level : extent.levels_from(1, 4, 3))
          for (const char* const name : {"diamond", "stabilized_diamond", "bunge"})
            for (const VirtualPoint point : {VirtualPoint::AreaMinimizer, VirtualPoint::Centroid,
                                             VirtualPoint::TraceMinimizer}) {
              Json parameters{{"family", family}, {"level", level}};
              parameters.update(parameters_of<PolygonMesh>({name}));
              parameters["virtual_vertex"] = point == VirtualPoint::AreaMinimizer ? "area"
                                             : point == VirtualPoint::Centroid    ? "centroid"
                                                                                  : "trace";
              cases.push_back(
                  {parameters, [=, threads = extent.threads] {
                     const PolygonMesh& mesh = source->get(family, {.level = level});
                     DiscretizationOptions options =
                         options_of({name}, DiscretizationParts::Matrices, threads);
                     options.virtual_vertex.point = point;
                     const Discretization d = discretize(mesh, name, options);
                     const auto row = [&](const char* problem, Json error) {
                       Json values = sizes_of(mesh);
                       values["problem"] = problem;
                       values["error"] = std::move(error);
                       return values;
                     };
                     if (std::string(family) != "sphere-concave")
                       return std::vector<Json>{row(
                           "franke", dirichlet_errors(mesh, d.stiffness, {&d.mass}, kFranke)[0])};
                     const Vector y = values_at(mesh, third_harmonic);
                     return std::vector<Json>{
                         row("harmonic", sphere_poisson_errors(d.stiffness, {&d.mass}, y, 12)[0]),
                         row("curvature", sphere_curvature_error(mesh, d))};
                   }});
            }
      return cases;
    },
    nullptr};

extern const Experiment sphere_eigenvalues_experiment = {
    "sphere-eigenvalues",
    "Eigenvalues of the unit sphere",
    nullptr,
    "The 36 lowest eigenvalues of -laplacian on the unit sphere, against l (l + 1).",
    columns_with({{"rmse", "error of all 36", "1/length^2", "number"}}),
    [] {
      return Json::array(
          {line_figure("sphere-eigenvalues", "Eigenvalues of the unit sphere",
                       "Root mean square error. The moment-exact mass and the stabilised stiffness "
                       "gain the most here.",
                       "family", {"operator", "mass"}, "mean_edge", "rmse")});
    },
    [](const Extent& extent) {
      return convergence_cases<PolygonMesh>(kSpheres, extent.levels_from(1, 3, 2),
                                            eigenvalue_methods, DiscretizationParts::Matrices,
                                            extent, eigenvalue_rows);
    },
    nullptr};

}  // namespace carat::cli
