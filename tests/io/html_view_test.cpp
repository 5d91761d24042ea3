#include "carat/report/html_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace {

using namespace carat;
namespace fs = std::filesystem;

class HtmlView : public testing::Test {
 protected:
  HtmlView() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("carat_html_view_") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~HtmlView() override { fs::remove_all(folder_); }

  static SurfaceData square() {
    Points points(4, 3);
    points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    return {PolygonMesh::from_faces(points, {{0, 1, 2, 3}}), {}};
  }
  static VolumeData tetrahedron() {
    Points points(4, 3);
    points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    CellCollector cells;
    cells.add(CellType::Tetrahedron, std::array<Index, 4>{0, 1, 2, 3});
    return {std::move(cells).build(points), {}, {}};
  }
  static std::string content(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
      ++n;
    return n;
  }

  fs::path folder_;
};

TEST_F(HtmlView, EndsEveryElementItself) {
  SurfaceData data = square();
  data.fields.vertex = {{"</script><!--", 1, {1, 2, 3, 4}}};
  write_html_view(folder_ / "plain.html", {{"a", square()}}, "b");
  write_html_view(folder_ / "odd.html", {{"</script>", data}}, "</title></script><!--");
  const std::string plain = content(folder_ / "plain.html");
  const std::string odd = content(folder_ / "odd.html");
  EXPECT_EQ(count(odd, "</title>"), count(plain, "</title>"));
  EXPECT_EQ(count(odd, "<!--"), count(plain, "<!--"));
  EXPECT_EQ(count(odd, "</script"), count(plain, "</script") + 1) << "one more block: the field";
  EXPECT_NE(odd.find("&lt;/title&gt;"), std::string::npos);
}

TEST_F(HtmlView, NamesThatAreNotUtf8AreReplaced) {
  SurfaceData data = square();
  data.fields.face = {{"\xff\xfe", 1, {1}}};
  EXPECT_NO_THROW(write_html_view(folder_ / "page.html", {{"\xc3", data}}));
}

TEST_F(HtmlView, KeepsFieldsThatSinglePrecisionWouldLose) {
  SurfaceData data = square();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  data.fields.vertex = {{"large", 1, {1e300, -1e300, 0, nan}},
                        {"small", 1, {1e-300, 2e-300, 0, 0}},
                        {"offset", 1, {1e9, 1e9 + 1, 1e9 + 2, 1e9 + 3}},
                        {"missing", 1, {nan, nan, nan, nan}}};
  write_html_view(folder_ / "page.html", {{"square", data}});
  const std::string page = content(folder_ / "page.html");
  EXPECT_NE(page.find("\"scale\":1e+300"), std::string::npos);
  EXPECT_NE(page.find("\"scale\":2e-300"), std::string::npos);
  EXPECT_NE(page.find("\"offset\":1000000001.5"), std::string::npos);
}

TEST_F(HtmlView, EmptyMesh) {
  EXPECT_NO_THROW(write_html_view(folder_ / "page.html", {{"nothing", SurfaceData{}}}));
  EXPECT_NO_THROW(write_html_view(folder_ / "volume.html", {{"nothing", VolumeData{}}}));
}

TEST_F(HtmlView, RefusesFieldsThatDoNotFit) {
  const fs::path path = folder_ / "page.html";
  std::ofstream(path) << "before";
  SurfaceData data = square();
  data.fields.vertex = {{"short", 3, {1, 2, 3, 4}}};
  EXPECT_THROW(write_html_view(path, {{"square", data}}), InvalidOption);
  data.fields.vertex = {{"flat", 0, {}}};
  EXPECT_THROW(write_html_view(path, {{"square", data}}), InvalidOption);
  EXPECT_THROW(write_html_view(path, {}), InvalidOption);
  EXPECT_EQ(content(path), "before");
}

TEST_F(HtmlView, WritesVolumesBesideSurfaces) {
  VolumeData data = tetrahedron();
  data.fields.vertex = {{"at vertices", 1, {1, 2, 3, 4}}};
  data.fields.cell = {{"in cells", 3, {1, 2, 3}}};
  data.patches = {{"</wall>", "wall", {0, 2}}};
  write_html_view(folder_ / "page.html", {{"tetrahedron", data}, {"square", square()}});
  const std::string page = content(folder_ / "page.html");
  EXPECT_EQ(count(page, "\"kind\":\"volume\""), 1U);
  EXPECT_EQ(count(page, "\"kind\":\"surface\""), 1U);
  EXPECT_EQ(count(page, "\"on\":\"cell\""), 1U);
  EXPECT_EQ(count(page, "\\u003c/wall>"), 1U);
}

TEST_F(HtmlView, RefusesWhatDoesNotFitAVolume) {
  VolumeData short_field = tetrahedron();
  short_field.fields.cell = {{"two", 1, {1, 2}}};
  EXPECT_THROW(write_html_view(folder_ / "page.html", {{"t", short_field}}), InvalidOption);
  for (const Index face : {-1, 4}) {
    VolumeData bad_patch = tetrahedron();
    bad_patch.patches = {{"wall", "", {face}}};
    EXPECT_THROW(write_html_view(folder_ / "page.html", {{"t", bad_patch}}), InvalidOption);
  }
  EXPECT_FALSE(fs::exists(folder_ / "page.html"));
}

TEST_F(HtmlView, RefusesAFolderThatDoesNotExist) {
  EXPECT_THROW(write_html_view(folder_ / "none" / "page.html", {{"square", square()}}), IoError);
}

}  // namespace
