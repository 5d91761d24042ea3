#include "carat/distributed/processes.h"
#include "carat/distributed/scatter.h"
#include "parts.h"
#include "support/same_parts.h"
#include "support/sample_data.h"

namespace carat::test {
namespace {

template <class Mesh>
void check(const Mesh& mesh, const std::vector<Index>& parts) {
  const auto whole = sample_data(mesh);
  const MeshData data = whole;
  // Only the first process has anything to give.
  const AnyPartData got = rank() == 0 ? scatter(&data, parts) : scatter(nullptr, {});
  expect_same(std::get<PartData<Mesh>>(got),
              part_data_of(whole, divide(mesh, n_processes(), parts), rank()));
}

TEST(Scatter, gives_the_parts_with_their_fields_and_patches) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    check(mesh, scattered(mesh.n_faces(), n_processes()));
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    check(mesh, in_blocks(mesh.n_cells(), n_processes()));
  }
}

TEST(Scatter, all_processes_refuse_bad_parts) {
  const MeshData data = SurfaceData{quad_grid(2, 2), {}};
  EXPECT_THROW(scatter(&data, std::vector<Index>{0}), Shared<InvalidOption>);
}

TEST(Gather, brings_own_rows_to_the_first_process) {
  const PolyhedralMesh mesh = generate_volume("ball-voronoi", {.level = 0});
  const auto part = own_part(mesh, scattered(mesh.n_cells(), n_processes()));
  const PartNumbers& numbers = part.numbers;
  Matrix values(part.mesh.n_vertices(), 2), of_cells(part.mesh.n_cells(), 1);
  // What is not own is wrong.
  for (Index v = 0; v < values.rows(); ++v) {
    const double value = numbers.own_vertex(v) ? numbers.vertices[v] : -1;
    values.row(v) << value, 2 * value;
  }
  for (Index c = 0; c < of_cells.rows(); ++c)
    of_cells(c, 0) = numbers.own_elements[static_cast<std::size_t>(c)] ? numbers.elements[c] : -1;
  const Matrix all = gather_vertices(numbers, values),
               all_cells = gather_elements(numbers, of_cells, mesh.n_cells());
  const std::vector<Index> ranks = gather_numbers({Index{n_processes() - rank()}, 7});
  if (rank() > 0) {
    EXPECT_EQ(all.size() + all_cells.size(), 0);
    EXPECT_TRUE(ranks.empty());
    return;
  }
  ASSERT_EQ(all.rows(), mesh.n_vertices());
  ASSERT_EQ(all_cells.rows(), mesh.n_cells());
  for (Index v = 0; v < all.rows(); ++v) EXPECT_TRUE(all(v, 0) == v && all(v, 1) == 2 * v);
  for (Index c = 0; c < all_cells.rows(); ++c) EXPECT_EQ(all_cells(c, 0), c);
  EXPECT_TRUE(std::is_sorted(ranks.begin(), ranks.end()));
  EXPECT_EQ(static_cast<int>(ranks.size()), 2 * n_processes());
}

}  // namespace
}  // namespace carat::test
