// Object File Format: [ST][C][N]OFF in text or binary. Texture coordinates, normals and colours
// are passed over. In text each vertex and each face has its own line.

#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "carat/io/face_collector.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

constexpr ScannerSyntax kSyntax{.comment = '#'};

/// What the first word says, e.g. "STCNOFF".
struct Signature {
  bool valid = false;
  bool texture = false, colour = false, normal = false;
  bool four_dimensional = false, any_dimension = false;
};

Signature parse_signature(std::string_view word) {
  const auto take = [&word](std::string_view prefix) {
    if (!word.starts_with(prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  Signature signature;
  signature.texture = take("ST");
  signature.colour = take("C");
  signature.normal = take("N");
  signature.four_dimensional = take("4");
  signature.any_dimension = take("n");
  signature.valid = word == "OFF";
  return signature;
}

bool recognises_off(std::string_view content) {
  Scanner scanner(content, kSyntax);
  return scanner.to_content() && parse_signature(scanner.word()).valid;
}

struct Header {
  Signature signature;
  std::int64_t n_vertices = 0, n_faces = 0;
};

Header read_header(Scanner& scanner) {
  Header header;
  if (scanner.to_content()) header.signature = parse_signature(scanner.word());
  if (!header.signature.valid) scanner.fail("does not start with OFF, so it is no OFF file");
  if (header.signature.four_dimensional || header.signature.any_dimension)
    scanner.fail("holds points that are not 3-dimensional; only points in space are supported");
  Scanner look_ahead = scanner;
  if (look_ahead.word() == "BINARY") {
    scanner.skip_line();
    scanner.set_encoding(Encoding::BigEndian);
  }
  header.n_vertices = scanner.whole(NumberType::Int32);
  header.n_faces = scanner.whole(NumberType::Int32);
  if (scanner.encoding() == Encoding::Text) {
    scanner.skip_line();  // the number of edges is of no use, and often absent
  } else {
    scanner.whole(NumberType::Int32);
  }
  return header;
}

void to_line(Scanner& scanner, const char* what, std::int64_t i, std::int64_t n) {
  if (!scanner.to_content())
    scanner.fail(std::string("the file ends before ") + what + " " + std::to_string(i) + " of " +
                 std::to_string(n) + "; it is truncated, export it again");
}

SurfaceData read_text(Scanner& scanner, const Header& header, std::string_view text) {
  scanner.require(header.n_vertices, "vertices", 3, 0);
  Points points(header.n_vertices, 3);
  for (std::int64_t v = 0; v < header.n_vertices; ++v, scanner.skip_line()) {
    to_line(scanner, "vertex", v, header.n_vertices);
    for (int k = 0; k < 3; ++k) points(v, k) = scanner.coordinate();
  }
  scanner.require(header.n_faces, "faces", 1, 0);
  FaceCollector faces;
  faces.reserve(header.n_faces);
  for (std::int64_t f = 0; f < header.n_faces; ++f, scanner.skip_line()) {
    to_line(scanner, "face", f, header.n_faces);
    const std::size_t position = scanner.position();
    const std::int64_t size = scanner.integer();
    scanner.require(size, "vertices of a face", 1, 0);
    for (std::int64_t k = 0; k < size; ++k) faces.add_corner(scanner.integer());
    faces.end_face(position);
  }
  return {faces.build(std::move(points), text), {}};
}

SurfaceData read_binary(Scanner& scanner, const Header& header) {
  const std::int64_t extra = (header.signature.normal ? 3 : 0) + (header.signature.colour ? 4 : 0) +
                             (header.signature.texture ? 2 : 0);
  scanner.require(header.n_vertices, "vertices", 1, static_cast<std::size_t>(4 * (3 + extra)));
  Points points(header.n_vertices, 3);
  for (std::int64_t v = 0; v < header.n_vertices; ++v) {
    for (int k = 0; k < 3; ++k) points(v, k) = scanner.real(NumberType::Float32);
    scanner.skip_values(extra, NumberType::Float32);
  }
  scanner.require(header.n_faces, "faces", 1, 8);
  FaceCollector faces;
  faces.reserve(header.n_faces);
  for (std::int64_t f = 0; f < header.n_faces; ++f) {
    const std::int64_t size = scanner.whole(NumberType::Int32);
    scanner.require(size, "vertices of a face", 1, 4);
    for (std::int64_t k = 0; k < size; ++k) faces.add_corner(scanner.whole(NumberType::Int32));
    faces.end_face();
    scanner.skip_values(scanner.whole(NumberType::Int32), NumberType::Float32);
  }
  return {faces.build(std::move(points)), {}};
}

MeshData read_off(const FileContent& file) {
  Scanner scanner(file.bytes, kSyntax);
  const Header header = read_header(scanner);
  return scanner.encoding() == Encoding::Text ? read_text(scanner, header, file.bytes)
                                              : read_binary(scanner, header);
}

void write_off(const std::filesystem::path& path, const PolygonMesh& mesh, const MeshFields&) {
  BufferedWriter out(path);
  out.put("OFF\n").put(mesh.n_vertices()).put(' ').put(mesh.n_faces()).put(" 0\n");
  const Points& points = mesh.points();
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 3; ++k) out.put(points(v, k)).put(k < 2 ? ' ' : '\n');
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    out.put(mesh.face(f).size());
    for (const Index v : mesh.face(f)) out.put(' ').put(v);
    out.put('\n');
  }
  out.close();
}

}  // namespace

FormatEntry off_format() {
  return {{"off", "Object File Format", {".off"}, true, true, false},
          recognises_off,
          read_off,
          write_off};
}

}  // namespace carat::detail
