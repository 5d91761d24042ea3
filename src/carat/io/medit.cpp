// Medit (also INRIA .mesh): sections of vertices and elements in text. What is neither, such as
// edges, corners and normals, is passed over.

#include <array>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/element_collector.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

constexpr ScannerSyntax kSyntax{.comment = '#'};

bool recognises_medit(std::string_view content) {
  Scanner scanner(content, kSyntax);
  return scanner.to_content() && scanner.word().starts_with("MeshVersionFormatted");
}

const std::pair<const char*, ElementShape> kSections[] = {
    {"Triangles", ElementShape::Triangle},     {"Quadrilaterals", ElementShape::Quadrilateral},
    {"Tetrahedra", ElementShape::Tetrahedron}, {"Hexahedra", ElementShape::Hexahedron},
    {"Hexaedra", ElementShape::Hexahedron},    {"Prisms", ElementShape::Wedge},
    {"Wedges", ElementShape::Wedge},           {"Pyramids", ElementShape::Pyramid}};

class MeditReader {
 public:
  explicit MeditReader(const FileContent& file) : scanner_(file.bytes, kSyntax) {}

  MeshData read() {
    if (!scanner_.to_content() || scanner_.word() != "MeshVersionFormatted")
      scanner_.fail("does not start with MeshVersionFormatted, so it is no Medit text file");
    const std::int64_t version = whole();
    if (version < 1 || version > 4)
      scanner_.fail("version " + std::to_string(version) + " of Medit's format is not known");
    bool ended = false;
    while (!ended && scanner_.to_content()) ended = read_section(std::string(scanner_.word()));
    if (!has_vertices_) scanner_.fail("section Vertices is missing; the file is truncated");
    return elements_.build(std::move(points_), "reference",
                           [](std::int64_t group) { return std::to_string(group); });
  }

 private:
  std::int64_t whole() { return scanner_.whole(NumberType::Int64); }

  /// False until the end is named.
  bool read_section(const std::string& name) {
    if (name == "End") return true;
    if (name == "Dimension") {
      dimension_ = whole();
      if (dimension_ != 2 && dimension_ != 3)
        scanner_.fail("dimension " + std::to_string(dimension_) + "; 2 or 3 is needed");
    } else if (name == "Vertices") {
      read_vertices();
    } else {
      for (const auto& [section, shape] : kSections)
        if (name == section) {
          read_elements(shape);
          return false;
        }
      refuse_curved(name);
      skip_section(name);
    }
    return false;
  }

  void read_vertices() {
    if (has_vertices_) scanner_.fail("section Vertices is there twice; the file is damaged");
    has_vertices_ = true;
    const std::int64_t n = whole();
    scanner_.require(n, "vertices", static_cast<std::size_t>(dimension_) + 1, 0);
    points_ = Points::Zero(n, 3);
    for (std::int64_t v = 0; v < n; ++v) {
      for (std::int64_t k = 0; k < dimension_; ++k) {
        if (!scanner_.to_content())
          scanner_.fail("the file ends before vertex " + std::to_string(v + 1));
        points_(v, k) = scanner_.coordinate();
      }
      scanner_.real(NumberType::Float64);  // the reference
    }
  }

  void read_elements(ElementShape shape) {
    if (!has_vertices_) scanner_.fail("elements come before the vertices; the file is damaged");
    const std::size_t size = n_vertices_of(shape);
    const std::int64_t n = whole();
    scanner_.require(n, "elements", size + 1, 0);
    std::array<std::int64_t, 8> vertices{};
    for (std::int64_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < size; ++k) {
        const std::int64_t v = whole();
        if (v < 1 || v > points_.rows())
          scanner_.fail("vertex " + std::to_string(v) +
                        " does not exist; the file has vertices 1 to " +
                        std::to_string(points_.rows()));
        vertices[k] = v - 1;
      }
      elements_.add(shape, std::span(vertices).first(size), whole());
    }
  }

  void refuse_curved(const std::string& name) {
    for (const char* shape :
         {"TrianglesP", "QuadrilateralsQ", "TetrahedraP", "HexahedraQ", "PrismsP", "PyramidsP"})
      if (name.starts_with(shape))
        scanner_.fail("holds " + in_quotes(name) +
                      ", which are curved; convert to elements of first order");
  }

  /// Numbers up to the next name.
  void skip_section(const std::string& name) {
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    if (!is_letter(name.front()))
      scanner_.fail(in_quotes(name) + " is no section of a Medit file; the file is damaged");
    while (scanner_.to_content()) {
      Scanner look_ahead = scanner_;
      const std::string_view word = look_ahead.word();
      if (is_letter(word.front()) && word != "nan" && word != "inf") return;
      scanner_ = look_ahead;
    }
  }

  Scanner scanner_;
  std::int64_t dimension_ = 3;
  bool has_vertices_ = false;
  Points points_;
  ElementCollector elements_;
};

MeshData read_medit(const FileContent& file) { return MeditReader(file).read(); }

}  // namespace

FormatEntry medit_format() {
  return {.format = {"medit", "Medit", {".mesh"}, true, false, true, true, false},
          .recognises = recognises_medit,
          .read = read_medit};
}

}  // namespace carat::detail
