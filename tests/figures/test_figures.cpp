#include <gtest/gtest.h>
#include <vtkNew.h>
#include <vtkXMLParser.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "carat/base/error.h"
#include "cli/figure_render.h"
#include "cli/figures.h"
#include "sample_experiment.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

class Figures : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("carat_figures_" +
              std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directory(folder);
  }
  void TearDown() override {
    if (!std::getenv("CARAT_KEEP_FIGURES")) fs::remove_all(folder);
  }

  std::string get(const std::string& name) const {
    std::ifstream in(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Checks both files of a figure and returns the size of the image.
  std::pair<int, int> check_files(const std::string& id) const {
    vtkNew<vtkXMLParser> parser;
    EXPECT_EQ(parser->Parse(get(id + ".svg").c_str()), 1) << id;
    const std::string png = get(id + ".png");
    EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n") << id;
    const auto number = [&](std::size_t at) {
      int value = 0;
      for (std::size_t i = at; i < at + 4; ++i)
        value = 256 * value + static_cast<unsigned char>(png.at(i));
      return value;
    };
    return {number(16), number(20)};
  }
  std::ptrdiff_t n_files() const {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }
  fs::path folder;
};

TEST_F(Figures, are_written_as_drawings_and_images) {
  Json experiment = sample_experiment(4, 5, 4);
  experiment["figures"] = {lines_figure(), matrix_figure(), table_figure()};
  experiment["figures"][2]["filter"] = {{"level", 3}};
  write_figures(experiment, folder.string());
  EXPECT_EQ(n_files(), 6);
  for (const char* const id : {"errors", "ratios", "numbers"}) {
    const auto [width, height] = check_files(id);
    EXPECT_EQ(width, 1800) << id;
    EXPECT_GT(height, 300) << id;
    EXPECT_LT(height, 2000) << id;
  }
}

TEST_F(Figures, of_nothing_are_empty) {
  Json experiment = sample_experiment(4, 5, 4);
  experiment["figures"] = {lines_figure(), matrix_figure(), table_figure()};
  for (Json& row : experiment["rows"]) row[6] = row[7] = nullptr;
  write_figures(experiment, folder.string());
  experiment["rows"] = Json::array();
  write_figures(experiment, folder.string());
  for (const char* const id : {"errors", "ratios", "numbers"}) check_files(id);
}

TEST_F(Figures, grow_with_their_columns) {
  Json experiment = sample_experiment(1, 1, 1);
  const Json row = experiment["rows"][0];
  for (int i = 0; i < 30; ++i) {
    experiment["rows"].push_back(row);
    experiment["rows"].back()[2] = "operator-" + std::to_string(i);
  }
  experiment["figures"] = Json::array({matrix_figure()});
  write_figures(experiment, folder.string());
  EXPECT_GT(check_files("ratios").first, 1800);
}

TEST_F(Figures, escape_the_characters_of_xml) {
  Json experiment = sample_experiment(1, 2, 3);
  experiment["figures"] = {lines_figure(), table_figure()};
  for (Json& figure : experiment["figures"]) figure["title"] = "a < b & \"c\" > ^{d";
  write_figures(experiment, folder.string());
  for (const char* const id : {"errors", "numbers"}) check_files(id);
}

TEST_F(Figures, are_not_begun_if_one_is_wrong) {
  Json experiment = sample_experiment(2, 2, 2);
  experiment["figures"] = {lines_figure(), table_figure()};
  experiment["figures"][1]["columns"] = {"colour"};
  EXPECT_THROW(write_figures(experiment, folder.string()), InvalidOption);
  EXPECT_EQ(n_files(), 0);
}

TEST_F(Figures, too_long_for_an_image_are_refused) {
  Json experiment = sample_experiment(1, 1, 1);
  const Json row = experiment["rows"][0];
  for (int i = 0; i < 2000; ++i) experiment["rows"].push_back(row);
  experiment["figures"] = Json::array({table_figure()});
  EXPECT_THROW(write_figures(experiment, folder.string()), InvalidOption);
}

TEST_F(Figures, in_a_folder_that_cannot_be_written_are_an_error) {
  Json experiment = sample_experiment(2, 2, 2);
  experiment["figures"] = Json::array({lines_figure()});
  EXPECT_THROW(write_figures(experiment, (folder / "missing").string()), IoError);
  std::ofstream(folder / "file") << "text";
  EXPECT_THROW(write_figures(experiment, (folder / "file").string()), IoError);
  EXPECT_EQ(n_files(), 1);
}

/// Two squares that face the eye of render(), the one of value 1 in front of the upper half of the
/// one of value 0.
TEST(Render, nearer_faces_hide_others_and_values_become_colours) {
  const Vec3 eye =
      Vec3(std::sin(0.45) * std::cos(0.3), std::sin(0.3), std::cos(0.45) * std::cos(0.3));
  const Vec3 right = Vec3::UnitY().cross(eye).normalized(), up = eye.cross(right);
  Points points(8, 3);
  const double corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int k = 0; k < 4; ++k) {
    points.row(k) = corners[k][0] * right + corners[k][1] * up;
    points.row(4 + k) = corners[k][0] * right + (corners[k][1] + 1) / 2 * up + 0.5 * eye;
  }
  Vector values(8);
  values << 0, 0, 0, 0, 1, 1, 1, 1;
  const ColorScale scale{0, 1};
  const auto value_of = [](Color color) { return color.red + color.green + color.blue; };
  EXPECT_GT(value_of(scale.at(1)), value_of(scale.at(0.5)));
  EXPECT_EQ(value_of(scale.at(7)), value_of(scale.at(1)));
  EXPECT_EQ(value_of(scale.at(-7)), value_of(scale.at(0)));
  for (const double none :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const Color gray = scale.at(none);
    EXPECT_EQ(gray.red, gray.green);
    EXPECT_EQ(gray.red, gray.blue);
  }
  for (const bool front_first : {false, true}) {
    const std::vector<std::vector<Index>> faces{{0, 1, 2, 3}, {4, 5, 6, 7}};
    const auto mesh =
        PolygonMesh::from_faces(points, front_first ? std::vector{faces[1], faces[0]} : faces);
    const Image image = render(mesh, values, scale, 40, 40);
    ASSERT_EQ(image.pixels.size(), 1600u);
    const auto pixel = [&](int x, int y) {
      return image.pixels[static_cast<std::size_t>(40 * y + x)];
    };
    EXPECT_EQ(pixel(20, 10), 0xfde725u);
    EXPECT_EQ(pixel(20, 30), 0x440154u);
    EXPECT_EQ(pixel(0, 0), 0xffffffu);
  }
  // A line in the middle of a ramp, and none where the value does not pass one.
  values << 0, 1, 1, 0, 0, 0, 0, 0;
  const auto square = PolygonMesh::from_faces(points, {{0, 1, 2, 3}});
  const Image lines = render(square, values, {0, 1, 2}, 40, 40);
  EXPECT_LT(lines.pixels[20 * 40 + 20] >> 8 & 255, 0x60u);
  EXPECT_GT(lines.pixels[20 * 40 + 25] >> 8 & 255, 0x80u);
}

TEST_F(Figures, show_surfaces_where_there_are_some) {
  Json experiment = sample_experiment(2, 2, 2);
  experiment["figures"] = {{{"id", "surfaces"}, {"title", "A picture"}, {"kind", "picture"}}};
  write_figures(experiment, folder.string());
  EXPECT_EQ(n_files(), 0);
  Points points(3, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  SurfaceData data{PolygonMesh::from_faces(points, {{0, 1, 2}}), {}};
  data.fields.vertex = {{"height_above", 1, {0, 1, 2}}};
  write_figures(experiment, folder.string(), {{"one", data}, {"two", data}});
  EXPECT_EQ(n_files(), 2);
  EXPECT_EQ(check_files("surfaces").first, 1800);
}

}  // namespace
}  // namespace carat::cli
