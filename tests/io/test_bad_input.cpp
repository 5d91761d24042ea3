// Files that are no mesh: one clear error with path, place and remedy; nothing printed, no crash.

#include <random>

#include "carat/base/error.h"
#include "io_support.h"
#include "sample_files.h"

namespace carat::test {
namespace {

struct BadFile {
  std::string name;  ///< of the test
  std::string file;
  std::string content;
  std::vector<std::string> message;  ///< parts that the message must have, in this order
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string vtk(const std::string& body, const std::string& encoding = "ASCII") {
  return "# vtk DataFile Version 3.0\nt\n" + encoding + std::string("\n") + body;
}

/// A compressed VTP file whose first array announces other blocks than it has.
std::string with_block_header(std::uint32_t n, std::uint32_t size, std::uint32_t last) {
  for (const SampleFile& sample : sample_files()) {
    if (sample.name != "vtp_appended") continue;
    std::string content = sample.content;
    const std::size_t start = content.find('_', content.find("<AppendedData")) + 1;
    const std::string header = Bytes(std::endian::native).add(n).add(size).add(last).str();
    return content.replace(start, header.size(), header);
  }
  throw std::out_of_range("vtp_appended");
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kHuge = "1000000000000";

std::vector<BadFile> bad_files() {
  const std::string ply = ply_header("ascii") + "0 0 0 0\n1 0 0 50\n0 1 0 100\n1 1 0 150\n";
  const std::string vtk_points = "DATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n";
  const std::string grid_points =
      "DATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
      "0 0 0 1 0 0 0 1 0 0 0 1\n";
  const auto stl = [](std::uint32_t n) {
    std::string content = binary_stl();
    std::memcpy(content.data() + 80, &n, 4);
    return content;
  };
  return {
      {"empty", "a.obj", "", {"empty"}},
      {"unknown", "a.xyz", "0 0 0\n1 1 1\n", {"'.xyz'", "known are", ".obj"}},
      {"garbage_obj", "a.obj", "\x89PNG\r\n\x1a\n", {"no vertices"}},
      {"garbage_off", "a.off", "\x89PNG\r\n\x1a\n", {"line 1", "OFF"}},
      {"garbage_ply", "a.ply", "plyyy\nnothing", {"line 2", "header"}},
      {"garbage_stl", "a.stl", "some text", {"no STL file"}},
      {"garbage_vtk", "a.vtk", "some text", {"# vtk DataFile"}},
      {"garbage_vtp", "a.vtp", "some text", {"VTKFile"}},
      {"garbage_vtu", "a.vtu", "some text", {"VTKFile"}},
      // Numbers
      {"obj_nan", "a.obj", "v 0 0 0\nv nan 0 0\n", {"line 2", "nan", "finite"}},
      {"obj_inf", "a.obj", "v 0 0 0\nv 1 1e999 0\n", {"line 2", "inf", "finite"}},
      {"obj_word", "a.obj", "v 0 0 0\nv garbage 0 0\n", {"line 2", "'garbage'"}},
      {"obj_trailing", "a.obj", "v 0 0 0x\n", {"line 1", "'0x'"}},
      {"obj_missing", "a.obj", "v 0 0\nv 1 1 1\n", {"line 1", "missing"}},
      {"off_nan", "a.off", "OFF\n3 1 0\n0 0 0\n0 nan 0\n1 1 1\n3 0 1 2\n", {"line 4", "nan"}},
      {"ply_nan", "a.ply", replaced(ply, "1 0 0", "1 nan 0"), {"vertex 1", "y is nan"}},
      {"stl_nan", "a.stl", "solid\nfacet\nvertex 0 nan 0\n", {"line 3", "nan"}},
      {"vtk_nan",
       "a.vtk",
       vtk("DATASET POLYDATA\nPOINTS 1 double\n0 nan 0\n"),
       {"vertex 0", "nan"}},
      {"vtu_nan", "a.vtu", replaced(text_vtu(), "1 0 0.25", "1 nan 0.25"), {"vertex 1", "nan"}},
      // Faces
      {"obj_zero", "a.obj", kTriangle + "f 0 1 2\n", {"line 4", "vertex 0", "from 1"}},
      {"obj_range",
       "a.obj",
       kTriangle + "f 1 2 3\nf 1 2 4\n",
       {"line 5", "vertex 4", "3 vertices"}},
      {"obj_negative", "a.obj", kTriangle + "f -1 -2 -4\n", {"line 4", "vertex -4", "3 vertices"}},
      {"obj_far", "a.obj", kTriangle + "f 1 2 99999999999\n", {"vertex 99999999998"}},
      {"obj_two", "a.obj", kTriangle + "f 1 2 3\n\nf 1 2 1\n", {"line 6", "face 1", "3 distinct"}},
      {"obj_face_word", "a.obj", kTriangle + "f 1 2 x\n", {"line 4", "'x'"}},
      {"obj_slash", "a.obj", kTriangle + "f 1/ 2/ 3/\n", {"line 4"}},
      {"off_range", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {"line 6", "vertex 3"}},
      {"off_negative", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", {"vertex -1"}},
      {"off_two", "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", {"line 6", "3 distinct"}},
      {"ply_range", "a.ply", ply + "4 0 1 3 2 1\n3 0 1 4 1\n", {"line 18", "face 1", "vertex 4"}},
      {"ply_two", "a.ply", ply + "4 0 1 3 2 1\n2 0 1 1\n", {"line 18", "face 1", "3 distinct"}},
      {"stl_degenerate",
       "a.stl",
       "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex -0 0 0\n"
       "endfacet\nendsolid\n",
       {"line 2", "3 distinct"}},
      {"stl_two",
       "a.stl",
       "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nendfacet\nendsolid\n",
       {"line 5", "3 vertices"}},
      {"vtk_range", "a.vtk", vtk(vtk_points + "POLYGONS 1 4\n3 0 1 3\n"), {"vertex 3"}},
      {"vtk_two", "a.vtk", vtk(vtk_points + "POLYGONS 1 3\n2 0 1\n"), {"3 distinct"}},
      {"vtk_cell_size",
       "a.vtk",
       vtk(vtk_points + "POLYGONS 1 4\n100000000 0 1 2\n"),
       {"cell 0", "100000000"}},
      {"vtk_cell_overflow",
       "a.vtk",
       vtk(vtk_points + "POLYGONS 1 4\n9223372036854775807 0 1 2\n"),
       {"cell 0"}},
      {"vtk_cell_negative", "a.vtk", vtk(vtk_points + "POLYGONS 1 4\n-3 0 1 2\n"), {"cell 0"}},
      {"vtp_range", "a.vtp", replaced(text_vtp(), "0 1 3 2", "0 1 4 2"), {"vertex 4"}},
      {"vtu_range", "a.vtu", replaced(text_vtu(), "0 1 3 2", "0 1 -3 2"), {"vertex -3"}},
      {"vtu_two", "a.vtu", replaced(text_vtu(), "0 1 3</Data", "0 1 1</Data"), {"3 distinct"}},
      {"vtu_offsets", "a.vtu", replaced(text_vtu(), "2 6 9", "2 9 6"), {"damaged"}},
      {"vtu_offsets_far", "a.vtu", replaced(text_vtu(), "2 6 9", "2 6 900"), {"damaged"}},
      // Sizes
      {"off_huge_vertices",
       "a.off",
       std::string("OFF\n") + kHuge + " 1 0\n0 0 0\n",
       {kHuge + " vertices"}},
      {"off_huge_faces",
       "a.off",
       std::string("OFF\n1 ") + kHuge + " 0\n0 0 0\n3 0 0 0",
       {kHuge + " faces"}},
      {"off_huge_face",
       "a.off",
       std::string("OFF\n1 1 0\n0 0 0\n") + kHuge + " 0 0 0",
       {kHuge + " vertices"}},
      {"off_negative_count", "a.off", "OFF\n-5 1 0\n0 0 0\n", {"-5 vertices"}},
      {"off_huge_binary",
       "a.off",
       Bytes(std::endian::big).text("OFF BINARY\n").add_all<int>({2000000000, 1, 0}).str(),
       {"2000000000 vertices"}},
      {"ply_huge_text", "a.ply", ply_header("ascii", kHuge) + "0 0 0 0\n", {kHuge + " vertices"}},
      {"ply_huge_binary",
       "a.ply",
       ply_header("binary_little_endian", kHuge) + "0000",
       {kHuge + " vertices"}},
      {"ply_huge_skipped",
       "a.ply",
       std::string("ply\nformat ascii 1.0\nelement other ") + kHuge +
           "\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
       {kHuge + " elements"}},
      {"ply_overflow", "a.ply", ply_header("ascii", "99999999999999999999") + "0", {"line 4"}},
      {"stl_huge", "a.stl", stl(4000000000u), {"4000000000 triangles", "200000000084"}},
      {"vtk_huge_text",
       "a.vtk",
       vtk(std::string("DATASET POLYDATA\nPOINTS ") + kHuge + " double\n0 0 0\n"),
       {kHuge + " points"}},
      {"vtk_huge_binary",
       "a.vtk",
       vtk(std::string("DATASET POLYDATA\nPOINTS ") + kHuge + " double\n0 0 0\n", "BINARY"),
       {kHuge + " points"}},
      {"vtk_huge_cells",
       "a.vtk",
       vtk(vtk_points + std::string("POLYGONS ") + kHuge + " 4\n3 0 1 2\n"),
       {kHuge + " cells"}},
      {"vtk_huge_values",
       "a.vtk",
       vtk(vtk_points + std::string("POLYGONS 1 ") + kHuge + "\n3 0 1 2\n"),
       {kHuge}},
      {"vtk_huge_types",
       "a.vtk",
       vtk(grid_points + std::string("CELL_TYPES ") + kHuge + "\n5\n"),
       {kHuge}},
      {"vtk_huge_components",
       "a.vtk",
       vtk(vtk_points + std::string("POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nFIELD F 1\na ") + kHuge +
           " 3 double\n1 2 3\n"),
       {kHuge + " components"}},
      {"vtp_huge",
       "a.vtp",
       replaced(text_vtp(), "NumberOfPoints=\"4\"",
                std::string("NumberOfPoints=\"") + kHuge + "\""),
       {"NumberOfPoints", kHuge}},
      {"vtp_huge_polys",
       "a.vtp",
       replaced(text_vtp(), "NumberOfPolys=\"1\"", std::string("NumberOfPolys=\"") + kHuge + "\""),
       {"NumberOfPolys", kHuge}},
      {"vtu_huge",
       "a.vtu",
       replaced(text_vtu(), "NumberOfPoints=\"4\"",
                std::string("NumberOfPoints=\"") + kHuge + "\""),
       {"NumberOfPoints", kHuge}},
      {"vtu_huge_cells",
       "a.vtu",
       replaced(text_vtu(), "NumberOfCells=\"3\"", std::string("NumberOfCells=\"") + kHuge + "\""),
       {"NumberOfCells", kHuge}},
      {"vtu_huge_components",
       "a.vtu",
       replaced(text_vtu(), "NumberOfComponents=\"3\"", "NumberOfComponents=\"1000000000\""),
       {"NumberOfComponents"}},
      {"vtu_more_points",
       "a.vtu",
       replaced(text_vtu(), "NumberOfPoints=\"4\"", "NumberOfPoints=\"40\""),
       {"damaged"}},
      {"vtu_fewer_types", "a.vtu", replaced(text_vtu(), "3 9 5</Data", "3 9</Data"), {"damaged"}},
      // Other contents
      {"vtp_no_block_size", "a.vtp", with_block_header(1, 0, 24), {"compressed blocks"}},
      {"vtp_huge_blocks", "a.vtp", with_block_header(4000000000u, 1, 0), {"4000000000 of 1 bytes"}},
      {"vtp_huge_block", "a.vtp", with_block_header(1, 4000000000u, 0), {"1 of 4000000000 bytes"}},
      {"vtp_large_last_block", "a.vtp", with_block_header(1, 8, 800), {"compressed blocks"}},
      {"vtp_no_blocks", "a.vtp", with_block_header(0, 8, 8), {"compressed blocks"}},
      {"vtp_unreadable_array",
       "a.vtp",
       replaced(text_vtp(), ">7 8 9<", ">Arr7 8 9<"),
       {"array", "damaged"}},
      {"vtu_volume",
       "a.vtu",
       replaced(replaced(text_vtu(), "3 9 5</Data", "3 10 5</Data"), "0 1 3 2", "0 1 3 2"),
       {"volume mesh (1 cells)", "surface mesh is needed"}},
      {"vtk_volume",
       "a.vtk",
       vtk(grid_points + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"),
       {"volume mesh (1 cells)", "surface mesh is needed"}},
      {"vtk_curved",
       "a.vtk",
       vtk(grid_points + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n22\n"),
       {"cell 0", "type 22", "convert"}},
      {"vtk_wrong_size",
       "a.vtk",
       vtk(grid_points + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n5\n"),
       {"cell 0", "4 points"}},
      {"vtk_few_types", "a.vtk", vtk(grid_points + "CELLS 1 5\n4 0 1 2 3\n"), {"cell types"}},
      {"vtk_image",
       "a.vtk",
       vtk("DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n"),
       {"volume mesh (1 cells)", "surface mesh is needed"}},
      {"vtk_data_size",
       "a.vtk",
       vtk(vtk_points + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\n"),
       {"POINT_DATA for 4", "3"}},
      {"vtk_text_array",
       "a.vtk",
       vtk(vtk_points + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nFIELD F 1\na 1 3 string\nx\ny\nz\n"),
       {"'STRING'"}},
      {"vti",
       "a.vti",
       "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\"></VTKFile>",
       {"'ImageData'", "extract the surface"}},
      {"off_four", "a.off", "4OFF\n1 0 0\n0 0 0 1\n", {"3-dimensional"}},
      {"ply_strips",
       "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
       "property float z\nelement tristrips 0\nproperty list int int vertex_indices\nend_header\n",
       {"triangle strips"}},
      {"ply_no_z",
       "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
       "property float y\nend_header\n1 2\n",
       {"x, y and z"}},
      {"ply_float_index", "a.ply", ply + "4 0 1.5 3 2 1\n3 0 1 2 1\n", {"line 17", "whole number"}},
  };
}

class BadInput : public testing::TestWithParam<BadFile> {};

TEST_P(BadInput, GivesOneClearLineAndPrintsNothing) {
  const TemporaryFolder folder;
  const auto path = write_bytes(folder / GetParam().file, GetParam().content);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::string message;
  try {
    read_surface(path);
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
  ASSERT_NE(message, "") << "no error";
  EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  std::size_t from = path.string().size();
  for (const std::string& part : GetParam().message) {
    from = message.find(part, from);
    EXPECT_NE(from, std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, BadInput, testing::ValuesIn(bad_files()),
                         [](const auto& test) { return test.param.name; });

TEST(BadPath, IsNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_surface(folder / "missing.obj"), IoError);
  EXPECT_THROW(read_surface(folder.path()), IoError);
  EXPECT_THROW(read_surface("/dev/null"), IoError);
}

/// A damaged file is an error or a mesh that keeps PolygonMesh's promises, and never prints.
void expect_error_or_mesh(const std::filesystem::path& path, const std::string& content,
                          const std::string& what) {
  write_bytes(path, content);
  try {
    const SurfaceData data = read_surface(path);
    EXPECT_TRUE(data.mesh.points().array().isFinite().all()) << what;
    for (const Field& field : data.fields.vertex)
      EXPECT_EQ(field.n_rows(), data.mesh.n_vertices()) << what;
    for (const Field& field : data.fields.face)
      EXPECT_EQ(field.n_rows(), data.mesh.n_faces()) << what;
    EXPECT_GE(data.mesh.n_edges(), 0) << what;
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + ": ")) << error.what();
  }
}

class Damage : public testing::TestWithParam<SampleFile> {
 protected:
  void SetUp() override {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
  }
  void TearDown() override {
    EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
  }
  TemporaryFolder folder_;
};

TEST_P(Damage, IntactFileIsRead) {
  EXPECT_GE(read_surface(write_bytes(folder_ / GetParam().file, GetParam().content)).mesh.n_faces(),
            2);
}

TEST_P(Damage, TruncatedAnywhere) {
  const SampleFile& sample = GetParam();
  const std::size_t step = std::max<std::size_t>(1, sample.content.size() / 200);
  for (std::size_t size = 0; size < sample.content.size(); size += step)
    expect_error_or_mesh(folder_ / sample.file, sample.content.substr(0, size),
                         std::string("first ") + std::to_string(size) + " bytes");
}

TEST_P(Damage, AnyBytesChanged) {
  const SampleFile& sample = GetParam();
  std::mt19937 random(7);  // NOLINT: the same damage in every run
  const std::string favourites("0123456789-.eE \n\t/\\<>\"\0\x7f\xff", 25);
  for (int round = 0; round < 300; ++round) {
    std::string content = sample.content;
    const unsigned changes = 1 + random() % 4;
    for (unsigned i = 0; i < changes; ++i) {
      const std::size_t at = random() % content.size();
      switch (random() % 4) {
        case 0:
          content[at] = static_cast<char>(random());
          break;
        case 1:
          content[at] = favourites[random() % favourites.size()];
          break;
        case 2:
          content.erase(at, 1 + random() % 8);
          break;
        default:
          content.insert(at, content.substr(random() % content.size(), random() % 16));
      }
      if (content.empty()) content.push_back('x');
    }
    expect_error_or_mesh(folder_ / sample.file, content,
                         std::string("round ") + std::to_string(round));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Damage, testing::ValuesIn(sample_files()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace carat::test
