// carat poisson: Poisson's equation with expressions for its data.

#include "cli/poisson.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <utility>

#include "carat/base/error.h"
#include "cli/command.h"
#include "cli/mesh_kinds.h"

namespace carat::cli {
namespace {

std::optional<Expression> parse(const char* name, const std::optional<std::string>& text) {
  return text ? std::optional<Expression>(std::in_place, name, *text) : std::nullopt;
}

/// Values at the vertices and at the unknowns beyond them.
Vector at_unknowns(const Expression& expression, const Points& vertices, const Discretization& d) {
  Vector values(d.n_unknowns());
  values << expression.at(vertices), expression.at(d.extra.positions);
  return values;
}

/// Takes the mean by mass off the reference in every component whose solution has mean zero.
template <class Mesh>
void remove_floating_means(const Mesh& mesh, const Discretization& discretization,
                           const BoundaryConditions& conditions, Vector& reference) {
  const std::vector<Index> component = discretization.stiffness_product
                                           ? discretization.stiffness_product->components()
                                           : matrix_components(discretization.stiffness);
  const Vector mass = discretization.lumped_mass();
  const Index n = component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;
  std::vector<bool> anchored(static_cast<std::size_t>(n), false);
  const auto anchor = [&](Index v) {
    if (const Index c = component[static_cast<std::size_t>(v)]; c >= 0)
      anchored[static_cast<std::size_t>(c)] = true;
  };
  for (const Index v : conditions.dirichlet_vertices) anchor(v);
  for (std::size_t k = 0; k < conditions.robin_sides.size(); ++k)
    if (conditions.robin_alpha[k] > 0)
      anchor(boundary_side(mesh, conditions.robin_sides[k]).vertices[0]);

  std::vector<double> sum(anchored.size(), 0), total(anchored.size(), 0);
  const auto for_each_floating = [&](const auto& visit) {
    for (Index v = 0; v < reference.size(); ++v) {
      const Index c = component[static_cast<std::size_t>(v)];
      if (c >= 0 && !anchored[static_cast<std::size_t>(c)]) visit(v, static_cast<std::size_t>(c));
    }
  };
  for_each_floating([&](Index v, std::size_t c) {
    sum[c] += mass[v] * reference[v];
    total[c] += mass[v];
  });
  for_each_floating([&](Index v, std::size_t c) { reference[v] -= sum[c] / total[c]; });
}

template <class Mesh>
void compare(Session& session, const Mesh& mesh, const Discretization& discretization,
             const BoundaryConditions& conditions, const Expression& exact, const Vector& u,
             std::vector<Field>& fields) {
  Vector reference = at_unknowns(exact, mesh.points(), discretization);
  remove_floating_means(mesh, discretization, conditions, reference);
  // Errors are those at the vertices, also where there are more unknowns.
  const Index n = mesh.n_vertices();
  reference.conservativeResize(n);
  // Vertices of no element take no part.
  if (const Finding* const unused = discretization.diagnostics.find("unreferenced_vertices"))
    for (const Index v : unused->elements) reference[v] = u[v];
  const ErrorNorms errors =
      discretization.mass_product
          ? error_norms(*discretization.mass_product, u, reference)
          : error_norms(SparseMatrix(discretization.mass.topLeftCorner(n, n)), u, reference);
  report_errors(session, errors);
  fields.push_back(scalar_field("error", u - reference));
}

Json to_json(const SolverInfo& info, const SolveReport& how) {
  return {{"kind", solver_kind_name(info.kind)},
          {"method", how.method},
          {"reason", info.reason},
          {"ordering", info.ordering},
          {"factor_nnz", info.nonzeros},
          {"assembled", info.assembled},
          {"halved", info.halved},
          {"operator_bytes", info.operator_bytes},
          {"iterations", how.iterations},
          {"residual", how.residual}};
}

template <class Data>
void solve(Session& session, const PoissonArguments& options, const PoissonExpressions& given,
           Data& data) {
  check_output_kind(options.output, words(data.mesh));
  GivenConditions placed = boundary_conditions(
      Boundary<std::decay_t<decltype(data.mesh)>>{data.mesh, boundary_sides(data.mesh),
                                                  patches(data)},
      given.boundary);
  BoundaryConditions& conditions = placed.conditions;
  if (const Expression* const dirichlet = given.boundary.dirichlet.everywhere())
    conditions.dirichlet_function = *dirichlet;
  const bool writes = !options.output.empty();
  Coefficient coefficient;
  if (given.coefficient) coefficient.function = *given.coefficient;
  if (!options.coefficient_field.empty())
    coefficient.of_cells = cell_coefficient(data.mesh, data.fields, options.coefficient_field);
  const SolverOptions solver{.kind = solver_kind(options.solver),
                             .threads = session.threads(),
                             .storage = matrix_storage(options.storage)};
  Discretization discretization = discretize(
      session, data.mesh, options.discretization,
      writes ? DiscretizationParts::Frames : DiscretizationParts::Matrices, coefficient, &solver);
  const Vector f = at_unknowns(given.rhs, data.mesh.points(), discretization);
  // The comparison needs the matrices once more; nothing else does.
  const Poisson poisson = session.phase("factor", [&] {
    return given.exact ? Poisson(data.mesh, discretization, conditions, solver)
                       : Poisson(data.mesh, std::move(discretization), conditions, solver);
  });
  const PoissonSolution solution = session.phase("solve", [&] { return poisson.solve(f); });

  report_conditions(session, placed, words(data.mesh).side);
  const Vector u = solution.values.head(data.mesh.n_vertices());
  report_solution(session, solution, extremes(u), to_json(poisson.solver(), solution.solve),
                  poisson.solver().reason);
  session.moved("factor", setup_bytes(poisson.solver()));
  session.moved("solve", solution.solve.traffic);
  data.fields.vertex = {scalar_field("u", u)};
  element_fields(data).clear();
  if (given.exact)
    compare(session, data.mesh, discretization, conditions, *given.exact, u, data.fields.vertex);
  if (!writes) return;
  if (discretization.gradient_dimension == 0) {
    note_no_gradient(session, discretization.name);
    write_output(session, options.output, "Poisson", std::move(data));
    return;
  }
  const Vector gradient = discretization.gradient * solution.values;
  data.fields.vertex.push_back(vector_field("gradient", discretization.vertex_vectors(gradient)));
  element_fields(data) = {
      vector_field("gradient", discretization.element_vectors(gradient, n_elements(data.mesh)))};
  write_output(session, options.output, "Poisson", std::move(data));
}

void run(Session& session, const PoissonArguments& options) {
  if (session.engine() != nullptr) {
    session.engine()->poisson(session, options);
    return;
  }
  const PoissonExpressions given(options);
  check_output(options.output, Content::MeshFields);
  MeshData data = read_input(session, options.input);
  std::visit([&](auto& held) { solve(session, options, given, held); }, data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<PoissonArguments>();
  app.add_option("MESH", options->input, "The mesh")->required();
  const auto add = [&](const char* name, auto& target, const char* description) {
    return app.add_option(name, target, description)->type_name("EXPR");
  };
  const auto add_boundary = [&](const char* name, std::vector<std::string>& target,
                                const char* description) {
    app.add_option(name, target, description)->type_name("[PATCH=]EXPR")->allow_extra_args(false);
  };
  add("--rhs", options->rhs, "f, at the unknowns")->required();
  add_boundary("--dirichlet", options->dirichlet,
               "u at the boundary vertices. With PATCH= only on this\n"
               "boundary patch of a volume; repeat it for several, an\n"
               "EXPR alone holds on the rest. Where patches meet, the\n"
               "first one holds");
  add("--dirichlet-where", options->dirichlet_where,
      "Only at those boundary vertices where this is not 0,\n"
      "e.g. \"x < 0.001\"");
  add_boundary("--neumann", options->neumann,
               "Outward flux K du/dn at the middles of the other boundary\n"
               "edges, of volumes faces; without it, 0");
  add_boundary("--robin", options->robin,
               "alpha >= 0: K du/dn + alpha u = g on those edges or faces,\n"
               "g given by --neumann");
  add("--coefficient", options->coefficient,
      "K > 0, at the centroids of the gradient samples; without\nit, 1");
  app.add_option("--coefficient-field", options->coefficient_field,
                 "A field of the cells of a volume as K, times --coefficient:\n"
                 "scalars, or symmetric tensors of 6 (xx yy zz xy yz xz) or\n"
                 "9 components")
      ->type_name("NAME");
  add("--exact", options->exact, "Compare u with this and print the error norms");
  app.add_option("-o,--output", options->output,
                 "File for the mesh with the fields u and gradient, and\n"
                 "error with --exact, or a view (.html); without it\n"
                 "nothing is written");
  app.add_option("--solver", options->solver,
                 "auto: a Cholesky factorisation of small systems, conjugate\n"
                 "gradients with multigrid for large ones, which need no\n"
                 "matrix of a diamond on polygons and polyhedra. Others:\n"
                 "cholesky, multigrid, incomplete-cholesky,\n"
                 "sparser-cholesky")
      ->type_name("NAME");
  app.add_option("--matrix-storage", options->storage,
                 "full, or triangle: little more than one triangle of the\n"
                 "matrices, for less memory; no change where the solver\n"
                 "needs no matrix")
      ->type_name("NAME");
  declare_engine_option(app);
  declare_operator_options(app, options->discretization, Application::Poisson);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

PoissonExpressions::PoissonExpressions(const PoissonArguments& arguments)
    : rhs("--rhs", arguments.rhs),
      boundary{{"--dirichlet", arguments.dirichlet},
               {"--neumann", arguments.neumann},
               {"--robin", arguments.robin},
               parse("--dirichlet-where", arguments.dirichlet_where)},
      coefficient(parse("--coefficient", arguments.coefficient)),
      exact(parse("--exact", arguments.exact)) {
  if (boundary.dirichlet_where && boundary.dirichlet.empty())
    throw InvalidOption("--dirichlet-where says where but not what; add --dirichlet EXPR");
}

void report_conditions(Session& session, const GivenConditions& conditions,
                       const std::string& side) {
  Json& sizes = session.report()["sizes"];
  const std::string sides = side + "s";
  sizes["dirichlet_vertices"] = conditions.n_dirichlet;
  sizes["neumann_" + sides] = conditions.n_neumann;
  sizes["robin_" + sides] = conditions.n_robin;
  session.say(count(conditions.n_dirichlet, "Dirichlet vertex") + ", " +
              count(conditions.n_neumann, "Neumann " + side) + ", " +
              count(conditions.n_robin, "Robin " + side));
}

void report_solution(Session& session, const PoissonSolution& solution, const Extremes& u,
                     Json solver, const std::string& reason) {
  Json& report = session.report();
  report["u"] = to_json(u);
  report["relative_residual"] = solution.relative_residual;
  report["floating_components"] = solution.floating_components;
  report["imbalance"] = solution.imbalance;
  report["errors"] = nullptr;
  const SolveReport& how = solution.solve;
  report["solver"] = std::move(solver);
  session.say("solver: " + how.method +
              (how.iterations > 0 ? ", " + count(how.iterations, "iteration") : "") +
              (reason.empty() ? "" : " (" + reason + ")"));
  session.say("u: " + in_words(u) + ", relative residual " + text(solution.relative_residual));
  if (solution.floating_components > 0)
    session.say(count(solution.floating_components, "component") +
                " without Dirichlet or Robin data: mean zero there; imbalance of the data " +
                text(solution.imbalance) + ", subtracted");
}

void report_errors(Session& session, const ErrorNorms& errors) {
  session.report()["errors"] = {{"rmse", errors.rmse}, {"l2", errors.l2}, {"max", errors.max}};
  session.say("error against --exact: rmse " + text(errors.rmse) + ", L2 " + text(errors.l2) +
              ", max " + text(errors.max));
}

void note_no_gradient(Session& session, const std::string& operator_name) {
  session.note("the operator " + operator_name + " defines no gradient: u only");
}

const Command poisson_command = {
    "poisson",
    "Solve Poisson's equation -div(K grad u) = f",
    "Without Dirichlet and Robin data u is determined up to a constant: its mean is zero, and\n"
    "--exact is compared without its mean, in every component. Boundary edges, of volumes faces,\n"
    "without data have flux 0.\n"
    "Expressions know x, y, z, pi, e; + - * / ^; < <= == != >= > && ||; a ? b : c; and sin cos\n"
    "tan asin acos atan atan2 sinh cosh tanh exp ln log10 sqrt abs min max.",
    "  carat poisson plane.ply --rhs \"2*pi^2*sin(pi*x)*sin(pi*y)\" --dirichlet 0 \\\n"
    "        --exact \"sin(pi*x)*sin(pi*y)\"\n"
    "  carat poisson sphere.ply --rhs \"12*y*(4*z^2-x^2-y^2)\" -o solution.html\n"
    "  carat poisson plane.ply --rhs 0 --dirichlet 1 --dirichlet-where \"x<1e-9\" --neumann 2 \\\n"
    "        --coefficient \"1+x\" -o solution.vtp\n"
    "  carat poisson plane.ply --rhs 1 --robin 3 --neumann \"cos(y)\" --json\n"
    "  carat poisson cube.vtu --rhs \"3*pi^2*sin(pi*x)*sin(pi*y)*sin(pi*z)\" --dirichlet 0 -o "
    "u.vtu\n"
    "  carat poisson case --rhs 0 --dirichlet inlet=1 --dirichlet outlet=0 -o potential.html\n"
    "  carat poisson rock.vtu --rhs 0 --dirichlet z --coefficient-field permeability -o head.vtu\n",
    true,
    declare};

}  // namespace carat::cli
