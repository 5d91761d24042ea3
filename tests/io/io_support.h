#pragma once
// Temporary files and small meshes for the tests of readers and writers.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "carat/io/mesh_file.h"

namespace carat::test {

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "carat-io-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(folder_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& path() const { return folder_; }
  std::size_t n_files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_),
                                                  std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path folder_;
};

inline std::filesystem::path write_bytes(const std::filesystem::path& path,
                                         std::string_view bytes) {
  // Some file systems flush a file that is cut to nothing and written again: slow in a loop.
  std::filesystem::remove(path);
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline SurfaceData read_text_as(const std::string& name, std::string_view content) {
  const TemporaryFolder folder;
  return read_surface(write_bytes(folder / name, content));
}

/// Builds binary files value by value.
class Bytes {
 public:
  explicit Bytes(std::endian order) : order_(order) {}
  template <class T>
  Bytes& add(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (order_ != std::endian::native) std::reverse(bytes, bytes + sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }
  template <class T>
  Bytes& add_all(const std::vector<T>& values) {
    for (const T value : values) add(value);
    return *this;
  }
  Bytes& text(std::string_view text) {
    text_ += text;
    return *this;
  }
  const std::string& str() const { return text_; }

 private:
  std::endian order_;
  std::string text_;
};

/// A pentagon, a quadrilateral and a triangle, one vertex without a face, and coordinates that
/// are hard to print: many digits, subnormal, huge, -0.
inline PolygonMesh awkward_mesh() {
  Points points(8, 3);
  points << 0.1, -0.0, 5e-324,                                            //
      1.0 / 3, 2.0 / 3, 1e300,                                            //
      -1.7976931348623157e308, 1e-300, 1,                                 //
      0.30000000000000004, 123456789.12345679, -2.2250738585072014e-308,  //
      3, 4, 5,                                                            //
      1e22, 1e23, 9007199254740993,                                       //
      -1, -2, -3,                                                         //
      7, 8, 9;
  return PolygonMesh::from_faces(std::move(points), {{0, 1, 2, 3, 4}, {4, 3, 5, 6}, {6, 5, 0}});
}

/// Fields with values of every kind that fit awkward_mesh().
inline MeshFields awkward_fields() {
  const auto make = [](const char* name, Index components, Index rows, double seed) {
    Field field{name, components, {}};
    for (Index i = 0; i < rows * components; ++i) field.values.push_back(seed / (i + 3.0));
    return field;
  };
  return {{make("height", 1, 8, 0.7), make("velocity", 3, 8, -1e-200), make("uv", 2, 8, 1e17)},
          {make("area", 1, 3, 2.0), make("normals", 3, 3, 1.0), make("tensor", 9, 3, 1e-310)}};
}

inline bool same_bits(const double* a, const double* b, std::size_t n) {
  return std::memcmp(a, b, n * sizeof(double)) == 0;
}

inline void expect_same_mesh(const PolygonMesh& a, const PolygonMesh& b) {
  ASSERT_EQ(a.n_vertices(), b.n_vertices());
  EXPECT_TRUE(
      same_bits(a.points().data(), b.points().data(), static_cast<std::size_t>(a.points().size())));
  EXPECT_EQ(a.faces().offsets, b.faces().offsets);
  EXPECT_EQ(a.faces().indices, b.faces().indices);
}

inline void expect_same_fields(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].components, b[i].components);
    ASSERT_EQ(a[i].values.size(), b[i].values.size());
    EXPECT_TRUE(same_bits(a[i].values.data(), b[i].values.data(), a[i].values.size())) << a[i].name;
  }
}

inline std::vector<std::vector<Index>> faces_of(const PolygonMesh& mesh) {
  std::vector<std::vector<Index>> faces;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    faces.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
  return faces;
}

using Faces = std::vector<std::vector<Index>>;

}  // namespace carat::test
