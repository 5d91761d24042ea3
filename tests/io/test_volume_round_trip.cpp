// Volumes that are written come back.

#include "carat/base/error.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

class VolumeRoundTrip : public testing::TestWithParam<FileFormat> {
 protected:
  std::filesystem::path path() const { return folder_ / ("mesh" + GetParam().extensions.front()); }
  TemporaryFolder folder_;
};

TEST_P(VolumeRoundTrip, KeepsVerticesCellsAndFields) {
  write_volume(path(), mixed_mesh(), mixed_fields());
  const VolumeData read = read_volume(path());
  expect_same_cells(read.mesh, mixed_mesh());
  expect_same_fields(read.fields.vertex, mixed_fields().vertex);
  expect_same_fields(read.fields.cell, mixed_fields().cell);
  EXPECT_TRUE(read.mesh.repairs().turned_cells.empty());
  EXPECT_EQ(folder_.n_files(), 1u);
}

TEST_P(VolumeRoundTrip, GivesTheSameFileAgain) {
  write_volume(path(), mixed_mesh(), mixed_fields());
  const VolumeData once = read_volume(path());
  write_volume(path(), once.mesh, once.fields, once.patches);
  const VolumeData twice = read_volume(path());
  expect_same_cells(twice.mesh, once.mesh);
  expect_same_fields(twice.fields.cell, once.fields.cell);
}

TEST_P(VolumeRoundTrip, IsFoundByContentUnderAnyName) {
  write_volume(path(), mixed_mesh());
  for (const char* name : {"mesh.dat", "noextension", "wrong.obj", "wrong.mesh", "wrong.vtk"}) {
    std::filesystem::copy_file(path(), folder_ / name);
    EXPECT_EQ(read_volume(folder_ / name).mesh.n_cells(), 5) << name;
  }
}

TEST_P(VolumeRoundTrip, RefusesWhatDoesNotFitAndKeepsTheOldFile) {
  write_bytes(path(), "old content");
  const Field field{"short", 1, {1, 2, 3}};
  EXPECT_THROW(write_volume(path(), mixed_mesh(), {{field}, {}, {}}), InvalidOption);
  EXPECT_THROW(write_volume(path(), mixed_mesh(), {{}, {}, {field}}), InvalidOption);
  EXPECT_THROW(write_volume(path(), mixed_mesh(), {}, {{"far", "", {1000}}}), InvalidOption);
  EXPECT_EQ(read_bytes(path()), "old content");
  EXPECT_EQ(folder_.n_files(), 1u);
}

std::vector<FileFormat> volume_formats() {
  std::vector<FileFormat> formats;
  for (const FileFormat& format : file_formats())
    if (format.writes_volumes) formats.push_back(format);
  return formats;
}

INSTANTIATE_TEST_SUITE_P(Formats, VolumeRoundTrip, testing::ValuesIn(volume_formats()),
                         [](const auto& test) { return test.param.name; });

TEST(WriteOvm, KeepsFacesNumbersPatchesAndNames) {
  const TemporaryFolder folder;
  const PolyhedralMesh mesh = mixed_mesh();
  std::vector<BoundaryPatch> patches = {{"in \"let\"", "patch", {}}, {"wall", "", {}}};
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[static_cast<std::size_t>(f)].boundary())
      patches[f % 3 == 0 ? 0 : 1].faces.push_back(f);
  write_volume(folder / "a.ovm", mesh, mixed_fields(), patches);
  const VolumeData read = read_volume(folder / "a.ovm");
  EXPECT_EQ(faces_of(read.mesh.face_mesh()), faces_of(mesh.face_mesh()));
  EXPECT_EQ(read.mesh.cells().indices, mesh.cells().indices);
  ASSERT_EQ(read.patches.size(), 2u);
  EXPECT_EQ(read.patches[0].name, "in _let_");
  EXPECT_EQ(read.patches[0].faces, patches[0].faces);
  EXPECT_EQ(read.patches[1].faces, patches[1].faces);
}

/// Other readers of OVM take the halffaces of a cell as pointing inwards.
TEST(WriteOvm, NamesHalffacesThatPointInwards) {
  const TemporaryFolder folder;
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const PolyhedralMesh mesh(
      points,
      [] {
        Csr faces;
        faces.offsets = {0, 3, 6, 9, 12};
        faces.indices = {0, 2, 1, 0, 3, 1, 1, 2, 3, 2, 0, 3};  // the second one points inwards
        return faces;
      }(),
      [] {
        Csr cells;
        cells.offsets = {0, 4};
        cells.indices = {0, 1, 2, 3};
        return cells;
      }());
  write_volume(folder / "a.ovm", mesh);
  const std::string written = read_bytes(folder / "a.ovm");
  EXPECT_TRUE(written.ends_with("Polyhedra\n1\n4 1 2 5 7\n")) << written;
}

/// Only polyhedra need lists of their faces.
TEST(WriteVtu, GivesStandardCellsTheirTypes) {
  const TemporaryFolder folder;
  CellCollector cells;
  for (const auto& [type, vertices] : std::vector<std::pair<CellType, std::vector<Index>>>{
           {CellType::Hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}},
           {CellType::Wedge, {1, 8, 2, 5, 9, 6}},
           {CellType::Pyramid, {4, 5, 6, 7, 10}},
           {CellType::Tetrahedron, {5, 6, 10, 11}}})
    cells.add(type, vertices);
  write_volume(folder / "standard.vtu", std::move(cells).build(mixed_points()));
  EXPECT_EQ(read_bytes(folder / "standard.vtu").find("faceoffsets"), std::string::npos);
  write_volume(folder / "mixed.vtu", mixed_mesh());
  EXPECT_NE(read_bytes(folder / "mixed.vtu").find("faceoffsets"), std::string::npos);
}

TEST(VolumeFormats, RefuseToWriteWhatTheyCannot) {
  const TemporaryFolder folder;
  for (const char* name : {"a.obj", "a.vtk", "a.msh", "a.mesh", "a.foam", "a.xyz", "a"})
    EXPECT_THROW(write_volume(folder / name, mixed_mesh()), IoError) << name;
  EXPECT_THROW(write_surface(folder / "a.ovm", awkward_mesh()), IoError);
  EXPECT_EQ(folder.n_files(), 0u);
}

}  // namespace
}  // namespace carat::test
