// Wavefront OBJ: the vertices (v) and faces (f); every other line is passed over.

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "carat/io/face_collector.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

constexpr ScannerSyntax kSyntax{.comment = '#', .continuation = true};

bool recognises_obj(std::string_view content) {
  static constexpr std::array<std::string_view, 10> keywords = {
      "v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl", "vp"};
  Scanner scanner(content, kSyntax);
  if (!scanner.to_content()) return false;
  return std::find(keywords.begin(), keywords.end(), scanner.word()) != keywords.end();
}

/// 0-based number of a vertex from a face line: counted from 1, or back from the last one so far.
std::int64_t read_vertex(Scanner& scanner, std::int64_t n_vertices) {
  const std::int64_t number = scanner.integer();
  if (number > 0) return number - 1;
  if (number == 0) scanner.fail("vertex 0 does not exist; OBJ counts from 1");
  if (number < -n_vertices)
    scanner.fail("vertex " + std::to_string(number) + " does not exist; only " +
                 std::to_string(n_vertices) + " vertices come before this line");
  return n_vertices + number;
}

/// Passes over "/vt", "/vt/vn" or "//vn".
void skip_texture_and_normal(Scanner& scanner) {
  if (!scanner.take('/')) return;
  if (!scanner.take('/')) {
    scanner.integer();
    if (!scanner.take('/')) return;
  }
  scanner.integer();
}

void read_face(Scanner& scanner, std::int64_t n_vertices, FaceCollector& faces) {
  const std::size_t position = scanner.position();
  while (!scanner.at_line_end()) {
    faces.add_corner(read_vertex(scanner, n_vertices));
    skip_texture_and_normal(scanner);
  }
  faces.end_face(position);
}

/// Faces may name vertices that come later, so this waits for the last line.
void check_vertices_exist(const FaceCollector& faces, std::int64_t n_vertices,
                          std::string_view text) {
  for (Index f = 0; f < faces.size(); ++f)
    for (const Index v : faces.faces().row(f))
      if (v >= n_vertices)
        throw InvalidMesh(line_prefix(text, faces.position(f)) + "face " + std::to_string(f) +
                              ": vertex " + std::to_string(std::int64_t{v} + 1) +
                              " does not exist; the file has " + std::to_string(n_vertices) +
                              " vertices (v lines, counted from 1)",
                          {f});
}

MeshData read_obj(const FileContent& file) {
  Scanner scanner(file.bytes, kSyntax);
  Array<double> coordinates;
  FaceCollector faces;
  for (; scanner.to_content(); scanner.skip_line()) {
    const std::string_view keyword = scanner.word();
    if (keyword == "v") {
      for (int k = 0; k < 3; ++k) coordinates.push_back(scanner.coordinate());
    } else if (keyword == "f") {
      read_face(scanner, static_cast<std::int64_t>(coordinates.size() / 3), faces);
    }
  }
  if (coordinates.empty())
    throw IoError("holds no vertices (v lines), so it is no OBJ mesh; check the format");
  const auto n_vertices = static_cast<std::int64_t>(coordinates.size() / 3);
  check_vertices_exist(faces, n_vertices, file.bytes);
  Points points = Eigen::Map<const Points>(coordinates.data(), n_vertices, 3);
  return SurfaceData{faces.build(std::move(points), file.bytes), {}};
}

void write_obj(const std::filesystem::path& path, const PolygonMesh& mesh, const MeshFields&) {
  BufferedWriter out(path);
  const Points& points = mesh.points();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    out.put('v');
    for (int k = 0; k < 3; ++k) out.put(' ').put(points(v, k));
    out.put('\n');
  }
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    out.put('f');
    for (const Index v : mesh.face(f)) out.put(' ').put(std::int64_t{v} + 1);
    out.put('\n');
  }
  out.close();
}

}  // namespace

FormatEntry obj_format() {
  return {
      {"obj", "Wavefront OBJ", {".obj"}, true, true, false}, recognises_obj, read_obj, write_obj};
}

}  // namespace carat::detail
