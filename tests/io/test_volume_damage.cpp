// Damaged volume files: an error or a mesh, never a crash.

#include <random>

#include "carat/base/error.h"
#include "foam_case.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

/// A damaged file is an error or a mesh that keeps its promises, and never prints.
void expect_error_or_mesh(const std::filesystem::path& path, const std::string& what) {
  try {
    const MeshData data = read_mesh(path);
    if (const VolumeData* volume = std::get_if<VolumeData>(&data)) {
      EXPECT_TRUE(volume->mesh.points().array().isFinite().all()) << what;
      for (const Field& field : volume->fields.vertex)
        EXPECT_EQ(field.n_rows(), volume->mesh.n_vertices()) << what;
      for (const Field& field : volume->fields.cell)
        EXPECT_EQ(field.n_rows(), volume->mesh.n_cells()) << what;
      for (const BoundaryPatch& patch : volume->patches)
        for (const Index f : patch.faces) EXPECT_LT(f, volume->mesh.n_faces()) << what;
    }
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + ": ")) << error.what();
  }
}

std::string damaged(std::string content, std::mt19937& random) {
  const std::string favourites("0123456789-.eE \n\t/\\<>(){}$#\"\0\x7f\xff", 30);
  const unsigned changes = 1 + random() % 4;
  for (unsigned i = 0; i < changes && !content.empty(); ++i) {
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
  }
  if (content.empty()) content.push_back('x');
  return content;
}

class DamagedVolume : public testing::TestWithParam<VolumeSample> {
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

TEST_P(DamagedVolume, TruncatedAnywhere) {
  const std::string& content = GetParam().content;
  for (std::size_t size = 0; size < content.size(); ++size)
    expect_error_or_mesh(write_bytes(folder_ / GetParam().file, content.substr(0, size)),
                         "first " + std::to_string(size) + " bytes");
}

TEST_P(DamagedVolume, AnyBytesChanged) {
  std::mt19937 random(11);  // NOLINT: the same damage in every run
  for (int round = 0; round < 400; ++round)
    expect_error_or_mesh(
        write_bytes(folder_ / GetParam().file, damaged(GetParam().content, random)),
        "round " + std::to_string(round));
}

INSTANTIATE_TEST_SUITE_P(Files, DamagedVolume, testing::ValuesIn(volume_samples()),
                         [](const auto& test) { return test.param.name; });

class DamagedOpenFoam : public testing::TestWithParam<FoamForm> {
 protected:
  TemporaryFolder folder_;
};

TEST_P(DamagedOpenFoam, IsAnErrorOrAMesh) {
  const auto path = FoamCase(GetParam()).write(folder_ / "case", mixed_mesh());
  std::mt19937 random(13);  // NOLINT: the same damage in every run
  for (const char* name : {"points", "faces", "owner", "neighbour", "boundary"}) {
    const auto file = path / "constant/polyMesh" / name;
    const std::string intact = read_bytes(file);
    for (std::size_t size = 1; size < intact.size(); size += 2)
      expect_error_or_mesh((write_bytes(file, intact.substr(0, size)), path),
                           std::string(name) + " of " + std::to_string(size) + " bytes");
    for (int round = 0; round < 200; ++round)
      expect_error_or_mesh((write_bytes(file, damaged(intact, random)), path),
                           std::string(name) + " round " + std::to_string(round));
    write_bytes(file, intact);
  }
  EXPECT_EQ(read_volume(path).mesh.n_cells(), 5);
}

INSTANTIATE_TEST_SUITE_P(Forms, DamagedOpenFoam,
                         testing::Values(FoamForm::Text, FoamForm::Binary32, FoamForm::Binary64));

}  // namespace
}  // namespace carat::test
