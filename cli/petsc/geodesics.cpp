// carat geodesics over several processes.

#include "cli/geodesics.h"

#include <chrono>
#include <cmath>

#include "carat/base/error.h"
#include "carat/distributed/heat_geodesics.h"
#include "carat/distributed/part_fields.h"
#include "carat/distributed/scatter.h"
#include "carat/io/npy.h"
#include "cli/petsc/part_engine.h"
#include "cli/petsc/parts.h"

namespace carat::cli {
namespace {

/// The part's own vertices that no source reaches, as in the whole mesh.
std::vector<Index> own_unreachable(const PartNumbers& numbers, const Vector& distance) {
  std::vector<Index> vertices;
  for (Index v = 0; v < distance.size(); ++v)
    if (numbers.own_vertex(v) && std::isinf(distance[v])) vertices.push_back(numbers.vertices[v]);
  return vertices;
}

/// Distances from every source by itself, into the rows of a matrix or fields of the mesh.
template <class Mesh>
void measure_each(Session& session, const GeodesicsArguments& options, PartInput& input,
                  const MeshPart<Mesh>& part, const DistributedGeodesics& geodesics,
                  const SourceSets& sets) {
  const PartNumbers& numbers = part.numbers;
  DistanceSummary summary;
  const auto start = std::chrono::steady_clock::now();
  const auto for_each = [&](const auto& use) {
    session.phase("solve", [&](ProgressLine& line) {
      for (std::size_t set = 0; set < sets.size(); ++set) {
        const GeodesicDistance distance = geodesics.distance(sets[set]);
        const auto n_unreachable =
            static_cast<std::int64_t>(own_unreachable(numbers, distance.values).size());
        const Extremes found = part_extremes(numbers, distance.values);
        summary.add(sum_of_all(n_unreachable) == 0, distance.unresolved_samples, found.largest);
        use(set, distance.values);
        line.show("solve " + std::to_string(set + 1) + " of " + std::to_string(sets.size()));
      }
    });
    report_each(session, summary,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  };
  if (options.writes_matrix()) {
    // The first process writes each row as it gets it.
    const auto produce = [&](const PutRow& put) {
      for_each([&](std::size_t, const Vector& values) {
        const Matrix row = gather_vertices(numbers, values);
        if (own_rank() == 0) put(row.col(0));
      });
    };
    const Index rows = static_cast<Index>(sets.size());
    if (own_rank() > 0) {
      produce({});
      return;
    }
    write_npy(options.output, rows, numbers.n_vertices, produce);
    report_matrix(session, options.output, rows, numbers.n_vertices);
    return;
  }
  MeshFields fields;
  for_each([&](std::size_t set, const Vector& values) {
    if (!options.output.empty())
      fields.vertex.push_back(scalar_field("distance_" + std::to_string(set), values));
  });
  write_part_output(session, options.output, "Geodesic distances", input, part, std::move(fields));
}

template <class Mesh>
void measure(Session& session, const GeodesicsArguments& options, PartInput& input,
             const PartData<Mesh>& data) {
  const MeshPart<Mesh>& part = data.part;
  SourceSets sets;
  together([&] { sets = source_sets(options, part.numbers.n_vertices); });
  Discretization discretization =
      discretize(session, part, options.discretization, options.parts());
  const DistributedGeodesics geodesics = session.phase("setup", [&] {
    return DistributedGeodesics(part, std::move(discretization), options.heat());
  });
  report_options(session, options, geodesics.time_step());
  session.report()["solver"] = {{"kind", "petsc"}, {"processes", n_processes()}};
  if (options.each) {
    measure_each(session, options, input, part, geodesics, sets);
    return;
  }
  const GeodesicDistance distance =
      session.phase("solve", [&] { return geodesics.distance(sets.front()); });
  report_distance(session, gather_numbers(own_unreachable(part.numbers, distance.values)),
                  distance.unresolved_samples, part_extremes(part.numbers, distance.values));
  if (options.output.empty()) return;
  MeshFields fields;
  fields.vertex = {scalar_field("distance", distance.values)};
  const Discretization& d = geodesics.discretization();
  const PartFields vectors(part.numbers, d);
  element_fields(fields, part.mesh) = {
      direction_field(vectors.element_vectors(d.gradient * finite(distance.values)))};
  write_part_output(session, options.output, "Geodesic distance", input, part, std::move(fields));
}

}  // namespace

void PartEngine::geodesics(Session& session, const GeodesicsArguments& arguments) const {
  together([&] {
    check_sources(arguments);
    if (arguments.solver != "auto")
      throw InvalidOption("--solver " + arguments.solver +
                          " is of the embedded engine; choose PETSc's by its options, e.g. "
                          "-pc_type");
    if (arguments.writes_matrix())
      check_output_folder(arguments.output);
    else
      check_part_output(arguments.output);
  });
  // The rows of a matrix need no mesh.
  PartInput input =
      read_part_input(session, arguments.input, arguments.writes_matrix() ? "" : arguments.output);
  std::visit([&](const auto& data) { measure(session, arguments, input, data); }, input.data);
  report_memory(session);
}

}  // namespace carat::cli
