#include <unistd.h>

#include <filesystem>

#include "carat/distributed/eigenmodes.h"
#include "carat/distributed/processes.h"
#include "parts.h"

namespace carat::test {
namespace {

template <class Mesh>
void check(const Mesh& mesh, const MeshPart<Mesh>& part, const std::string& name, Index count,
           const std::vector<Index>& fixed) {
  const Discretization whole = discretize(mesh, name);
  const EigenPairs expected = eigenmodes(whole, count, fixed);
  BoundaryConditions conditions;
  conditions.dirichlet_vertices = fixed;
  conditions.dirichlet_values.assign(fixed.size(), 0.0);
  const EigenPairs pairs =
      distributed_eigenmodes(part, discretize_part(part, name), count,
                             select(conditions, part.numbers).dirichlet_vertices);
  EXPECT_EQ(pairs.zero_modes, expected.zero_modes);
  ASSERT_EQ(pairs.values.size(), count);
  for (Index k = 0; k < count; ++k) {
    EXPECT_NEAR(pairs.values[k], expected.values[k], 1e-9 * expected.values[count - 1]);
    EXPECT_LT(pairs.residuals[k], 1e-8);
  }
  // M-orthonormal: own rows of M x, where M x is the sum over the parts.
  Matrix vectors = Matrix::Zero(mesh.n_vertices(), count);
  for (Index v = 0; v < part.mesh.n_vertices(); ++v)
    if (part.numbers.own_vertex(v)) vectors.row(part.numbers.vertices[v]) = pairs.vectors.row(v);
  const std::vector<double> all =
      sum_of_all(std::vector<double>(vectors.data(), vectors.data() + vectors.size()));
  vectors = Eigen::Map<const Matrix>(all.data(), vectors.rows(), vectors.cols());
  const Matrix gram = vectors.transpose() * (whole.mass * vectors);
  EXPECT_LT((gram - Matrix::Identity(count, count)).cwiseAbs().maxCoeff(), 1e-8);
  // A value that is alone has one vector, up to the sign, which is settled.
  for (Index k = 1; k + 1 < count; ++k) {
    const double gap = std::min(expected.values[k] - expected.values[k - 1],
                                expected.values[k + 1] - expected.values[k]);
    if (gap <= 0.05 * expected.values[k]) continue;
    EXPECT_LT(difference(pairs.vectors.col(k), expected.vectors.col(k), part.numbers), 1e-7);
  }
}

TEST(DistributedEigenmodes, surfaces_as_in_one_process) {
  // Of the sphere: 1 + 3 + 5 + 7 values in clusters.
  const PolygonMesh sphere = generate_mesh("sphere-hexagons", {.level = 2});
  check(sphere, own_block(sphere), "stabilized_diamond", 16, {});
  const PolygonMesh plane = generate_mesh("plane-quads", {.level = 2, .jitter = 0.2});
  std::vector<Index> fixed;
  for (Index v = 0; v < plane.n_vertices(); ++v)
    if (plane.point(v).x() < 1e-9) fixed.push_back(v);
  check(plane, own_block(plane), "diamond", 8, fixed);
  check(plane, own_block(plane), "bunge", 5, {});
}

TEST(DistributedEigenmodes, volumes_as_in_one_process) {
  // Of the cube: values of multiplicity 1, 3, 3, 1, 3, ...
  const PolyhedralMesh cube = generate_volume("cube-hexahedra", {.level = 1});
  check(cube, own_block(cube), "stabilized_diamond", 9, {});
  const PolyhedralMesh tets = generate_volume("cube-tets", {.level = 1, .jitter = 0.1});
  std::vector<Index> fixed;
  const std::vector<bool> boundary = boundary_vertices(tets);
  for (Index v = 0; v < tets.n_vertices(); ++v)
    if (boundary[v]) fixed.push_back(v);
  check(tets, own_block(tets), "diamond", 4, fixed);
}

TEST(DistributedEigenmodes, every_component_has_a_constant) {
  const PolygonMesh mesh = two_components_with_loose_vertices();
  check(mesh, own_part(mesh, scattered(2, n_processes())), "diamond", 3, {});
}

TEST(DistributedEigenmodes, all_processes_refuse_bad_counts) {
  const PolygonMesh mesh = quad_grid(2, 2);
  const auto part = own_block(mesh);
  const Discretization d = discretize_part(part, "diamond");
  EXPECT_THROW(distributed_eigenmodes(part, d, 0), Shared<InvalidOption>);
  EXPECT_THROW(distributed_eigenmodes(part, d, 10), Shared<InvalidOption>);
}

/// A file of the job, gone before and after.
class Checkpoint {
 public:
  Checkpoint() { remove(); }
  ~Checkpoint() { remove(); }
  std::filesystem::path path() const {
    return std::filesystem::temp_directory_path() /
           ("carat-eigen-" + std::to_string(::getuid()) + "-" + std::to_string(n_processes()));
  }

 private:
  void remove() const {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) std::filesystem::remove(path());
    MPI_Barrier(MPI_COMM_WORLD);
  }
};

TEST(DistributedEigenmodes, goes_on_from_a_checkpoint) {
  const Checkpoint file;
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 2, .jitter = 0.2});
  const EigenPairs expected = eigenmodes(discretize(mesh, "diamond"), 40);
  const auto solve = [&](const MeshPart<PolygonMesh>& part, Index count) {
    Index found = 0;
    const EigenPairs pairs =
        distributed_eigenmodes(part, discretize_part(part, "diamond"), count, {}, file.path(),
                               [&](Index so_far) { found = std::max(found, so_far); });
    // At the latest where the last solver starts, all but its pairs are found.
    EXPECT_LE(found, 40);
    EXPECT_TRUE(count != 30 || found >= 25);
    for (Index k = 0; k < count; ++k) {
      EXPECT_NEAR(pairs.values[k], expected.values[k], 1e-9 * expected.values[39]);
      EXPECT_LT(pairs.residuals[k], 1e-8);
    }
    return pairs;
  };
  const Index begun = solve(own_block(mesh), 30).iterations;
  const auto size = std::filesystem::file_size(file.path());
  // Other processes have the vertices when it goes on.
  const MeshPart<PolygonMesh> other = own_part(mesh, scattered(mesh.n_faces(), n_processes()));
  EXPECT_LT(solve(other, 40).iterations, begun);
  EXPECT_GT(std::filesystem::file_size(file.path()), size);
  // Nothing is left to find, but for what shows that nothing is missing.
  EXPECT_LT(solve(own_block(mesh), 40).iterations, begun / 4);
  EXPECT_LT(solve(own_block(mesh), 3).iterations, begun / 4);
}

TEST(DistributedEigenmodes, refuses_checkpoints_of_other_problems_and_damaged_ones) {
  const Checkpoint file;
  const PolygonMesh mesh = generate_mesh("plane-quads", {.level = 1});
  const auto solve = [&](const PolygonMesh& of, const std::filesystem::path& path) {
    const auto part = own_block(of);
    distributed_eigenmodes(part, discretize_part(part, "diamond"), 5, {}, path);
  };
  solve(mesh, file.path());
  solve(mesh, file.path());
  const PolygonMesh other = generate_mesh("plane-quads", {.level = 1, .jitter = 0.2});
  ASSERT_EQ(other.n_vertices(), mesh.n_vertices());
  EXPECT_THROW(solve(other, file.path()), Shared<InvalidOption>);
  EXPECT_THROW(solve(generate_mesh("plane-quads", {.level = 2}), file.path()), Shared<IoError>);
  EXPECT_THROW(solve(mesh, file.path() / "in" / "none"), Shared<IoError>);
  for (const int less : {1, 4000}) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0)
      std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) - less);
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_THROW(solve(mesh, file.path()), Shared<IoError>);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) std::filesystem::resize_file(file.path(), 5);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(solve(mesh, file.path()), Shared<IoError>);
}

}  // namespace
}  // namespace carat::test
