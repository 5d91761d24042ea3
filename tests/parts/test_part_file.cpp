#include "carat/base/error.h"
#include "carat/distributed/message.h"
#include "carat/distributed/part_file.h"
#include "io/io_support.h"
#include "support/same_parts.h"
#include "support/sample_data.h"

namespace carat::test {
namespace {

template <class Mesh>
void check(const Mesh& mesh) {
  const TemporaryFolder folder;
  const auto data = sample_data(mesh);
  for_divisions(mesh, [&](const MeshDivision& division) {
    write_part_file(folder / "mesh.cparts", data, division);
    EXPECT_EQ(folder.n_files(), 1U);
    ASSERT_EQ(count_parts(folder / "mesh.cparts"), division.n_parts);
    for (Index p = 0; p < division.n_parts; ++p)
      expect_same(std::get<PartData<Mesh>>(read_part(folder / "mesh.cparts", p)),
                  part_data_of(data, division, p));
  });
}

TEST(PartFile, parts_come_back_bit_by_bit) {
  for (const auto& [name, mesh] : surfaces_to_divide()) {
    SCOPED_TRACE(name);
    check(mesh);
  }
  for (const auto& [name, mesh] : volumes_to_divide()) {
    SCOPED_TRACE(name);
    check(mesh);
  }
}

TEST(PartFile, patches_are_the_faces_that_the_part_has) {
  const PolyhedralMesh mesh = hex_grid(3);
  const VolumeData data = sample_data(mesh);
  for_divisions(mesh, [&](const MeshDivision& division) {
    for (Index p = 0; p < division.n_parts; ++p) {
      const PartData<PolyhedralMesh> part = part_data_of(data, division, p);
      const Array<std::int64_t>& numbers = part.part.numbers.interfaces;
      ASSERT_EQ(part.patches.size(), data.patches.size());
      for (std::size_t k = 0; k < part.patches.size(); ++k)
        for (Index f = 0; f < static_cast<Index>(numbers.size()); ++f) {
          const std::vector<Index>&here = part.patches[k].faces, &whole = data.patches[k].faces;
          EXPECT_EQ(std::binary_search(here.begin(), here.end(), f),
                    std::binary_search(whole.begin(), whole.end(), numbers[f]));
        }
    }
  });
}

/// What reading all parts says; "" if nothing is wrong.
std::string failure(const std::filesystem::path& path, Index n_parts) {
  try {
    for (Index p = 0; p < n_parts; ++p) read_part(path, p);
  } catch (const IoError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    return message;
  }
  return "";
}

class DamagedPartFile : public testing::Test {
 protected:
  DamagedPartFile() {
    const PolyhedralMesh mesh = hex_grid(2);
    write_part_file(path, sample_data(mesh), divide(mesh, 2, in_blocks(mesh.n_cells(), 2)));
    good = read_bytes(path);
  }
  void expect(const std::string& bytes, const std::string& says) {
    const std::string message = failure(write_bytes(path, bytes), 2);
    EXPECT_NE(message.find(says), std::string::npos) << message;
  }
  TemporaryFolder folder;
  std::filesystem::path path = folder / "mesh.cparts";
  std::string good;
};

TEST_F(DamagedPartFile, cut_off_anywhere_is_refused) {
  for (std::size_t size = 0; size < good.size(); size += size < 200 ? 1 : 97)
    expect(good.substr(0, size), size < 40 ? "too few" : "truncated");
}

TEST_F(DamagedPartFile, any_byte_that_differs_is_refused) {
  for (std::size_t at = 0; at < good.size(); at += at < 200 ? 1 : 61) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << at % 8));
    EXPECT_NE(failure(write_bytes(path, bad), 2), "") << at;
  }
}

TEST_F(DamagedPartFile, what_is_foreign_is_named) {
  std::string bad = good;
  std::reverse(bad.begin() + 8, bad.begin() + 12);
  expect(bad, "another order of bytes");
  bad = good;
  for (const char version : {1, 3}) {
    bad[12] = version;
    expect(bad, "is of version " + std::to_string(version));
  }
  bad = good;
  bad[16] = 8;
  expect(bad, "indices of 8 bytes");
  expect("ply\nformat ascii 1.0, and so on for more than a header", "holds no mesh in parts");
  // More parts than the file has room for; nothing of that size is allocated.
  bad = good;
  for (int k = 24; k < 31; ++k) bad[std::size_t(k)] = '\x7f';
  expect(bad, "more than it can hold");
  EXPECT_THROW(read_part(folder.path(), 0), IoError);
  EXPECT_THROW(read_part(folder / "no.cparts", 0), IoError);
  write_bytes(path, good);
  EXPECT_EQ(failure(path, 2), "");
  EXPECT_THROW(read_part(path, 2), InvalidOption);
  EXPECT_THROW(read_part(path, -1), InvalidOption);
}

// A part file holds parts as messages.
TEST(Message, data_of_parts_with_interfaces_beyond_32_bits_come_back) {
  const PolyhedralMesh mesh = hex_grid(3);
  for_divisions(mesh, [&](const MeshDivision& division) {
    for (Index p = 0; p < division.n_parts; ++p) {
      PartData<PolyhedralMesh> data = part_data_of(sample_data(mesh), division, p), taken;
      data.part = with_first_interface(std::move(data.part), kManyInterfaces);
      Message message;
      put(message, data);
      take(message, taken);
      EXPECT_EQ(message.left(), 0U);
      expect_same(taken, data);
    }
  });
}

TEST(Message, claims_beyond_its_end_are_refused) {
  Message message;
  message.put(std::uint64_t{1} << 60);
  std::vector<double> list;
  EXPECT_THROW(message.take_list(list), Error);
  EXPECT_TRUE(list.empty());
}

TEST(PartFile, nothing_is_left_where_it_cannot_be_written) {
  const TemporaryFolder folder;
  const PolygonMesh mesh = cube();
  const MeshDivision division = divide(mesh, 1, std::vector<Index>(std::size_t(mesh.n_faces()), 0));
  EXPECT_THROW(write_part_file(folder / "no" / "mesh.cparts", sample_data(mesh), division),
               IoError);
  EXPECT_EQ(folder.n_files(), 0U);
}

}  // namespace
}  // namespace carat::test
