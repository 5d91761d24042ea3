#include <gtest/gtest.h>

#include <atomic>

#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/poisson.h"
#include "carat/base/interrupt.h"
#include "carat/base/parallel.h"
#include "carat/operators/registry.h"
#include "support/meshes.h"

namespace carat::test {
namespace {

TEST(Interrupt, stops_what_the_scope_belongs_to) {
  std::atomic<bool> outer{false}, inner{false};
  throw_if_interrupted();
  const Interruptible first(&outer);
  {
    const Interruptible second(&inner);
    inner = true;
    EXPECT_EQ(current_interrupt(), &inner);
    EXPECT_THROW(throw_if_interrupted(), Interrupted);
  }
  EXPECT_EQ(current_interrupt(), &outer);
  throw_if_interrupted();
  outer = true;
  EXPECT_THROW(throw_if_interrupted(), Interrupted);
}

TEST(Interrupt, reaches_the_threads_of_tasks) {
  std::atomic<bool> stop{false};
  const Interruptible scope(&stop);
  std::atomic<int> begun{0};
  EXPECT_THROW(parallel_tasks(1000, 4,
                              [&](Index) {
                                ++begun;
                                stop = true;
                              }),
               Interrupted);
  EXPECT_LE(begun, 4);  // one a thread
}

TEST(Interrupt, ends_assembly_factorisations_and_iterations) {
  const PolygonMesh mesh = quad_grid(12, 12);
  const Discretization d = discretize(mesh);
  const HeatGeodesics geodesics(mesh, d);
  const BoundaryConditions ground{.dirichlet_vertices = {0}, .dirichlet_values = {0}};
  const Poisson iterating(mesh, d, ground, {.kind = SolverKind::Multigrid});
  std::atomic<bool> stop{true};
  const Interruptible scope(&stop);
  EXPECT_THROW(discretize(mesh), Interrupted);
  EXPECT_THROW(Poisson(mesh, d, ground, {.kind = SolverKind::Cholesky}), Interrupted);
  EXPECT_THROW(iterating.solve(Vector::Ones(mesh.n_vertices())), Interrupted);
  EXPECT_THROW(geodesics.distance(0), Interrupted);
  EXPECT_THROW(eigenmodes(d, 3), Interrupted);
  stop = false;
  EXPECT_EQ(geodesics.distance(0).values.size(), mesh.n_vertices());
}

TEST(Interrupt, ends_an_eigenvalue_iteration_on_its_way) {
  const PolygonMesh mesh = quad_grid(40, 40);
  const Discretization d = discretize(mesh);
  std::atomic<bool> stop{false};
  const Interruptible scope(&stop);
  EigenOptions options;
  options.progress = [&](Index) { stop = true; };
  EXPECT_THROW(eigenmodes(d, 60, {}, options), Interrupted);
}

}  // namespace
}  // namespace carat::test
