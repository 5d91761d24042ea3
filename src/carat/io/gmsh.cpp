// Gmsh: versions 2.2 and 4.1, text and binary. Groups of 2-D elements become patches of volumes.
// Sections that are not nodes, elements, names or parts of the geometry are passed over.

#include <string>

#include "carat/base/error.h"
#include "carat/io/format.h"
#include "carat/io/gmsh_elements.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

bool recognises_gmsh(std::string_view content) {
  Scanner scanner(content);
  if (!scanner.to_content()) return false;
  const std::string_view word = scanner.word();
  return word == "$MeshFormat" || word == "$NOD" || word == "$PhysicalNames" || word == "$Comments";
}

class GmshReader {
 public:
  explicit GmshReader(const FileContent& file) : bytes_(file.bytes), scanner_(file.bytes) {}

  MeshData read() {
    while (scanner_.to_content()) {
      const std::string name(scanner_.word());
      if (!name.starts_with('$')) scanner_.fail(in_quotes(name) + " is no section of a Gmsh file");
      if (name.starts_with("$End")) continue;
      scanner_.skip_line();
      read_section(name);
      skip_to_end(name);
    }
    if (!has_nodes_ || !has_elements_)
      scanner_.fail(std::string("section ") + (has_nodes_ ? "$Elements" : "$Nodes") +
                    " is missing; the file is truncated, export it again");
    return mesh_.build();
  }

 private:
  void read_section(const std::string& name) {
    if (name == "$MeshFormat") return read_format();
    if (name == "$PhysicalNames") return read_names();
    const bool nodes = name == "$Nodes", elements = name == "$Elements";
    if (nodes || elements || name == "$Entities") {
      if (version_ == 0) scanner_.fail("section $MeshFormat is missing; the file is damaged");
      if (elements && !has_nodes_) scanner_.fail("elements come before the nodes");
      if ((nodes && has_nodes_) || (elements && has_elements_))
        scanner_.fail("section " + name + " is there twice; the file is damaged");
    }
    scanner_.set_encoding(encoding_);
    if (nodes) {
      has_nodes_ = true;
      version_ == 2 ? read_gmsh_2_nodes(scanner_, mesh_) : read_gmsh_4_nodes(scanner_, mesh_);
    } else if (elements) {
      has_elements_ = true;
      if (version_ == 2) {
        read_gmsh_2_elements(scanner_, mesh_);
      } else {
        read_gmsh_4_elements(scanner_, entities_, mesh_);
      }
    } else if (name == "$Entities" && version_ == 4) {
      entities_ = read_gmsh_4_entities(scanner_);
    }
    scanner_.set_encoding(Encoding::Text);
  }

  void read_format() {
    const double version = scanner_.number();
    const std::int64_t binary = scanner_.integer(), size = scanner_.integer();
    if (version == 2.2) version_ = 2;
    if (version == 4.1) version_ = 4;
    if (version_ == 0)
      scanner_.fail("version " + std::to_string(version) +
                    " of Gmsh's format; 2.2 or 4.1 is needed, save it as one of these");
    if (size != 8) scanner_.fail("numbers of " + std::to_string(size) + " bytes; 8 are needed");
    if (binary == 0) return;
    scanner_.skip_line();
    scanner_.set_encoding(Encoding::LittleEndian);
    const std::int64_t one = scanner_.whole(NumberType::Int32);
    if (one != 1 && one != 0x01000000) scanner_.fail("the mark of the byte order is damaged");
    encoding_ = one == 1 ? Encoding::LittleEndian : Encoding::BigEndian;
    scanner_.set_encoding(Encoding::Text);
  }

  void read_names() {
    const std::int64_t n = scanner_.whole(NumberType::Int64);
    scanner_.require(n, "names", 3, 0);
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int64_t dimension = scanner_.whole(NumberType::Int64);
      const std::int64_t group = scanner_.whole(NumberType::Int64);
      const std::string_view line = scanner_.rest_of_line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open != line.npos && close > open)
        mesh_.name_group(dimension, group, std::string(line.substr(open + 1, close - open - 1)));
    }
  }

  /// Moves behind the line that ends a section.
  void skip_to_end(const std::string& name) {
    const std::string end = "$End" + name.substr(1);
    const std::size_t at = bytes_.find(end, scanner_.position());
    if (at == bytes_.npos)
      scanner_.fail("the line " + end + " is missing; the file is truncated, export it again");
    scanner_.skip_bytes(at + end.size() - scanner_.position());
  }

  std::string_view bytes_;
  Scanner scanner_;
  Encoding encoding_ = Encoding::Text;
  int version_ = 0;
  bool has_nodes_ = false, has_elements_ = false;
  GmshEntities entities_;
  GmshMesh mesh_;
};

MeshData read_gmsh(const FileContent& file) { return GmshReader(file).read(); }

}  // namespace

FormatEntry gmsh_format() {
  return {.format = {"gmsh", "Gmsh", {".msh"}, true, false, true, true, false},
          .recognises = recognises_gmsh,
          .read = read_gmsh};
}

}  // namespace carat::detail
