// carat poisson: Poisson's equation with expressions for its data.

#include "carat/apps/poisson.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "carat/base/error.h"
#include "carat/mesh/statistics.h"
#include "cli/command.h"
#include "cli/expression.h"
#include "cli/files.h"
#include "cli/operator_options.h"

namespace carat::cli {
namespace {

struct Options {
  std::string input, output;
  std::string rhs;
  std::optional<std::string> dirichlet, dirichlet_where, neumann, robin, coefficient, exact;
  OperatorOptions discretization;
};

/// The expressions that were given, parsed before any work is done.
struct Data {
  Expression rhs;
  std::optional<Expression> dirichlet, dirichlet_where, neumann, robin, coefficient, exact;

  explicit Data(const Options& options) : rhs("--rhs", options.rhs) {
    const auto parse = [](std::optional<Expression>& target, const char* name,
                          const std::optional<std::string>& text) {
      if (text) target.emplace(name, *text);
    };
    parse(dirichlet, "--dirichlet", options.dirichlet);
    parse(dirichlet_where, "--dirichlet-where", options.dirichlet_where);
    parse(neumann, "--neumann", options.neumann);
    parse(robin, "--robin", options.robin);
    parse(coefficient, "--coefficient", options.coefficient);
    parse(exact, "--exact", options.exact);
    if (dirichlet_where && !dirichlet)
      throw InvalidOption("--dirichlet-where says where but not what; add --dirichlet EXPR");
  }
};

void add_dirichlet(const PolygonMesh& mesh, const Data& data, BoundaryConditions& conditions) {
  if (!data.dirichlet) return;
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!on_boundary[static_cast<std::size_t>(v)]) continue;
    if (data.dirichlet_where && (*data.dirichlet_where)(mesh.point(v)) == 0) continue;
    conditions.dirichlet_vertices.push_back(v);
    conditions.dirichlet_values.push_back((*data.dirichlet)(mesh.point(v)));
  }
  if (conditions.dirichlet_vertices.empty())
    throw InvalidOption(data.dirichlet_where
                            ? "--dirichlet-where is 0 at every boundary vertex; leave --dirichlet "
                              "out, or widen it: points are compared as they are, so allow for "
                              "rounding, e.g. \"x < 1e-9\""
                            : "--dirichlet: the mesh is closed, it has no boundary; leave it out");
}

/// Neumann and Robin data on the boundary edges that Dirichlet data do not cover.
void add_fluxes(const PolygonMesh& mesh, const Data& data, BoundaryConditions& conditions) {
  if (!data.neumann && !data.robin) return;
  std::vector<bool> given(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (const Index v : conditions.dirichlet_vertices) given[static_cast<std::size_t>(v)] = true;
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e) {
    const auto [v1, v2] = edges.vertices[static_cast<std::size_t>(e)];
    if (edges.corners.size(e) != 1 ||
        (given[static_cast<std::size_t>(v1)] && given[static_cast<std::size_t>(v2)]))
      continue;
    const Vec3 midpoint = mesh.point(v1) / 2 + mesh.point(v2) / 2;
    const double flux = data.neumann ? (*data.neumann)(midpoint) : 0;
    if (data.robin) {
      conditions.robin_sides.push_back(e);
      conditions.robin_alpha.push_back((*data.robin)(midpoint));
      conditions.robin_g.push_back(flux);
    } else {
      conditions.neumann_sides.push_back(e);
      conditions.neumann_flux.push_back(flux);
    }
  }
  if (conditions.robin_sides.empty() && conditions.neumann_sides.empty())
    throw InvalidOption(
        std::string(data.robin ? "--robin" : "--neumann") + ": no boundary edge is left for it; " +
        (data.dirichlet ? "every one has Dirichlet data at both ends, restrict them with "
                          "--dirichlet-where"
                        : "the mesh is closed, leave it out"));
}

/// Takes the mean by area off the reference in every component whose solution has mean zero.
void remove_floating_means(const PolygonMesh& mesh, const Discretization& discretization,
                           const BoundaryConditions& conditions, Vector& reference) {
  const std::vector<Index> component = matrix_components(discretization.stiffness);
  const Vector area = discretization.lumped_mass();
  const Index n = component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;
  std::vector<bool> anchored(static_cast<std::size_t>(n), false);
  const auto anchor = [&](Index v) {
    if (const Index c = component[static_cast<std::size_t>(v)]; c >= 0)
      anchored[static_cast<std::size_t>(c)] = true;
  };
  for (const Index v : conditions.dirichlet_vertices) anchor(v);
  for (std::size_t k = 0; k < conditions.robin_sides.size(); ++k)
    if (conditions.robin_alpha[k] > 0)
      anchor(mesh.edges().vertices[static_cast<std::size_t>(conditions.robin_sides[k])][0]);

  std::vector<double> sum(anchored.size(), 0), total(anchored.size(), 0);
  const auto for_each_floating = [&](const auto& visit) {
    for (Index v = 0; v < reference.size(); ++v) {
      const Index c = component[static_cast<std::size_t>(v)];
      if (c >= 0 && !anchored[static_cast<std::size_t>(c)]) visit(v, static_cast<std::size_t>(c));
    }
  };
  for_each_floating([&](Index v, std::size_t c) {
    sum[c] += area[v] * reference[v];
    total[c] += area[v];
  });
  for_each_floating([&](Index v, std::size_t c) { reference[v] -= sum[c] / total[c]; });
}

void compare(Session& session, const SurfaceData& data, const Discretization& discretization,
             const BoundaryConditions& conditions, const Expression& exact, const Vector& u,
             std::vector<Field>& fields) {
  Vector reference = exact.at(data.mesh.points());
  remove_floating_means(data.mesh, discretization, conditions, reference);
  // Vertices without a face take no part.
  if (const Finding* const unused = discretization.diagnostics.find("unreferenced_vertices"))
    for (const Index v : unused->elements) reference[v] = u[v];
  const ErrorNorms errors = error_norms(discretization.mass, u, reference);
  session.report()["errors"] = {{"rmse", errors.rmse}, {"l2", errors.l2}, {"max", errors.max}};
  session.say("error against --exact: rmse " + text(errors.rmse) + ", L2 " + text(errors.l2) +
              ", max " + text(errors.max));
  fields.push_back(scalar_field("error", u - reference));
}

void report_solution(Session& session, const PoissonSolution& solution, const FactorInfo& info) {
  Json& report = session.report();
  report["u"] = extremes(solution.values);
  report["relative_residual"] = solution.relative_residual;
  report["floating_components"] = solution.floating_components;
  report["imbalance"] = solution.imbalance;
  report["errors"] = nullptr;
  report["solver"] = {
      {"method", info.method}, {"ordering", info.ordering}, {"factor_nnz", info.nonzeros}};
  session.say("u: " + describe_extremes(solution.values) + ", relative residual " +
              text(solution.relative_residual));
  if (solution.floating_components > 0)
    session.say(count(solution.floating_components, "component") +
                " without Dirichlet or Robin data: mean zero there; imbalance of the data " +
                text(solution.imbalance) + ", subtracted");
}

void run(Session& session, const Options& options) {
  const Data given(options);
  check_output(options.output, Content::MeshFields);
  SurfaceData data = read_input(session, options.input);
  BoundaryConditions conditions;
  add_dirichlet(data.mesh, given, conditions);
  add_fluxes(data.mesh, given, conditions);
  const Vector f = given.rhs.at(data.mesh.points());
  const bool writes = !options.output.empty();
  std::function<double(const Vec3&)> coefficient;
  if (given.coefficient) coefficient = *given.coefficient;
  const Discretization discretization =
      discretize(session, data.mesh, options.discretization,
                 writes ? DiscretizationParts::Frames : DiscretizationParts::Matrices, coefficient);
  const Poisson poisson =
      session.phase("factor", [&] { return Poisson(data.mesh, discretization, conditions); });
  const PoissonSolution solution = session.phase("solve", [&] { return poisson.solve(f); });

  session.report()["sizes"]["dirichlet_vertices"] = conditions.dirichlet_vertices.size();
  session.report()["sizes"]["neumann_edges"] = conditions.neumann_sides.size();
  session.report()["sizes"]["robin_edges"] = conditions.robin_sides.size();
  session.say(
      count(static_cast<std::int64_t>(conditions.dirichlet_vertices.size()), "Dirichlet vertex") +
      ", " + count(static_cast<std::int64_t>(conditions.neumann_sides.size()), "Neumann edge") +
      ", " + count(static_cast<std::int64_t>(conditions.robin_sides.size()), "Robin edge"));
  report_solution(session, solution, poisson.info());
  data.fields.vertex = {scalar_field("u", solution.values)};
  data.fields.face.clear();
  if (given.exact)
    compare(session, data, discretization, conditions, *given.exact, solution.values,
            data.fields.vertex);
  if (!writes) return;
  const Vector gradient = discretization.gradient * solution.values;
  data.fields.vertex.push_back(vector_field("gradient", discretization.vertex_vectors(gradient)));
  data.fields.face = {
      vector_field("gradient", discretization.element_vectors(gradient, data.mesh.n_faces()))};
  write_output(session, options.output, "Poisson", data);
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->input, "The mesh")->required();
  const auto add = [&](const char* name, auto& target, const char* description) {
    return app.add_option(name, target, description)->type_name("EXPR");
  };
  add("--rhs", options->rhs, "f, at the vertices")->required();
  add("--dirichlet", options->dirichlet, "u at the boundary vertices");
  add("--dirichlet-where", options->dirichlet_where,
      "Only at those boundary vertices where this is not 0,\n"
      "e.g. \"x < 0.001\"");
  add("--neumann", options->neumann,
      "Outward flux K du/dn at the midpoints of the other\nboundary edges; without it, 0");
  add("--robin", options->robin,
      "alpha >= 0: K du/dn + alpha u = g on those edges, g given\nby --neumann");
  add("--coefficient", options->coefficient,
      "K > 0, at the centroids of the gradient samples; without\nit, 1");
  add("--exact", options->exact, "Compare u with this and print the error norms");
  app.add_option("-o,--output", options->output,
                 "File for the mesh with the fields u and gradient, and\n"
                 "error with --exact, or a view (.html); without it\n"
                 "nothing is written");
  declare_operator_options(app, options->discretization);
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command poisson_command = {
    "poisson",
    "Solve Poisson's equation -div(K grad u) = f",
    "Without Dirichlet and Robin data u is determined up to a constant: its mean is zero, and\n"
    "--exact is compared without its mean, in every component. Edges without data have flux 0.\n"
    "Expressions know x, y, z, pi, e; + - * / ^; < <= == != >= > && ||; a ? b : c; and sin cos\n"
    "tan asin acos atan atan2 sinh cosh tanh exp ln log10 sqrt abs min max.",
    "  carat poisson plane.ply --rhs \"2*pi^2*sin(pi*x)*sin(pi*y)\" --dirichlet 0 \\\n"
    "        --exact \"sin(pi*x)*sin(pi*y)\"\n"
    "  carat poisson sphere.ply --rhs \"12*y*(4*z^2-x^2-y^2)\" -o solution.html\n"
    "  carat poisson plane.ply --rhs 0 --dirichlet 1 --dirichlet-where \"x<1e-9\" --neumann 2 \\\n"
    "        --coefficient \"1+x\" -o solution.vtp\n"
    "  carat poisson plane.ply --rhs 1 --robin 3 --neumann \"cos(y)\" --json\n",
    true,
    declare};

}  // namespace carat::cli
