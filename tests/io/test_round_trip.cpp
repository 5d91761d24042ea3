// What is written comes back bit by bit.

#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "io_support.h"

namespace carat::test {
namespace {

class RoundTrip : public testing::TestWithParam<FileFormat> {
 protected:
  std::filesystem::path path() const { return folder_ / ("mesh" + GetParam().extensions.front()); }
  TemporaryFolder folder_;
};

TEST_P(RoundTrip, KeepsEveryBitOfMeshAndFields) {
  write_surface(path(), awkward_mesh(), awkward_fields());
  const SurfaceData read = read_surface(path());
  expect_same_mesh(read.mesh, awkward_mesh());
  if (GetParam().fields) {
    expect_same_fields(read.fields.vertex, awkward_fields().vertex);
    expect_same_fields(read.fields.face, awkward_fields().face);
  } else {
    EXPECT_TRUE(read.fields.vertex.empty() && read.fields.face.empty());
  }
  EXPECT_EQ(folder_.n_files(), 1u);
}

TEST_P(RoundTrip, IsFoundByContentUnderAnyName) {
  write_surface(path(), awkward_mesh());
  for (const char* name : {"mesh.dat", "noextension", "wrong.obj", "wrong.ply", "wrong.stl"}) {
    std::filesystem::copy_file(path(), folder_ / name,
                               std::filesystem::copy_options::overwrite_existing);
    expect_same_mesh(read_surface(folder_ / name).mesh, awkward_mesh());
  }
}

TEST_P(RoundTrip, KeepsVerticesWithoutFaces) {
  Points points(2, 3);
  points << 1, 2, 3, 4, 5, 6;
  const PolygonMesh cloud(points, {});
  write_surface(path(), cloud);
  expect_same_mesh(read_surface(path()).mesh, cloud);
}

TEST_P(RoundTrip, KeepsAFaceOfThousandVertices) {
  Points points = Points::Random(1000, 3);
  std::vector<Index> face(1000);
  for (Index i = 0; i < 1000; ++i) face[static_cast<std::size_t>(i)] = i;
  const PolygonMesh mesh = PolygonMesh::from_faces(points, {face, {2, 1, 0}});
  write_surface(path(), mesh);
  expect_same_mesh(read_surface(path()).mesh, mesh);
}

TEST_P(RoundTrip, ReplacesAnExistingFile) {
  write_bytes(path(), "old content");
  write_surface(path(), awkward_mesh());
  expect_same_mesh(read_surface(path()).mesh, awkward_mesh());
}

TEST_P(RoundTrip, RefusesFieldsThatDoNotFitAndKeepsTheOldFile) {
  write_bytes(path(), "old content");
  const std::vector<Field> bad = {
      {"short", 1, {1, 2, 3}}, {"", 1, std::vector<double>(8)}, {"none", 0, {}}};
  for (const Field& field : bad)
    EXPECT_THROW(write_surface(path(), awkward_mesh(), {{field}, {}}), InvalidOption) << field.name;
  const Field twice{"u", 1, std::vector<double>(8)};
  EXPECT_THROW(write_surface(path(), awkward_mesh(), {{twice, twice}, {}}), InvalidOption);
  EXPECT_EQ(read_bytes(path()), "old content");
  EXPECT_EQ(folder_.n_files(), 1u);
}

std::vector<FileFormat> writable_formats() {
  std::vector<FileFormat> formats;
  for (const FileFormat& format : file_formats())
    if (format.writes) formats.push_back(format);
  return formats;
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, testing::ValuesIn(writable_formats()),
                         [](const auto& test) { return test.param.name; });

TEST(Formats, HaveTheirAbilities) {
  std::string table;
  for (const FileFormat& format : file_formats())
    table += format.name + (format.reads ? "r" : "") + (format.writes ? "w" : "") +
             (format.reads_volumes ? "R" : "") + (format.writes_volumes ? "W" : "") +
             (format.fields ? "f" : "") + " ";
  EXPECT_EQ(table,
            "plyrwf offrw stlr vtkrRf pvturRf vtprwf vturwRWf ovmrRWf openfoamR meditrRf gmshrRf "
            "objrw ");
}

TEST(Formats, KeepNonFiniteFieldValues) {
  const TemporaryFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Field field{"u", 1, {nan, infinity, -infinity, 0, 1, 2, 3, 4}};
  for (const char* name : {"a.ply", "a.vtp", "a.vtu"}) {
    write_surface(folder / name, awkward_mesh(), {{field}, {}});
    expect_same_fields(read_surface(folder / name).fields.vertex, {field});
  }
}

TEST(Formats, ReplaceWhatANameCannotHold) {
  const TemporaryFolder folder;
  const Field field{"a <b> \"c\" & d", 1, std::vector<double>(8, 2.0)};
  const Field alike{"a >b> \"c\" & d", 1, std::vector<double>(8, 3.0)};
  for (const char* name : {"a.vtp", "a.vtu"}) {
    write_surface(folder / name, awkward_mesh(), {{field, alike}, {}});
    expect_same_fields(read_surface(folder / name).fields.vertex,
                       {{"a _b_ _c_ _ d", 1, field.values}, {"a _b_ _c_ _ d_", 1, alike.values}});
  }
  // A PLY name has no blanks and is no coordinate.
  const Field x{"x", 1, std::vector<double>(8, 3.0)};
  write_surface(folder / "a.ply", awkward_mesh(), {{field, x}, {}});
  const SurfaceData read = read_surface(folder / "a.ply");
  ASSERT_EQ(read.fields.vertex.size(), 2u);
  EXPECT_EQ(read.fields.vertex[0].name, "a_<b>_\"c\"_&_d");
  EXPECT_EQ(read.fields.vertex[1].name, "x_");
  EXPECT_EQ(read.fields.vertex[1].values, x.values);
  expect_same_mesh(read.mesh, awkward_mesh());
}

TEST(Formats, RefuseToWriteWhatTheyCannot) {
  const TemporaryFolder folder;
  for (const char* name : {"a.stl", "a.vtk", "a.xyz", "a"})
    EXPECT_THROW(write_surface(folder / name, awkward_mesh()), IoError) << name;
  EXPECT_THROW(write_surface(folder / "no/such/folder.obj", awkward_mesh()), IoError);
  EXPECT_EQ(folder.n_files(), 0u);
}

TEST(BufferedWriter, ReportsAFullDisk) {
  detail::BufferedWriter out("/dev/full");
  out.put("text").put(1.5);
  EXPECT_THROW(out.close(), IoError);
}

TEST(BufferedWriter, WritesTextLargerThanItsBuffer) {
  const TemporaryFolder folder;
  const std::string large(3u << 20, 'x');
  detail::BufferedWriter out(folder / "a");
  std::string expected;
  for (int i = 0; i < 200000; ++i) {
    out.put(i).put(' ').put(0.1 * i).put('\n');
  }
  out.put(large).put(-7);
  out.close();
  const std::string written = read_bytes(folder / "a");
  EXPECT_TRUE(written.starts_with("0 0\n1 0.1\n2 0.2\n3 0.30000000000000004\n"));
  EXPECT_TRUE(written.ends_with(large + "-7"));
  EXPECT_EQ(std::count(written.begin(), written.end(), '\n'), 200000);
}

}  // namespace
}  // namespace carat::test
