// STL: triangles without connectivity, in single precision binary or in text. Corners with equal
// coordinates become one vertex, numbered by first appearance.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/face_collector.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

/// The number of triangles which a binary header announces; -1 if there is no room for one.
std::int64_t announced_triangles(std::string_view content) {
  if (content.size() < kHeaderBytes + 4) return -1;
  Scanner scanner(content.substr(kHeaderBytes));
  scanner.set_encoding(Encoding::LittleEndian);
  return scanner.whole(NumberType::UInt32);
}

std::size_t binary_size(std::int64_t n_triangles) {
  return kHeaderBytes + 4 + static_cast<std::size_t>(n_triangles) * kTriangleBytes;
}

bool is_binary(std::string_view content) {
  const std::int64_t n = announced_triangles(content);
  return n >= 0 && content.size() == binary_size(n);
}

bool is_text(std::string_view content) {
  Scanner scanner(content);
  return scanner.to_content() && scanner.word() == "solid";
}

bool recognises_stl(std::string_view content) {
  return is_binary(content) || (is_text(content) && content.find("facet") != content.npos);
}

Array<double> read_binary(std::string_view content) {
  const std::int64_t n = std::max<std::int64_t>(announced_triangles(content), 0);
  if (!is_binary(content))
    throw IoError("is no STL file: it does not start with 'solid', and a binary one of " +
                  std::to_string(n) + " triangles has " + std::to_string(binary_size(n)) +
                  " bytes, not " + std::to_string(content.size()) + "; export it again");
  Scanner scanner(content.substr(kHeaderBytes + 4));
  scanner.set_encoding(Encoding::LittleEndian);
  Array<double> coordinates;
  coordinates.reserve(static_cast<std::size_t>(n) * 9);
  for (std::int64_t t = 0; t < n; ++t) {
    scanner.skip_values(3, NumberType::Float32);
    for (int k = 0; k < 9; ++k) {
      const double value = scanner.real(NumberType::Float32);
      if (!std::isfinite(value))
        throw IoError("triangle " + std::to_string(t) + ": coordinate " + std::to_string(value) +
                      "; every coordinate must be a finite number");
      coordinates.push_back(value);
    }
    scanner.skip_values(1, NumberType::UInt16);
  }
  return coordinates;
}

/// \param positions  receives where each facet starts
Array<double> read_text(std::string_view content, Array<std::size_t>& positions) {
  Scanner scanner(content);
  Array<double> coordinates;
  std::size_t facet_end = 0;
  bool in_facet = false, complete = false;
  for (; scanner.to_content(); scanner.skip_line()) {
    const std::size_t position = scanner.position();
    std::string keyword(scanner.word());
    for (char& c : keyword)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    complete = keyword == "endsolid";
    if (keyword == "facet" && !in_facet) {
      in_facet = true;
      facet_end = coordinates.size() + 9;
      positions.push_back(position);
    } else if (keyword == "vertex" && in_facet) {
      for (int k = 0; k < 3; ++k) coordinates.push_back(scanner.coordinate());
    } else if (keyword == "endfacet" && in_facet) {
      in_facet = false;
      if (coordinates.size() != facet_end)
        scanner.fail("a facet that has not 3 vertices; export the file again");
    } else if (keyword != "solid" && keyword != "endsolid" && keyword != "outer" &&
               keyword != "endloop") {
      scanner.fail(in_quotes(keyword) + " is not expected here; the file is damaged");
    }
  }
  if (!complete || in_facet)
    scanner.fail("the file ends before endsolid; it is truncated, export it again");
  return coordinates;
}

struct Corner {
  double x, y, z;
  Index number;
};

/// Number of the vertex of every corner; `firsts` receives the first corner of every vertex.
Array<Index> weld(const Array<double>& coordinates, Array<Index>& firsts) {
  const std::size_t n = coordinates.size() / 3;
  Array<Corner> corners(n);
  for (std::size_t c = 0; c < n; ++c) {
    // Adding 0 turns -0 into +0.
    const double* const at = coordinates.data() + 3 * c;
    corners[c] = {at[0] + 0.0, at[1] + 0.0, at[2] + 0.0, static_cast<Index>(c)};
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.x, a.y, a.z, a.number) < std::tie(b.x, b.y, b.z, b.number);
  });
  Array<Index> first_equal(n);
  for (std::size_t i = 0, first = 0; i < n; ++i) {
    const Corner &a = corners[first], &b = corners[i];
    if (a.x != b.x || a.y != b.y || a.z != b.z) first = i;
    first_equal[static_cast<std::size_t>(b.number)] = corners[first].number;
  }
  Array<Index> vertex_of(n);
  for (std::size_t c = 0; c < n; ++c) {
    const auto first = static_cast<std::size_t>(first_equal[c]);
    if (first == c) {
      vertex_of[c] = static_cast<Index>(firsts.size());
      firsts.push_back(static_cast<Index>(c));
    } else {
      vertex_of[c] = vertex_of[first];
    }
  }
  return vertex_of;
}

MeshData read_stl(const FileContent& file) {
  FaceCollector faces;
  Array<std::size_t> positions;
  const Array<double> coordinates = is_binary(file.bytes) || !is_text(file.bytes)
                                        ? read_binary(file.bytes)
                                        : read_text(file.bytes, positions);
  if (coordinates.size() / 3 > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw IoError(std::to_string(coordinates.size() / 9) +
                  " triangles are more than 32-bit numbers can count; split the mesh");
  Array<Index> firsts;
  const Array<Index> vertex_of = weld(coordinates, firsts);
  Points points(static_cast<Eigen::Index>(firsts.size()), 3);
  for (std::size_t v = 0; v < firsts.size(); ++v)
    for (int k = 0; k < 3; ++k)
      points(static_cast<Eigen::Index>(v), k) =
          coordinates[3 * static_cast<std::size_t>(firsts[v]) + static_cast<std::size_t>(k)];
  for (std::size_t c = 0; c < vertex_of.size(); ++c) {
    faces.add_corner(vertex_of[c]);
    if (c % 3 != 2) continue;
    if (positions.empty()) {
      faces.end_face();
    } else {
      faces.end_face(positions[c / 3]);
    }
  }
  return SurfaceData{faces.build(std::move(points), file.bytes), {}};
}

}  // namespace

FormatEntry stl_format() {
  return {{"stl", "STL", {".stl"}, true, false, false}, recognises_stl, read_stl, nullptr};
}

}  // namespace carat::detail
