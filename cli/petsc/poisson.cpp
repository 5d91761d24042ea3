// carat poisson over several processes.

#include "cli/poisson.h"

#include <optional>

#include "carat/base/error.h"
#include "carat/distributed/part_fields.h"
#include "carat/distributed/poisson.h"
#include "cli/petsc/part_engine.h"
#include "cli/petsc/parts.h"

namespace carat::cli {
namespace {

template <class Mesh>
Coefficient coefficient_of(const PoissonArguments& options, const PoissonExpressions& given,
                           const PartData<Mesh>& data) {
  Coefficient coefficient;
  together([&] {
    if (given.coefficient) coefficient.function = *given.coefficient;
    if (!options.coefficient_field.empty())
      coefficient.of_cells = cell_coefficient(
          data.part.mesh, data.fields, options.coefficient_field, data.part.numbers.elements);
  });
  return coefficient;
}

/// Reports the error norms. \return the field "error"
template <class Mesh>
Field compare(Session& session, const MeshPart<Mesh>& part, const DistributedPoisson& poisson,
              const Expression& exact, const Vector& u) {
  Vector reference;
  together([&] { reference = exact.at(part.mesh.points()); });
  poisson.remove_floating_means(reference);
  for (Index v = 0; v < reference.size(); ++v)
    if (part.numbers.vertex_components[v] < 0) reference[v] = u[v];
  const Vector error = u - reference;
  report_errors(session, poisson.norms(error));
  return scalar_field("error", error);
}

template <class Mesh>
void solve(Session& session, const PoissonArguments& options, const PoissonExpressions& given,
           PartInput& input, const PartData<Mesh>& data) {
  const MeshPart<Mesh>& part = data.part;
  const bool writes = !options.output.empty();
  const GivenConditions placed =
      boundary_conditions(Boundary<Mesh>{part.mesh, boundary_sides(part), data.patches},
                          given.boundary, SharedBoundary(part.numbers));
  const Discretization discretization =
      discretize(session, part, options.discretization,
                 writes ? DiscretizationParts::Frames : DiscretizationParts::Matrices,
                 coefficient_of(options, given, data), MatrixNeed::Multiplied);
  Vector f;
  together([&] { f = given.rhs.at(part.mesh.points()); });
  const DistributedPoisson poisson = session.phase(
      "setup", [&] { return DistributedPoisson(part, discretization, placed.conditions); });
  report_share(session, poisson.share());
  const PoissonSolution solution = session.phase("solve", [&] { return poisson.solve(f); });

  const Vector& u = solution.values;
  report_conditions(session, placed, words(part.mesh).side);
  report_solution(session, solution, part_extremes(part.numbers, u),
                  {{"kind", "petsc"},
                   {"method", solution.solve.method},
                   {"processes", n_processes()},
                   {"iterations", solution.solve.iterations},
                   {"residual", solution.solve.residual}},
                  "processes: " + std::to_string(n_processes()));
  MeshFields fields;
  fields.vertex = {scalar_field("u", u)};
  if (given.exact) fields.vertex.push_back(compare(session, part, poisson, *given.exact, u));
  if (!writes) return;
  if (discretization.gradient_dimension == 0) {
    note_no_gradient(session, discretization.name);
  } else {
    const Vector gradient = discretization.gradient * u;
    const PartFields vectors(part.numbers, discretization);
    fields.vertex.push_back(vector_field("gradient", vectors.vertex_vectors(gradient)));
    element_fields(fields,
                   part.mesh) = {vector_field("gradient", vectors.element_vectors(gradient))};
  }
  write_part_output(session, options.output, "Poisson", input, part, std::move(fields));
}

}  // namespace

void PartEngine::poisson(Session& session, const PoissonArguments& arguments) const {
  std::optional<PoissonExpressions> given;
  together([&] {
    given.emplace(arguments);
    if (arguments.solver != "auto")
      throw InvalidOption("--solver " + arguments.solver +
                          " is of the embedded engine; choose PETSc's by its options, e.g. "
                          "-pc_type");
    if (arguments.storage != "full")
      throw InvalidOption("--matrix-storage " + arguments.storage + " is of the embedded engine");
    check_part_output(arguments.output);
  });
  PartInput input = read_part_input(session, arguments.input, arguments.output);
  std::visit([&](const auto& data) { solve(session, arguments, *given, input, data); }, input.data);
  report_memory(session);
}

}  // namespace carat::cli
