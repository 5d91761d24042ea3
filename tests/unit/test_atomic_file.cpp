#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"

namespace carat {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("carat_atomic_" +
              std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directory(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  static void put(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string get(const fs::path& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t n_files() const {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }
  fs::path folder;
};

TEST_F(AtomicFile, replaces_the_file_when_writing_is_done) {
  const fs::path path = folder / "a.txt";
  put(path, "old");
  write_atomically(path, [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".txt");
    EXPECT_EQ(temporary.parent_path(), folder);
    put(temporary, "new");
    EXPECT_EQ(get(path), "old");
  });
  EXPECT_EQ(get(path), "new");
  EXPECT_EQ(n_files(), 1);
}

TEST_F(AtomicFile, keeps_the_old_file_when_writing_fails) {
  const fs::path path = folder / "a.txt";
  put(path, "old");
  EXPECT_THROW(write_atomically(path,
                                [](const fs::path& temporary) {
                                  put(temporary, "half");
                                  throw std::runtime_error("full");
                                }),
               std::runtime_error);
  EXPECT_EQ(get(path), "old");
  EXPECT_EQ(n_files(), 1);
}

TEST_F(AtomicFile, missing_folders_and_folders_as_files_are_refused) {
  const auto nothing = [](const fs::path&) { ADD_FAILURE() << "must not be called"; };
  EXPECT_THROW(write_atomically(folder / "no" / "a.txt", nothing), IoError);
  EXPECT_THROW(write_atomically(folder, nothing), IoError);
}

}  // namespace
}  // namespace carat
