#include <gtest/gtest.h>
#include <vtkNew.h>
#include <vtkXMLParser.h>

#include <filesystem>
#include <fstream>

#include "carat/base/error.h"
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

}  // namespace
}  // namespace carat::cli
