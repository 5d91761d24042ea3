// carat info: what there is to know about a mesh before computing on it.

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "cli/command.h"
#include "cli/files.h"
#include "cli/mesh_kinds.h"
#include "cli/operator_options.h"
#include "cli/statistics_report.h"

namespace carat::cli {
namespace {

MeshStatistics statistics_of(const PolygonMesh& mesh) { return mesh_statistics(mesh); }
VolumeStatistics statistics_of(const PolyhedralMesh& mesh) { return volume_statistics(mesh); }

void report_patches(Session&, const SurfaceData&) {}

void report_patches(Session& session, const VolumeData& data) {
  Json& list = session.report()["patches"] = Json::array();
  for (const BoundaryPatch& patch : data.patches) {
    const auto n = static_cast<std::int64_t>(patch.faces.size());
    list.push_back({{"name", patch.name}, {"type", patch.type}, {"faces", n}});
    session.say("boundary patch " + patch.name +
                (patch.type.empty() ? "" : " (" + patch.type + ")") + ": " + count(n, "face"));
  }
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

Json describe_fields(Session& session, const char* element, const std::vector<Field>& fields) {
  Json list = Json::array();
  for (const Field& field : fields) list.push_back(describe_field(session, element, field));
  return list;
}

template <class Data>
void report_mesh(Session& session, Data& data) {
  const auto statistics = session.phase("statistics", [&] { return statistics_of(data.mesh); });
  report_statistics(session, statistics);
  report_patches(session, data);
  const char* const element = words(data.mesh).element;
  Json& fields = session.report()["fields"];
  fields["vertex"] = describe_fields(session, "vertex", data.fields.vertex);
  fields[element] = describe_fields(session, element, element_fields(data));
  discretize(session, data.mesh, {}, DiscretizationParts::Matrices);
}

void run(Session& session, const std::string& path) {
  MeshData data = read_input(session, path);
  std::visit([&](auto& held) { report_mesh(session, held); }, data);
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
    "  carat info result.vtp --json\n"
    "  carat info cavity/constant/polyMesh\n",
    false,
    declare};

}  // namespace carat::cli
