// Experiments on one real model, cut into different faces over the same vertices: Figures 4 and 6.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "carat/apps/heat_geodesics.h"
#include "carat/apps/mean_curvature.h"
#include "carat/apps/recommended.h"
#include "carat/base/error.h"
#include "carat/mesh/transform.h"
#include "cli/experiments/series.h"
#include "cli/files.h"

namespace carat::cli {
namespace {

/// Joins pairs of triangles to quadrilaterals across their longest edges first.
PolygonMesh pair_triangles(const PolygonMesh& mesh) {
  const EdgeTopology& edges = mesh.edges();
  std::vector<std::pair<double, Index>> order;
  for (Index e = 0; e < edges.size(); ++e)
    if (edges.corners.size(e) == 2) {
      const auto& [a, b] = edges.vertices[static_cast<std::size_t>(e)];
      order.emplace_back(-(mesh.point(a) - mesh.point(b)).squaredNorm(), e);
    }
  std::sort(order.begin(), order.end());
  const auto& vertices = mesh.faces().indices;
  const auto at = [&](Index corner, Index step) {
    return vertices[static_cast<std::size_t>(corner / 3 * 3 + (corner + step) % 3)];
  };
  std::vector<bool> used(static_cast<std::size_t>(mesh.n_faces()), false);
  std::vector<std::vector<Index>> faces;
  for (const auto& [length, e] : order) {
    const Index c = edges.corners.indices[edges.corners.begin(e)];
    const Index d = edges.corners.indices[edges.corners.begin(e) + 1];
    const auto first = static_cast<std::size_t>(c / 3), second = static_cast<std::size_t>(d / 3);
    if (used[first] || used[second] || at(c, 0) == at(d, 0) || at(c, 2) == at(d, 2)) continue;
    used[first] = used[second] = true;
    faces.push_back({at(c, 2), at(c, 0), at(d, 2), at(d, 0)});
  }
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (!used[static_cast<std::size_t>(f)])
      faces.push_back({at(3 * f, 0), at(3 * f, 1), at(3 * f, 2)});
  return PolygonMesh::from_faces(mesh.points(), faces);
}

/// The model with other faces over its vertices; of a model of triangles those of its dual.
struct Tessellations {
  PolygonMesh polygons, triangles, quads;
  Index source = 0;  ///< the vertex of a face that is farthest from the middle of the bounding box
};

const Tessellations& tessellations(const std::string& file) {
  static std::map<std::string, Tessellations> read;
  const auto found = read.find(file);
  if (found != read.end()) return found->second;
  Tessellations made;
  try {
    made.polygons = read_surface(file).mesh;
  } catch (const IoError& error) {
    throw IoError(std::string(error.what()) + "; pass a surface with --model");
  }
  if (made.polygons.n_corners() == 3 * made.polygons.n_faces())
    made.polygons = dual_mesh(made.polygons);
  made.triangles = triangulate(made.polygons);
  made.quads = pair_triangles(made.triangles);
  const Points& points = made.polygons.points();
  const Eigen::RowVector3d middle = (points.colwise().minCoeff() + points.colwise().maxCoeff()) / 2;
  double farthest = -1;
  for (const Index v : made.polygons.faces().indices) {
    const double distance = (points.row(v) - middle).squaredNorm();
    if (distance <= farthest) continue;
    farthest = distance;
    made.source = v;
  }
  return read.emplace(file, std::move(made)).first->second;
}

std::string name_of(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

/// The file's name and size: what was measured on another file of that name counts no more.
Json model_parameters(const std::string& file) {
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(file, missing);
  return {{"model", name_of(file)}, {"model_bytes", missing ? Json(nullptr) : Json(bytes)}};
}

const ExperimentColumn kModel{"model", "model", "", "text"},
    kModelBytes{"model_bytes", "size of its file", "bytes", "integer"},
    kTessellation{"tessellation", "tessellation", "", "text"},
    kFaces{"faces", "faces", "", "integer"};

Vector curvature_on(const PolygonMesh& mesh, const Method& method, int threads) {
  return mean_curvature(mesh,
                        discretize(mesh, method.name,
                                   options_of(method, DiscretizationParts::Matrices, threads)))
      .values;
}

GeodesicDistance distance_on(const PolygonMesh& mesh, Index source, const Method& method,
                             int threads) {
  return HeatGeodesics(mesh,
                       discretize(mesh, method.name,
                                  options_of(method, DiscretizationParts::Gradient, threads)),
                       {.solver = {.threads = threads}})
      .distance(source);
}

/// Of each tessellation, its difference from the first one's values at the same vertices.
std::vector<Json> compare(const std::vector<std::pair<const char*, const PolygonMesh*>>& meshes,
                          const std::function<Vector(const PolygonMesh&)>& values_on) {
  std::vector<Json> rows;
  Vector first;
  for (const auto& [name, mesh] : meshes) {
    const Vector values = values_on(*mesh);
    if (first.size() == 0) first = values;
    const Vector difference = values - first;
    rows.push_back({{"tessellation", name},
                    {"vertices", mesh->n_vertices()},
                    {"faces", mesh->n_faces()},
                    {"rms", root_mean_square(values)},
                    {"max", values.cwiseAbs().maxCoeff()},
                    {"max_difference", difference.cwiseAbs().maxCoeff()},
                    {"rms_difference", root_mean_square(difference)},
                    {"relative", root_mean_square(difference) / root_mean_square(values)}});
  }
  return rows;
}

std::vector<ExperimentColumn> columns_of(const char* what, const char* unit) {
  return {kModel,
          kModelBytes,
          kOperator,
          kMass,
          kTheta,
          kTau,
          kTessellation,
          kVertices,
          kFaces,
          {"rms", what, unit, "number"},
          {"max", "largest", unit, "number"},
          {"max_difference", "largest difference", unit, "number"},
          {"rms_difference", "difference (rms)", unit, "number"},
          {"relative", "relative difference (rms)", "", "number"}};
}

Json figures_of(const std::string& id, const char* title, const char* caption, double isolines) {
  const Json shown = {"tessellation", "operator", "mass",           "theta",
                      "faces",        "rms",      "max_difference", "relative"};
  return {{{"id", id},
           {"title", title},
           {"caption", caption},
           {"kind", "picture"},
           {"isolines", isolines}},
          {{"id", id + "-differences"},
           {"title", "Differences from the polygons, at the same vertices"},
           {"caption", "rms: root mean square over the vertices; relative: of that of the values."},
           {"kind", "table"},
           {"columns", shown},
           {"filter", nullptr}}};
}

template <class Measure>
std::vector<ExperimentCase> picture_cases(const Extent& extent, const std::vector<Method>& methods,
                                          const Measure& measure) {
  std::vector<ExperimentCase> cases;
  for (const Method& method : methods) {
    Json parameters = model_parameters(extent.model);
    parameters.update(parameters_of<PolygonMesh>(method));
    cases.push_back({parameters, [=] { return measure(tessellations(extent.model), method); }});
  }
  return cases;
}

Method recommended(Application application) {
  const OperatorChoice choice = recommended_operator(application, PolygonMesh());
  return {choice.name, choice.mass, choice.theta};
}

ViewItem item(const std::string& title, const PolygonMesh& mesh, const char* field,
              const Vector& values) {
  SurfaceData data{mesh, {}};
  data.fields.vertex = {scalar_field(field, values)};
  return {title, std::move(data)};
}

}  // namespace

extern const Experiment curvature_picture_experiment = {
    "curvature-picture",
    "Mean curvature of a real model",
    "Figure 4",
    "Absolute mean curvature of one model as a mesh of polygons and as one of triangles over the "
    "same vertices, with the largest difference of the two.",
    columns_of("mean curvature (rms)", "1/length"),
    [] {
      return figures_of("curvature-picture", "Absolute mean curvature, by two tessellations",
                        "The default operator of carat curvature.", 0);
    },
    [](const Extent& extent) {
      return picture_cases(
          extent,
          {{"diamond"},
           {"diamond", MassKind::Lumped},
           {"stabilized_diamond", MassKind::Lumped},
           {"bunge"},
           {"alexa_wardetzky"},
           {"de_goes"},
           {"vem"}},
          [threads = extent.threads](const Tessellations& of, const Method& m) {
            return compare({{"polygons", &of.polygons}, {"triangles", &of.triangles}},
                           [&](const PolygonMesh& mesh) { return curvature_on(mesh, m, threads); });
          });
    },
    nullptr,
    [](const Extent& extent) {
      const Tessellations& of = tessellations(extent.model);
      const Method method = recommended(Application::MeanCurvature);
      return std::vector<ViewItem>{item("polygons", of.polygons, "mean_curvature",
                                        curvature_on(of.polygons, method, extent.threads)),
                                   item("triangles", of.triangles, "mean_curvature",
                                        curvature_on(of.triangles, method, extent.threads))};
    }};

extern const Experiment geodesics_picture_experiment = {
    "geodesics-picture",
    "Geodesic distance on a real model",
    "Figure 6",
    "Distance from one vertex of a model as a mesh of polygons, of triangles and mostly of "
    "quadrilaterals over the same vertices; the heat method, t = h^2, h the longest edge of each.",
    columns_of("distance (rms)", "length"),
    [] {
      return figures_of("geodesics-picture", "Lines of equal distance, by three tessellations",
                        "The default operator of carat geodesics.", 24);
    },
    [](const Extent& extent) {
      return picture_cases(
          extent, {{"diamond"}, recommended(Application::Geodesics), {"bunge"}, {"de_goes"}},
          [threads = extent.threads](const Tessellations& of, const Method& m) {
            return compare(
                {{"polygons", &of.polygons}, {"triangles", &of.triangles}, {"quads", &of.quads}},
                [&](const PolygonMesh& mesh) {
                  return distance_on(mesh, of.source, m, threads).values;
                });
          });
    },
    nullptr,
    [](const Extent& extent) {
      const Tessellations& of = tessellations(extent.model);
      const Method method = recommended(Application::Geodesics);
      std::vector<ViewItem> items;
      for (const auto& [name, mesh] : {std::pair{"polygons", &of.polygons},
                                       {"triangles", &of.triangles},
                                       {"quads", &of.quads}})
        items.push_back(item(name, *mesh, "distance",
                             distance_on(*mesh, of.source, method, extent.threads).values));
      return items;
    }};

}  // namespace carat::cli
