#include "cli/statistics_report.h"

namespace carat::cli {
namespace {

Json to_json(const Range& range) {
  return {{"min", range.min}, {"mean", range.mean}, {"max", range.max}};
}

Json to_json(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

/// {"4": 12, "5": 3}: twelve with 4, three with 5.
Json histogram_to_json(const std::vector<Index>& counts) {
  Json histogram = Json::object();
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k] > 0) histogram[std::to_string(k)] = counts[k];
  return histogram;
}

Json to_json(const MeshStatistics& s) {
  return {{"faces_of_valence", histogram_to_json(s.faces_of_valence)},
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

Json to_json(const VolumeStatistics& s) {
  Json kinds = Json::object();
  for (const CellKind kind : kCellKinds)
    if (const Index n = s.cells_of_kind[static_cast<std::size_t>(kind)]; n > 0)
      kinds[cell_kind_name(kind)] = n;
  const MeshStatistics &faces = s.all_faces, &boundary = s.boundary;
  return {{"cells_of_kind", kinds},
          {"cells_of_size", histogram_to_json(s.cells_of_size)},
          {"faces_of_valence", histogram_to_json(faces.faces_of_valence)},
          {"inner_faces", s.inner_faces},
          {"boundary_faces", s.boundary_faces},
          {"components", s.components},
          {"vertex_components", s.vertex_components},
          {"boundary",
           {{"components", boundary.components},
            {"area", boundary.area},
            {"euler_characteristic", boundary.euler_characteristic},
            {"nonmanifold_edges", boundary.nonmanifold_edges},
            {"nonmanifold_vertices", boundary.nonmanifold_vertices}}},
          {"nonplanar_faces", faces.nonplanar_faces},
          {"nonconvex_faces", faces.nonconvex_faces},
          {"degenerate_faces", faces.degenerate_faces},
          {"duplicate_faces", faces.duplicate_faces},
          {"dropped_corners", faces.dropped_corners},
          {"hanging_vertices_complete", s.hanging_vertices_complete},
          {"volume", s.volume},
          {"edge_length", to_json(faces.edge_length)},
          {"face_area", to_json(faces.face_area)},
          {"cell_volume", to_json(s.cell_volume)},
          {"cell_quality", to_json(s.cell_quality)},
          {"bounding_box", {to_json(faces.lower), to_json(faces.upper)}}};
}

std::string describe(const Range& range) {
  return text(range.min) + " to " + text(range.max) + ", mean " + text(range.mean);
}

std::string describe(const Vec3& x) {
  return std::string("(") + text(x.x()) + ", " + text(x.y()) + ", " + text(x.z()) + ")";
}

/// "12 of 5, 30 of 6".
std::string describe(const std::vector<Index>& histogram) {
  std::string list;
  for (std::size_t k = 0; k < histogram.size(); ++k)
    if (histogram[k] > 0)
      list +=
          (list.empty() ? "" : ", ") + std::to_string(histogram[k]) + " of " + std::to_string(k);
  return list;
}

std::string describe_kinds(const VolumeStatistics& s) {
  std::string list;
  for (const CellKind kind : kCellKinds)
    if (const Index n = s.cells_of_kind[static_cast<std::size_t>(kind)]; n > 0)
      list += (list.empty() ? "" : ", ") + std::to_string(n) + " " + cell_kind_name(kind);
  return list;
}

void say_if_any(Session& session, Index n, const std::string& meaning) {
  if (n > 0) session.say("! " + describe_count(n, meaning));
}

void say_face_shapes(Session& session, const MeshStatistics& s) {
  say_if_any(session, s.nonplanar_faces, "faces not planar");
  say_if_any(session, s.nonconvex_faces, "faces not convex");
  say_if_any(session, s.dropped_corners, "repeated vertices in faces, dropped on reading");
}

}  // namespace

void report_statistics(Session& session, const MeshStatistics& s) {
  session.report()["statistics"] = to_json(s);
  session.say("vertices a face: " + describe(s.faces_of_valence));
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
  say_if_any(session, s.nonmanifold_edges, "edges of more than two faces");
  say_if_any(session, s.nonmanifold_vertices, "vertices with more than one fan of faces");
  say_if_any(session, s.inconsistent_edges, "edges between faces turned against each other");
  say_if_any(session, s.duplicate_faces, "faces with the vertices of a face before");
  say_face_shapes(session, s);
}

void report_statistics(Session& session, const VolumeStatistics& s) {
  session.report()["statistics"] = to_json(s);
  const MeshStatistics &faces = s.all_faces, &boundary = s.boundary;
  session.say("cells: " + describe_kinds(s));
  session.say("faces a cell: " + describe(s.cells_of_size));
  session.say("vertices a face: " + describe(faces.faces_of_valence));
  session.say(count(s.inner_faces, "inner face") + ", " + count(s.boundary_faces, "boundary face"));
  std::string components = count(s.components, "component");
  if (s.vertex_components < s.components)
    components += ", joined at vertices to " + std::to_string(s.vertex_components);
  session.say(components + ", boundary of " + count(boundary.components, "component"));
  session.say("volume " + text(s.volume) + ", boundary area " + text(boundary.area));
  session.say("box " + describe(faces.lower) + " to " + describe(faces.upper));
  session.say("edge length " + describe(faces.edge_length));
  session.say("face area " + describe(faces.face_area));
  session.say("cell volume " + describe(s.cell_volume));
  session.say("cell quality " + describe(s.cell_quality) + " (1: regular)");
  say_if_any(session, boundary.nonmanifold_edges, "edges of more than two boundary faces");
  say_if_any(session, boundary.nonmanifold_vertices,
             "vertices with more than one fan of boundary faces");
  say_if_any(session, faces.duplicate_faces,
             "faces with the vertices of a face before, as baffles have them");
  say_face_shapes(session, faces);
  session.add_diagnostics(s.findings);
  if (!s.hanging_vertices_complete)
    session.note("the search for hanging vertices was given up; there may be more");
}

}  // namespace carat::cli
