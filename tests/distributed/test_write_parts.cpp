#include <cstring>

#include "carat/distributed/read_parts.h"
#include "carat/distributed/write_parts.h"
#include "io/io_support.h"
#include "parts.h"
#include "support/same_parts.h"

namespace carat::test {
namespace {

/// A folder of the first process, which all see.
class CommonFolder {
 public:
  CommonFolder() {
    char name[256] = {};
    if (rank() == 0) {
      folder_ = std::make_unique<TemporaryFolder>();
      std::strncpy(name, folder_->path().c_str(), sizeof name - 1);
    }
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name;
  }
  ~CommonFolder() { MPI_Barrier(MPI_COMM_WORLD); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::vector<std::string> files() const {
    MPI_Barrier(MPI_COMM_WORLD);
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    MPI_Barrier(MPI_COMM_WORLD);
    return names;
  }

 private:
  std::unique_ptr<TemporaryFolder> folder_;
  std::filesystem::path path_;
};

Field numbers_field(const std::string& name, const Array<Index>& numbers) {
  Field field{name, 2, {}};
  for (const Index number : numbers) {
    field.values.push_back(number + 0.25);
    field.values.push_back(-number);
  }
  return field;
}

void expect_same_mesh(const MeshPart<PolygonMesh>& a, const MeshPart<PolygonMesh>& b) {
  expect_same(a, b);
}

/// Which face of a cell comes first is not in a file.
void expect_same_mesh(const MeshPart<PolyhedralMesh>& a, const MeshPart<PolyhedralMesh>& b) {
  EXPECT_EQ(a.numbers.vertices, b.numbers.vertices);
  EXPECT_EQ(a.numbers.elements, b.numbers.elements);
  EXPECT_EQ(a.numbers.own_elements, b.numbers.own_elements);
  EXPECT_EQ(a.numbers.vertex_rows, b.numbers.vertex_rows);
  expect_same(a.mesh.points(), b.mesh.points());
  ASSERT_EQ(a.mesh.n_faces(), b.mesh.n_faces());
  for (Index c = 0; c < a.mesh.n_cells(); ++c) {
    const auto sorted = [&](const PolyhedralMesh& mesh) {
      const auto row = mesh.cell_vertices().row(c);
      std::vector<Index> vertices(row.begin(), row.end());
      std::sort(vertices.begin(), vertices.end());
      return vertices;
    };
    EXPECT_EQ(sorted(a.mesh), sorted(b.mesh));
  }
}

template <class Mesh>
void check(const MeshPart<Mesh>& part, const std::string& extension) {
  const CommonFolder folder;
  MeshFields fields;
  fields.vertex = {numbers_field("v", part.numbers.vertices)};
  std::vector<Field>& of_elements = std::is_same_v<Mesh, PolygonMesh> ? fields.face : fields.cell;
  of_elements = {numbers_field("e", part.numbers.elements)};
  write_parts(folder / ("u" + extension), part, fields);
  std::vector<std::string> expected{"u" + extension};
  for (int p = 0; p < n_processes(); ++p)
    expected.push_back("u_" + std::to_string(p) + "." + extension.substr(2));
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(folder.files(), expected);

  const auto read = std::get<PartData<Mesh>>(read_parts(folder / ("u" + extension)));
  expect_same_mesh(read.part, part);
  expect_same(read.fields.vertex, fields.vertex);
  const std::vector<Field>& read_elements =
      std::is_same_v<Mesh, PolygonMesh> ? read.fields.face : read.fields.cell;
  ASSERT_EQ(read_elements.size(), 2u);
  EXPECT_EQ(read_elements[1].name, "part");
  expect_same({read_elements[0]}, of_elements);
  for (std::size_t e = 0; e < part.numbers.elements.size(); ++e)
    if (part.numbers.own_elements[e]) {
      EXPECT_EQ(read_elements[1].values[e], rank());
    }
}

TEST(WriteParts, read_back_as_the_same_parts) {
  EXPECT_TRUE(is_parallel_index("a/u.pvtu"));
  EXPECT_FALSE(is_parallel_index("a/u.vtu"));
  const PolygonMesh surface = generate_mesh("plane-concave", {.level = 1});
  check(own_part(surface, scattered(surface.n_faces(), n_processes())), ".pvtp");
  check(own_block(surface), ".pvtu");
  const PolygonMesh loose = two_components_with_loose_vertices();
  check(own_part(loose, in_blocks(loose.n_faces(), n_processes())), ".pvtp");
  // Cells name the faces in the order in which a VTU file does.
  const CommonFolder folder;
  if (rank() == 0) write_volume(folder / "ball.vtu", generate_volume("ball-voronoi", {.level = 0}));
  MPI_Barrier(MPI_COMM_WORLD);
  const PolyhedralMesh ball = read_volume(folder / "ball.vtu").mesh;
  check(own_part(ball, scattered(ball.n_cells(), n_processes())), ".pvtu");
}

TEST(WriteParts, a_failure_of_one_process_leaves_nothing) {
  const PolygonMesh mesh = quad_grid(3, 3);
  const auto part = own_block(mesh);
  const CommonFolder folder;
  write_parts(folder / "u.pvtp", part, {});
  const std::vector<std::string> before = folder.files();
  MeshFields fields;  // the last process has one name twice
  fields.vertex = {numbers_field("v", part.numbers.vertices)};
  if (rank() + 1 == n_processes()) fields.vertex.push_back(fields.vertex[0]);
  EXPECT_THROW(write_parts(folder / "u.pvtp", part, fields), Shared<InvalidOption>);
  EXPECT_THROW(write_parts(folder / "none" / "u.pvtp", part, {}), Shared<IoError>);
  const auto cube = own_block(generate_volume("cube-hexahedra", {.level = 0}));
  EXPECT_THROW(write_parts(folder / "v.pvtp", cube, {}), Shared<InvalidOption>);
  EXPECT_EQ(folder.files(), before);
  if (rank() == 0) std::filesystem::create_directory(folder / "w_0.vtp");
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(write_parts(folder / "w.pvtp", part, {}), Shared<IoError>);
  EXPECT_EQ(folder.files().size(), before.size() + 1);
}

}  // namespace
}  // namespace carat::test
