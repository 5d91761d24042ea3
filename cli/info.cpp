// carat info: what there is to know about a mesh before computing on it.

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "carat/mesh/statistics.h"
#include "cli/command.h"
#include "cli/files.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

Json to_json(const Range& range) {
  return {{"min", range.min}, {"mean", range.mean}, {"max", range.max}};
}

Json to_json(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Json to_json(const MeshStatistics& s) {
  Json valences = Json::object();
  for (std::size_t k = 0; k < s.faces_of_valence.size(); ++k)
    if (s.faces_of_valence[k] > 0) valences[std::to_string(k)] = s.faces_of_valence[k];
  return {{"faces_of_valence", valences},
          {"components", s.components},
          {"closed", s.closed},
          {"boundary_edges", s.boundary_edges},
          {"boundary_loops", s.boundary_loops},
          {"nonmanifold_edges", s.nonmanifold_edges},
          {"nonmanifold_vertices", s.nonmanifold_vertices},
          {"inconsistent_edges", s.inconsistent_edges},
          {"unreferenced_vertices", s.unreferenced_vertices},
          {"nonplanar_faces", s.nonplanar_faces},
          {"nonconvex_faces", s.nonconvex_faces},
          {"degenerate_faces", s.degenerate_faces},
          {"duplicate_faces", s.duplicate_faces},
          {"dropped_corners", s.dropped_corners},
          {"euler_characteristic", s.euler_characteristic},
          {"area", s.area},
          {"enclosed_volume", s.closed ? Json(s.enclosed_volume) : Json(nullptr)},
          {"edge_length", to_json(s.edge_length)},
          {"face_area", to_json(s.face_area)},
          {"face_quality", to_json(s.face_quality)},
          {"bounding_box", {to_json(s.lower), to_json(s.upper)}}};
}

std::string describe(const Range& range) {
  return text(range.min) + " to " + text(range.max) + ", mean " + text(range.mean);
}

std::string describe(const Vec3& x) {
  return "(" + text(x.x()) + ", " + text(x.y()) + ", " + text(x.z()) + ")";
}

void say_statistics(Session& session, const MeshStatistics& s) {
  std::string valences;
  for (std::size_t k = 0; k < s.faces_of_valence.size(); ++k)
    if (s.faces_of_valence[k] > 0)
      valences += (valences.empty() ? "" : ", ") + std::to_string(s.faces_of_valence[k]) + " of " +
                  std::to_string(k);
  session.say("vertices a face: " + valences);
  session.say(count(s.components, "component") + ", " +
              (s.closed ? std::string("closed")
                        : count(s.boundary_loops, "boundary loop") + " of " +
                              count(s.boundary_edges, "edge")) +
              ", Euler characteristic " + std::to_string(s.euler_characteristic));
  session.say("area " + text(s.area) +
              (s.closed && s.inconsistent_edges == 0
                   ? ", enclosed volume " + text(s.enclosed_volume)
                   : ""));
  session.say("box " + describe(s.lower) + " to " + describe(s.upper));
  session.say("edge length " + describe(s.edge_length));
  session.say("face area " + describe(s.face_area));
  session.say("face quality " + describe(s.face_quality) + " (1: regular)");

  const auto say_if_any = [&](Index n, const std::string& meaning) {
    if (n > 0) session.say("! " + std::to_string(n) + " " + meaning);
  };
  say_if_any(s.nonmanifold_edges, "edges of more than two faces");
  say_if_any(s.nonmanifold_vertices, "vertices whose faces form more than one fan");
  say_if_any(s.inconsistent_edges, "edges between faces that are turned against each other");
  say_if_any(s.nonplanar_faces, "faces that are not planar");
  say_if_any(s.nonconvex_faces, "faces that are not convex");
  say_if_any(s.duplicate_faces, "faces with the vertices of a face before");
  say_if_any(s.dropped_corners, "repeated vertices in faces, dropped on reading");
}

/// Extremes of the finite values of a field.
Json describe_field(Session& session, const char* element, const Field& field) {
  double least = std::numeric_limits<double>::infinity();
  double largest = -least;
  std::size_t not_finite = 0;
  for (const double value : field.values) {
    if (!std::isfinite(value)) {
      ++not_finite;
      continue;
    }
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  session.say(std::string(element) + " field " + field.name + ", " +
              count(field.components, "component") + ", " + text(least) + " to " + text(largest) +
              (not_finite > 0 ? ", not finite: " + std::to_string(not_finite) : ""));
  return {{"name", field.name},
          {"components", field.components},
          {"min", least},
          {"max", largest},
          {"not_finite", not_finite}};
}

void run(Session& session, const std::string& path) {
  const SurfaceData data = read_input(session, path);
  const MeshStatistics statistics =
      session.phase("statistics", [&] { return mesh_statistics(data.mesh); });
  session.report()["statistics"] = to_json(statistics);
  say_statistics(session, statistics);

  Json& fields = session.report()["fields"];
  fields = {{"vertex", Json::array()}, {"face", Json::array()}};
  for (const Field& field : data.fields.vertex)
    fields["vertex"].push_back(describe_field(session, "vertex", field));
  for (const Field& field : data.fields.face)
    fields["face"].push_back(describe_field(session, "face", field));

  OperatorOptions options;
  options.name = surface_operators().front()->name;
  discretize(session, data.mesh, options, DiscretizationParts::Matrices);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto path = std::make_shared<std::string>();
  app.add_option("MESH", *path, "The mesh to look at")->required();
  return [path](Session& session) { run(session, *path); };
}

}  // namespace

const Command info_command = {
    "info",
    "Say what a mesh is like: counts, measures, quality, fields, defects",
    "Lines that begin with ! tell what deserves a look; operators work all the same.\n"
    "The last ones come from assembling the default operator.",
    "  carat info bunny.obj\n"
    "  carat info result.vtp --json\n",
    false,
    declare};

}  // namespace carat::cli
