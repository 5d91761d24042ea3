#include <memory>
#include <string>

#include "arrays.h"
#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/mean_curvature.h"
#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "modules.h"
#include "options.h"
#include "run.h"

namespace carat::python {
namespace {

py::dict info_dict(const SolverInfo& info) {
  py::dict dict;
  dict["kind"] = solver_kind_name(info.kind);
  dict["method"] = info.method;
  dict["reason"] = info.reason;
  dict["ordering"] = info.ordering;
  dict["nonzeros"] = info.nonzeros;
  dict["assembled"] = info.assembled;
  dict["setup_seconds"] = info.seconds;
  return dict;
}

// --- geodesics ---------------------------------------------------------------------------------

using Geodesics = std::shared_ptr<HeatGeodesics>;

template <class Mesh>
void define_geodesics(py::module_& module) {
  module.def("heat_geodesics", [](const std::shared_ptr<Mesh>& mesh, const py::dict& arguments,
                                  double t_coef, bool mean_edge, bool of_elements,
                                  const std::string& solver, Index right_hand_sides) {
    OperatorRequest wanted = request(*mesh, OperatorArguments::from(arguments));
    wanted.options.parts =
        of_elements ? DiscretizationParts::Frames : DiscretizationParts::Gradient;
    const HeatGeodesicsOptions options{
        t_coef,
        mean_edge ? TimeStepLength::MeanEdge : TimeStepLength::MaxEdge,
        of_elements ? HeatDirections::Elements : HeatDirections::Samples,
        {.kind = solver_kind(solver),
         .right_hand_sides = right_hand_sides,
         .threads = wanted.options.threads}};
    return run([=](Job&) {
      return std::make_shared<HeatGeodesics>(*mesh, discretize(*mesh, wanted.name, wanted.options),
                                             options);
    });
  });
}

std::vector<GeodesicSource> source_set(const In<Index>& vertices, const In<double>& weights) {
  std::vector<GeodesicSource> sources;
  for (py::ssize_t i = 0; i < vertices.size(); ++i)
    sources.push_back({vertices.data()[i], weights.size() == 0 ? 1 : weights.data()[i]});
  return sources;
}

/// (values, unresolved samples).
py::tuple distance(const Geodesics& geodesics, const In<Index>& vertices,
                   const In<double>& weights) {
  const auto sources = source_set(vertices, weights);
  GeodesicDistance result = run([=](Job&) { return geodesics->distance(sources); });
  return py::make_tuple(moved_vector(std::move(result.values)), result.unresolved_samples);
}

/// (sets, vertices) array and the number of unresolved samples over all sets.
py::tuple distances(const Geodesics& geodesics, const std::vector<In<Index>>& sets,
                    const py::object& progress) {
  std::vector<std::vector<GeodesicSource>> sources;
  for (const In<Index>& set : sets) sources.push_back(source_set(set, In<double>()));
  const Index n = geodesics->discretization().n_vertices();
  struct Result {
    std::shared_ptr<Array<double>> values;
    std::int64_t unresolved = 0;
  };
  const auto n_sets = static_cast<py::ssize_t>(sets.size());
  const Result result = run(
      [=](Job& job) {
        Result all{std::make_shared<Array<double>>()};
        all.values->resize(sources.size() * static_cast<std::size_t>(n));
        geodesics->distances(sources, [&](Index set, GeodesicDistance&& one) {
          std::copy_n(one.values.data(), n,
                      all.values->data() + static_cast<std::ptrdiff_t>(set) * n);
          all.unresolved += one.unresolved_samples;
          job.progress = set + 1;
          return !job.stop;
        });
        throw_if_interrupted();
        return all;
      },
      progress);
  return py::make_tuple(array_over(result.values, result.values->data(), {n_sets, n}),
                        result.unresolved);
}

// --- Poisson -----------------------------------------------------------------------------------

BoundaryConditions to_conditions(const py::dict& given) {
  const auto ids = [&](const char* key) { return to_list(given[key].cast<In<Index>>()); };
  const auto values = [&](const char* key) { return to_list(given[key].cast<In<double>>()); };
  BoundaryConditions conditions{.dirichlet_vertices = ids("dirichlet_vertices"),
                                .dirichlet_values = values("dirichlet_values"),
                                .neumann_sides = ids("neumann_sides"),
                                .neumann_flux = values("neumann_flux"),
                                .robin_sides = ids("robin_sides"),
                                .robin_alpha = values("robin_alpha"),
                                .robin_g = values("robin_g")};
  if (const py::object function = given["dirichlet_function"]; !function.is_none())
    conditions.dirichlet_function = one_by_one(function, "dirichlet");
  return conditions;
}

/// A discretization with the mesh that it was made for, and one set of conditions.
template <class Mesh>
struct PoissonProblem {
  std::shared_ptr<Mesh> mesh;
  std::shared_ptr<const Discretization> discretization;
  std::shared_ptr<const Poisson> poisson;
};

template <class Mesh>
void define_poisson(py::module_& module, const char* name) {
  using Problem = PoissonProblem<Mesh>;
  py::class_<Problem, std::shared_ptr<Problem>>(module, name)
      .def("with_data",
           [](const Problem& problem, const py::dict& given) {
             const BoundaryConditions conditions = to_conditions(given);
             return run([=](Job&) {
               return std::make_shared<Problem>(
                   Problem{problem.mesh, problem.discretization,
                           std::make_shared<Poisson>(
                               problem.poisson->with_data(*problem.mesh, conditions))});
             });
           })
      .def("solve", [](const Problem& problem, const In<double>& f, bool integrated) {
        PoissonSolution solution = run([problem, integrated, f = to_vector(f)](Job&) {
          return integrated ? problem.poisson->solve_integrated(f) : problem.poisson->solve(f);
        });
        py::dict report = info_dict(problem.poisson->solver());
        report["method"] = solution.solve.method;
        report["iterations"] = solution.solve.iterations;
        report["residual"] = solution.relative_residual;
        report["floating_components"] = solution.floating_components;
        report["imbalance"] = solution.imbalance;
        return py::make_tuple(moved_vector(std::move(solution.values)), report);
      });
  // In the form in which the solver takes it.
  module.def("discretize_for_poisson", [](const std::shared_ptr<Mesh>& mesh,
                                          const py::dict& arguments, const std::string& solver) {
    OperatorRequest wanted = request(*mesh, OperatorArguments::from(arguments));
    wanted.options.parts = DiscretizationParts::Matrices;
    wanted.options.form = poisson_form(
        *mesh, wanted.name, {.kind = solver_kind(solver), .threads = wanted.options.threads});
    return run([mesh, wanted](Job&) {
      return std::make_shared<Discretization>(discretize(*mesh, wanted.name, wanted.options));
    });
  });
  module.def(
      "poisson",
      [](const std::shared_ptr<Mesh>& mesh, const std::shared_ptr<Discretization>& discretization,
         const py::dict& given, const std::string& solver, Index right_hand_sides) {
        const BoundaryConditions conditions = to_conditions(given);
        const SolverOptions options{.kind = solver_kind(solver),
                                    .right_hand_sides = right_hand_sides,
                                    .threads = discretization->options.threads};
        return run([=](Job&) {
          const std::shared_ptr<const Discretization> shared = discretization;
          return std::make_shared<Problem>(
              Problem{mesh, shared, std::make_shared<Poisson>(*mesh, shared, conditions, options)});
        });
      });
}

// --- eigenmodes and curvature ------------------------------------------------------------------

template <class Mesh>
void define_eigenmodes(py::module_& module) {
  module.def("eigenmodes", [](const std::shared_ptr<Mesh>& mesh, const py::dict& arguments,
                              Index count, const In<Index>& dirichlet, const std::string& solver,
                              const py::object& progress) {
    OperatorRequest wanted = request(*mesh, OperatorArguments::from(arguments));
    wanted.options.parts = DiscretizationParts::Matrices;
    EigenOptions options{.method = eigen_method(solver),
                         .dimension = dimension(*mesh),
                         .threads = wanted.options.threads};
    const std::vector<Index> fixed = to_list(dirichlet);
    auto pairs = run(
        [=](Job& job) {
          const Discretization d = discretize(*mesh, wanted.name, wanted.options);
          EigenOptions solving = options;
          solving.sparser = sparser_stiffness(*mesh, d);
          solving.progress = [&](Index converged) { job.progress = converged; };
          auto found = std::make_shared<EigenPairs>(eigenmodes(d, count, fixed, solving));
          job.progress = count;
          return found;
        },
        progress);
    py::dict report;
    report["operator"] = wanted.name;
    report["kind"] = eigen_method_name(pairs->method);
    report["method"] = pairs->factor.method;
    report["reason"] = pairs->reason;
    report["ordering"] = pairs->factor.ordering;
    report["iterations"] = pairs->iterations;
    report["solves"] = pairs->solves;
    report["bytes"] = pairs->bytes;
    return py::make_tuple(moved_vector(std::move(pairs->values)),
                          moved_matrix(std::move(pairs->vectors)),
                          moved_vector(std::move(pairs->residuals)), pairs->zero_modes, report);
  });
}

/// (values, undefined vertices).
py::tuple curvature(const Surface& mesh, const py::dict& arguments, bool with_sign) {
  OperatorRequest wanted = request(*mesh, OperatorArguments::from(arguments));
  wanted.options.parts = DiscretizationParts::Matrices;
  MeanCurvature result = run([=](Job&) {
    return mean_curvature(*mesh, discretize(*mesh, wanted.name, wanted.options), with_sign);
  });
  return py::make_tuple(moved_vector(std::move(result.values)),
                        moved_vector(std::move(result.undefined_vertices)));
}

}  // namespace

void define_problems(py::module_& module) {
  py::class_<HeatGeodesics, Geodesics>(module, "HeatGeodesics")
      .def_property_readonly("time_step", &HeatGeodesics::time_step)
      .def_property_readonly(
          "n_vertices",
          [](const HeatGeodesics& geodesics) { return geodesics.discretization().n_vertices(); })
      .def_property_readonly(
          "operator",
          [](const HeatGeodesics& geodesics) { return geodesics.discretization().name; })
      .def("heat_info",
           [](const HeatGeodesics& geodesics) { return info_dict(geodesics.heat_info()); })
      .def("poisson_info",
           [](const HeatGeodesics& geodesics) { return info_dict(geodesics.poisson_info()); })
      .def("diagnostics",
           [](const HeatGeodesics& geodesics) {
             return diagnostics_dict(geodesics.discretization().diagnostics);
           })
      .def("distance", &distance)
      .def("distances", &distances);
  define_geodesics<PolygonMesh>(module);
  define_geodesics<PolyhedralMesh>(module);
  define_poisson<PolygonMesh>(module, "SurfacePoisson");
  define_poisson<PolyhedralMesh>(module, "VolumePoisson");
  define_eigenmodes<PolygonMesh>(module);
  define_eigenmodes<PolyhedralMesh>(module);
  module.def("mean_curvature", &curvature);
}

}  // namespace carat::python
