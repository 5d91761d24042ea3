// OpenFOAM cases that decomposePar has divided.

#include "carat/base/error.h"
#include "carat/io/openfoam.h"
#include "foam_case.h"
#include "support/mesh_parts.h"
#include "volume_samples.h"

namespace carat::test {
namespace {

void expect_same(const VolumeData& a, const VolumeData& b) {
  expect_same_mesh(a.mesh.face_mesh(), b.mesh.face_mesh());
  EXPECT_EQ(a.mesh.cells().offsets, b.mesh.cells().offsets);
  EXPECT_EQ(a.mesh.cells().indices, b.mesh.cells().indices);
  ASSERT_EQ(a.mesh.n_faces(), b.mesh.n_faces());
  for (Index f = 0; f < a.mesh.n_faces(); ++f)
    EXPECT_EQ(a.mesh.face_cells()[f].below, b.mesh.face_cells()[f].below);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t k = 0; k < a.patches.size(); ++k) {
    EXPECT_EQ(a.patches[k].name, b.patches[k].name);
    EXPECT_EQ(a.patches[k].type, b.patches[k].type);
    EXPECT_EQ(a.patches[k].faces, b.patches[k].faces);
  }
}

/// A mesh without loose parts, as its files give it.
VolumeData sample(const FoamCase& form, const std::filesystem::path& folder) {
  return read_volume(form.write(folder, generate_volume("cube-voronoi", {.level = 0})));
}

class DividedFoam : public testing::TestWithParam<FoamForm> {};

TEST_P(DividedFoam, is_put_together_to_the_whole_in_every_bit) {
  const TemporaryFolder folder;
  const FoamCase form(GetParam());
  const VolumeData whole = sample(form, folder / "whole");
  for (Index n = 1; n <= 4; ++n)
    for (const auto& parts :
         {in_blocks(whole.mesh.n_cells(), n), scattered(whole.mesh.n_cells(), n)}) {
      std::filesystem::remove_all(folder / "case");
      const auto path = form.write_divided(folder / "case", whole.mesh, whole.patches, parts, n);
      EXPECT_EQ(foam_processors(path).size(), std::size_t(n));
      expect_same(read_volume(path), whole);
    }
}

INSTANTIATE_TEST_SUITE_P(Forms, DividedFoam,
                         testing::Values(FoamForm::Text, FoamForm::Binary32, FoamForm::Binary64));

TEST(DividedFoamCase, the_whole_mesh_goes_before_its_parts) {
  const TemporaryFolder folder;
  const FoamCase form(FoamForm::Text);
  const VolumeData whole = sample(form, folder / "case");
  form.write_divided(folder / "case", whole.mesh, whole.patches, in_blocks(whole.mesh.n_cells(), 2),
                     2);
  write_bytes(folder / "case" / "processor1" / "constant" / "polyMesh" / "faces", "damaged");
  EXPECT_EQ(read_volume(folder / "case").mesh.n_cells(), whole.mesh.n_cells());
  write_bytes(folder / "case" / "case.foam", "");
  EXPECT_EQ(foam_processors(folder / "case" / "case.foam").size(), 2U);
  EXPECT_TRUE(foam_processors(folder / "case" / "constant").empty());
}

TEST(DividedFoamCase, a_processor_by_itself_knows_its_numbers) {
  const TemporaryFolder folder;
  const FoamCase form(FoamForm::Binary32);
  const VolumeData whole = sample(form, folder / "whole");
  form.write_divided(folder / "case", whole.mesh, whole.patches, scattered(whole.mesh.n_cells(), 3),
                     3);
  const auto piece = read_foam_piece(folder / "case" / "processor1");
  ASSERT_EQ(piece.patches.size(), whole.patches.size());
  for (Index f = 0; f < piece.mesh.n_faces(); ++f) {
    std::vector<Index> vertices;
    for (const Index v : piece.mesh.face(f))
      vertices.push_back(static_cast<Index>(piece.vertex_ids[std::size_t(v)]));
    const auto face = whole.mesh.face(static_cast<Index>(piece.interface_ids[std::size_t(f)]));
    EXPECT_EQ(vertices, std::vector<Index>(face.begin(), face.end()));
  }
}

void expect_failure(const std::filesystem::path& path, const std::string& says) {
  try {
    read_mesh(path);
    ADD_FAILURE() << "no error that says " << says;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
}

TEST(DividedFoamCase, what_is_wrong_is_said_with_the_processor) {
  const TemporaryFolder folder;
  const FoamCase form(FoamForm::Text);
  const VolumeData whole = sample(form, folder / "whole");
  const auto write = [&](bool addressing = true) {
    std::filesystem::remove_all(folder / "case");
    return form.write_divided(folder / "case", whole.mesh, whole.patches,
                              in_blocks(whole.mesh.n_cells(), 3), 3, addressing);
  };
  const auto files = folder / "case" / "processor1" / "constant" / "polyMesh";
  expect_failure(write(false), "reconstructParMesh");
  const auto path = write();
  for (const char* name : {"points", "faces", "owner", "pointProcAddressing", "faceProcAddressing",
                           "cellProcAddressing", "boundary"}) {
    const std::string good = read_bytes(files / name);
    write_bytes(files / name, good.substr(0, good.size() / 2));
    expect_failure(path, (files.string() + ": " + name).substr(0, files.string().size() + 2));
    write_bytes(files / name, good);
  }
  // Numbers that no mesh of this size has, and 0, which stands for no face.
  const std::string good = read_bytes(files / "faceProcAddressing");
  const std::size_t first = good.find("(\n") + 2;
  for (const char* number : {"900000000", "0", "99999999999"}) {
    std::string bad = good;
    bad.replace(first, bad.find('\n', first) - first, number);
    write_bytes(files / "faceProcAddressing", bad);
    expect_failure(path, files.string());
  }
  write();
  std::filesystem::remove_all(folder / "case" / "processor2");
  expect_failure(path, "");
  write();
  std::filesystem::remove_all(folder / "case" / "processor1" / "constant");
  expect_failure(path, "processor1");
}

}  // namespace
}  // namespace carat::test
