#include "carat/distributed/poisson.h"
#include "carat/solve/semidefinite_solver.h"
#include "parts.h"

namespace carat::test {
namespace {

/// Conditions of all kinds: Dirichlet data below z or y, fluxes and Robin's on other sides.
template <class Mesh>
BoundaryConditions mixed_conditions(const Mesh& mesh) {
  BoundaryConditions conditions;
  const auto [low, high] =
      std::pair{mesh.points().col(1).minCoeff(), mesh.points().col(1).maxCoeff()};
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (mesh.point(v).y() < low + 0.1 * (high - low)) {
      conditions.dirichlet_vertices.push_back(v);
      conditions.dirichlet_values.push_back(5 + mesh.point(v).x());
    }
  const auto is_side = [&](Index i) {
    if constexpr (std::is_same_v<Mesh, PolygonMesh>)
      return mesh.edges().corners.size(i) == 1;
    else
      return mesh.face_cells()[i].boundary();
  };
  for (Index i = 0; i < n_interfaces(mesh); ++i) {
    if (!is_side(i)) continue;
    if (i % 3 == 0) {
      conditions.neumann_sides.push_back(i);
      conditions.neumann_flux.push_back(0.5 + i % 5);
    } else if (i % 3 == 1) {
      conditions.robin_sides.push_back(i);
      conditions.robin_alpha.push_back(2);
      conditions.robin_g.push_back(1);
    }
  }
  return conditions;
}

template <class Mesh>
Vector wave(const Mesh& mesh) {
  Vector f(mesh.n_vertices());
  for (Index v = 0; v < f.size(); ++v)
    f[v] = 1 + std::sin(4 * mesh.point(v).x()) * std::cos(3 * mesh.point(v).sum());
  return f;
}

bool has_products(const PolygonMesh&, const std::string& name) {
  return surface_operator(name).options.products;
}
bool has_products(const PolyhedralMesh&, const std::string& name) {
  return volume_operator(name).options.products;
}

template <class Mesh>
void check(const Mesh& mesh, const MeshPart<Mesh>& part, const std::string& name,
           DiscretizationOptions options, const BoundaryConditions& conditions,
           const Vector& load) {
  const Discretization whole = discretize(mesh, name, options);
  const PoissonSolution expected =
      Poisson(mesh, whole, conditions, {.kind = SolverKind::Cholesky}).solve(load);
  // Against a function that is no solution; floating components lose its mean.
  Vector reference = wave(mesh);
  if (conditions.dirichlet_vertices.empty()) {
    const SemidefiniteSolver solver(whole.stiffness);
    const Vector mass_of = whole.lumped_mass();
    for (Index c = 0; c < solver.n_components(); ++c) {
      double sum = 0, measure = 0;
      for (Index v = 0; v < reference.size(); ++v)
        if (solver.components()[v] == c) {
          sum += reference[v] * mass_of[v];
          measure += mass_of[v];
        }
      for (Index v = 0; v < reference.size(); ++v)
        if (solver.components()[v] == c) reference[v] -= sum / measure;
    }
  }
  for (const OperatorForm form : {OperatorForm::Matrices, OperatorForm::Products}) {
    const bool products = form == OperatorForm::Products;
    if (products && !has_products(mesh, name)) continue;
    SCOPED_TRACE(products ? "products" : "matrices");
    options.form = form;
    const Discretization own = discretize_part(part, name, options);
    const DistributedPoisson poisson(part, own, select(conditions, part.numbers));
    const PoissonSolution solution = poisson.solve(select(load, part.numbers));
    EXPECT_LT(difference(solution.values, expected.values, part.numbers), 1e-9);
    EXPECT_EQ(solution.floating_components, expected.floating_components);
    EXPECT_NEAR(solution.imbalance, expected.imbalance, 1e-12);
    EXPECT_LT(solution.solve.residual, 1e-10);
    EXPECT_GT(solution.solve.iterations, 0);
    EXPECT_TRUE(products || solution.solve.method.find("matrix-free") == std::string::npos);
    Vector own_reference = select(reference, part.numbers);
    poisson.remove_floating_means(own_reference);
    EXPECT_LT(difference(own_reference, reference, part.numbers), 1e-12);
    const ErrorNorms norms = poisson.norms(solution.values - own_reference),
                     of_whole = error_norms(whole.mass, expected.values, reference);
    EXPECT_NEAR(norms.rmse, of_whole.rmse, 1e-9 * of_whole.rmse);
    EXPECT_NEAR(norms.l2, of_whole.l2, 1e-9 * of_whole.l2);
    EXPECT_NEAR(norms.max, of_whole.max, 1e-9 * of_whole.max);
  }
}

template <class Mesh>
void check_all(const Mesh& mesh) {
  const auto k = [](const Vec3& x) { return 1 + x.squaredNorm(); };
  const std::vector<std::pair<std::string, DiscretizationOptions>> cases = {
      {"diamond", {.coefficient = k}}, {"stabilized_diamond", {}}, {"bunge", {}}};
  for (const auto& [name, options] : cases) {
    SCOPED_TRACE(name);
    const MeshPart<Mesh> block = own_block(mesh);
    check(mesh, block, name, options, mixed_conditions(mesh), wave(mesh));
    // Without data a load that balances.
    Vector load = wave(mesh);
    const Vector mass = discretize(mesh, name, options).lumped_mass();
    load.array() -= load.dot(mass) / mass.sum();
    check(mesh, block, name, options, {}, load);
  }
}

TEST(DistributedPoisson, surfaces_as_in_one_process) {
  for (const char* family : {"plane-triangles", "plane-voronoi", "plane-concave", "sphere-quads"}) {
    SCOPED_TRACE(family);
    check_all(generate_mesh(family, {.level = 2, .jitter = 0.2}));
  }
}

TEST(DistributedPoisson, volumes_as_in_one_process) {
  for (const char* family : {"cube-tets", "cube-hexahedra", "ball-voronoi"}) {
    SCOPED_TRACE(family);
    check_all(generate_volume(family, {.level = 1, .jitter = 0.2}));
  }
}

TEST(DistributedPoisson, elements_of_many_vertices_need_no_matrix) {
  const PolyhedralMesh truncated = generate_volume("cube-truncated", {.level = 1});
  const auto part = own_block(truncated);
  EXPECT_EQ(distributed_poisson_form(part, "diamond"), OperatorForm::Products);
  EXPECT_EQ(distributed_poisson_form(part, "bunge"), OperatorForm::Matrices);
  DiscretizationOptions options;
  options.form = OperatorForm::Products;
  const DistributedPoisson poisson(part, discretize_part(part, "diamond", options));
  Vector load = Vector::Zero(part.mesh.n_vertices());
  for (Index v = 0; v < load.size(); ++v)
    load[v] = std::cos(3.141592653589793 * part.mesh.point(v).x());
  EXPECT_EQ(poisson.solve(load).solve.method.find("matrix-free PETSc"), 0u);
  const PolygonMesh triangles = generate_mesh("plane-triangles", {.level = 1});
  EXPECT_EQ(distributed_poisson_form(own_block(triangles), "diamond"), OperatorForm::Matrices);
}

TEST(DistributedPoisson, any_parts_components_and_loose_vertices) {
  for (const NamedMesh& named : unusual_meshes()) {
    SCOPED_TRACE(named.name);
    const std::vector<Index> parts = scattered(named.mesh.n_faces(), n_processes());
    Vector load = wave(named.mesh);
    const Discretization whole = discretize(named.mesh, "diamond");
    // Balanced in every component.
    const SemidefiniteSolver solver(whole.stiffness);
    const Vector mass = whole.lumped_mass();
    for (Index c = 0; c < solver.n_components(); ++c) {
      double sum = 0, measure = 0;
      for (Index v = 0; v < load.size(); ++v)
        if (solver.components()[v] == c) {
          sum += load[v] * mass[v];
          measure += mass[v];
        }
      for (Index v = 0; v < load.size(); ++v)
        if (solver.components()[v] == c) load[v] -= sum / measure;
    }
    check(named.mesh, own_part(named.mesh, parts), "diamond", {}, {}, load);
  }
}

TEST(DistributedPoisson, all_processes_refuse_bad_data) {
  const PolygonMesh mesh = quad_grid(4, 4);
  const auto part = own_block(mesh);
  const Discretization d = discretize_part(part, "diamond");
  // Only the last process has a bad value.
  BoundaryConditions conditions;
  if (rank() + 1 == n_processes()) {
    conditions.dirichlet_vertices = {0};
    conditions.dirichlet_values = {NAN};
  }
  EXPECT_THROW(DistributedPoisson(part, d, conditions), Shared<InvalidOption>);
  const DistributedPoisson poisson(part, d);
  EXPECT_THROW(poisson.solve(Vector::Ones(part.mesh.n_vertices())), Shared<SolverFailure>);
  Vector bad = Vector::Zero(part.mesh.n_vertices());
  if (rank() == 0) bad[0] = HUGE_VAL;
  EXPECT_THROW(poisson.solve_integrated(bad), Shared<InvalidOption>);
}

}  // namespace
}  // namespace carat::test
