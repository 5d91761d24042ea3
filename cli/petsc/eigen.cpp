// carat eigen over several processes.

#include "cli/eigen.h"

#include <filesystem>
#include <system_error>

#include "carat/base/error.h"
#include "carat/distributed/eigenmodes.h"
#include "cli/petsc/part_engine.h"
#include "cli/petsc/parts.h"

namespace carat::cli {
namespace {

/// The part's vertices where the modes vanish, also those that lie on sides of other parts.
template <class Mesh>
std::vector<Index> dirichlet_vertices(const MeshPart<Mesh>& part, const EigenArguments& arguments) {
  std::vector<Index> vertices;
  if (!arguments.dirichlet) return vertices;
  const std::vector<Index> sides = boundary_sides(part);
  std::vector<int> lies_on(static_cast<std::size_t>(part.mesh.n_vertices()), -1);
  for (const Index side : sides)
    for (const Index v : boundary_side(part.mesh, side).vertices)
      lies_on[static_cast<std::size_t>(v)] = 0;
  SharedBoundary(part.numbers).take_lowest(lies_on);
  const std::int64_t n_sides = sum_of_all(static_cast<std::int64_t>(sides.size()));
  together([&] { check_boundary(arguments, n_sides > 0); });
  for (Index v = 0; v < part.mesh.n_vertices(); ++v)
    if (lies_on[static_cast<std::size_t>(v)] == 0) vertices.push_back(v);
  return vertices;
}

template <class Mesh>
void find_modes(Session& session, const EigenArguments& arguments, PartInput& input,
                const PartData<Mesh>& data) {
  const MeshPart<Mesh>& part = data.part;
  const std::vector<Index> fixed = dirichlet_vertices(part, arguments);
  const Discretization discretization =
      discretize(session, part, arguments.discretization, DiscretizationParts::Matrices);
  const EigenPairs pairs = session.phase("solve", [&](ProgressLine& line) {
    return distributed_eigenmodes(
        part, discretization, arguments.count, fixed, arguments.checkpoint, [&](Index found) {
          line.show("solve: " + std::to_string(found) + " of " + count(arguments.count, "pair"));
        });
  });
  report_pairs(session, arguments, pairs,
               {{"kind", "slepc"},
                {"method", pairs.factor.method},
                {"processes", n_processes()},
                {"iterations", pairs.iterations}});
  MeshFields fields;
  fields.vertex = mode_fields(pairs.vectors);
  write_part_output(session, arguments.output, "Eigenmodes", input, part, std::move(fields));
  on_first([&] {
    std::error_code ignored;
    if (!arguments.checkpoint.empty()) std::filesystem::remove(arguments.checkpoint, ignored);
  });
}

}  // namespace

void PartEngine::eigen(Session& session, const EigenArguments& arguments) const {
  together([&] {
    if (arguments.solver != "auto")
      throw InvalidOption("--solver " + arguments.solver +
                          " is of the embedded engine; choose SLEPc's by its options, e.g. "
                          "-st_pc_type");
    check_part_output(arguments.output);
  });
  PartInput input = read_part_input(session, arguments.input, arguments.output);
  std::visit([&](const auto& data) { find_modes(session, arguments, input, data); }, input.data);
  report_memory(session);
}

}  // namespace carat::cli
