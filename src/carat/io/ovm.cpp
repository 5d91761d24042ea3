// OVM: OpenVolumeMesh's text format. Edge e has the halfedges 2e and 2e+1, the latter backwards;
// face f the halffaces 2f and 2f+1. Cells name the halffaces that point inwards.

#include <array>
#include <charconv>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "carat/io/face_collector.h"
#include "carat/io/format.h"
#include "carat/io/scanner.h"
#include "carat/io/vtk_attributes.h"
#include "carat/io/vtk_cells.h"

namespace carat::detail {
namespace {

constexpr ScannerSyntax kSyntax{.comment = '#'};

bool take_header(Scanner& scanner) {
  return scanner.to_content() && upper_case(scanner.word()) == "OVM" &&
         upper_case(scanner.word()) == "ASCII";
}

bool recognises_ovm(std::string_view content) {
  Scanner scanner(content, kSyntax);
  return take_header(scanner);
}

/// The number of elements behind the section's name.
std::int64_t read_section(Scanner& scanner, const char* name, const char* what,
                          std::size_t values) {
  if (!scanner.to_content() || upper_case(scanner.word()) != upper_case(name))
    scanner.fail("section " + std::string(name) +
                 " is missing; the file is truncated or damaged, export it again");
  const std::int64_t n = scanner.whole(NumberType::Int64);
  scanner.require(n, what, values, 0);
  return n;
}

std::int64_t read_id(Scanner& scanner, std::int64_t n, const char* what) {
  const std::int64_t id = scanner.whole(NumberType::Int64);
  if (id < 0 || id >= n)
    scanner.fail(std::string(what) + " " + std::to_string(id) + " does not exist; the file has " +
                 std::to_string(n) + ", numbered from 0");
  return id;
}

Points read_vertices(Scanner& scanner) {
  const std::int64_t n = read_section(scanner, "Vertices", "vertices", 3);
  Points points(n, 3);
  for (std::int64_t v = 0; v < n; ++v)
    for (int k = 0; k < 3; ++k) {
      if (!scanner.to_content()) scanner.fail("the file ends before vertex " + std::to_string(v));
      points(v, k) = scanner.coordinate();
    }
  return points;
}

using Edges = std::vector<std::array<std::int64_t, 2>>;

Edges read_edges(Scanner& scanner, std::int64_t n_vertices) {
  Edges edges(static_cast<std::size_t>(read_section(scanner, "Edges", "edges", 2)));
  for (auto& edge : edges)
    for (std::int64_t& v : edge) v = read_id(scanner, n_vertices, "vertex");
  return edges;
}

/// Faces by their first vertices of each halfedge.
void read_faces(Scanner& scanner, const Edges& edges, FaceCollector& faces) {
  const std::int64_t n = read_section(scanner, "Faces", "faces", 1);
  faces.reserve(n);
  const auto n_halfedges = static_cast<std::int64_t>(2 * edges.size());
  for (std::int64_t f = 0; f < n; ++f) {
    const std::int64_t size = scanner.whole(NumberType::Int64);
    scanner.require(size, "halfedges of a face", 1, 0);
    const std::size_t position = scanner.position();
    std::int64_t start = -1, end = -1;
    const auto expect = [&](std::int64_t vertex) {
      if (vertex != end)
        scanner.fail("face " + std::to_string(f) + ": a halfedge starts at vertex " +
                     std::to_string(vertex) + ", but the one before it ends at vertex " +
                     std::to_string(end) + "; correct the face");
    };
    for (std::int64_t k = 0; k < size; ++k) {
      const auto h = static_cast<std::size_t>(read_id(scanner, n_halfedges, "halfedge"));
      const auto& edge = edges[h / 2];
      const std::int64_t from = edge[h % 2];
      if (k == 0) {
        start = from;
      } else {
        expect(from);
      }
      end = edge[1 - h % 2];
      faces.add_corner(from);
    }
    if (size > 0) expect(start);
    faces.end_face(position);
  }
}

Csr read_cells(Scanner& scanner, Index n_faces) {
  Csr cells;
  if (!scanner.to_content()) return cells;
  const std::int64_t n = read_section(scanner, "Polyhedra", "polyhedra", 1);
  cells.offsets.reserve(static_cast<std::size_t>(n) + 1);
  for (std::int64_t c = 0; c < n; ++c) {
    const std::int64_t size = scanner.whole(NumberType::Int64);
    scanner.require(size, "halffaces of a cell", 1, 0);
    for (std::int64_t k = 0; k < size; ++k)
      cells.indices.push_back(
          static_cast<Index>(read_id(scanner, 2 * std::int64_t{n_faces}, "halfface") / 2));
    if (cells.indices.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      scanner.fail("more faces of cells than 2^31 - 1; split the mesh");
    cells.offsets.push_back(static_cast<Index>(cells.indices.size()));
  }
  return cells;
}

/// One of the sections behind the mesh, e.g. `VProp double "u"`.
struct PropertyHeader {
  enum class Of { Vertices, Faces, Cells, Others } of = Of::Others;
  std::string type, name;
};

bool is_property(const std::string& word) {
  return word.ends_with("PROP") || word.ends_with("_PROPERTY");
}

PropertyHeader read_property_header(Scanner& scanner, const std::string& keyword) {
  PropertyHeader header;
  if (keyword == "VPROP" || keyword == "VERTEX_PROPERTY") {
    header.of = PropertyHeader::Of::Vertices;
  } else if (keyword == "FPROP" || keyword == "FACE_PROPERTY") {
    header.of = PropertyHeader::Of::Faces;
  } else if (keyword == "CPROP" || keyword == "CELL_PROPERTY" || keyword == "POLYHEDRON_PROPERTY") {
    header.of = PropertyHeader::Of::Cells;
  }
  const std::string_view line = scanner.rest_of_line();
  const std::size_t open = line.find('"'), close = line.rfind('"');
  for (const char c : line.substr(0, open))
    if (c != ' ' && c != '\t') header.type += c;
  if (open != line.npos && close > open) header.name = line.substr(open + 1, close - open - 1);
  return header;
}

/// Numbers in a value of this type: 1 of "double", 3 of "vec3d", 0 if it is no numbers.
int components_of(std::string_view type) {
  for (const char* scalar : {"bool", "int", "uint", "unsignedint", "short", "ushort",
                             "unsignedshort", "long", "ulong", "unsignedlong", "float", "double"})
    if (type == scalar) return 1;
  if (!type.starts_with("vec")) return 0;
  int n = 0;
  const auto [stop, status] = std::from_chars(type.data() + 3, type.data() + type.size(), n);
  const std::string_view scalar = type.substr(static_cast<std::size_t>(stop - type.data()));
  const bool numbers = scalar == "d" || scalar == "f" || scalar == "i" || scalar == "ui";
  return status == std::errc() && numbers && n > 0 ? n : 0;
}

Field read_values(Scanner& scanner, const PropertyHeader& header, std::int64_t n) {
  Field field{header.name, components_of(header.type), {}};
  scanner.require(n * field.components, "values of a property", 1, 0);
  field.values.resize(static_cast<std::size_t>(n * field.components));
  for (double& value : field.values) value = scanner.real(NumberType::Float64);
  return field;
}

void skip_to_next_property(Scanner& scanner) {
  while (scanner.to_content()) {
    Scanner look_ahead = scanner;
    if (is_property(upper_case(look_ahead.word()))) return;
    scanner.skip_line();
  }
}

struct Properties {
  std::vector<Field> vertex, face, cell;
  std::vector<Field> face_flags;  ///< of type bool
};

/// Properties of other elements, and values that are no numbers, are passed over.
Properties read_properties(Scanner& scanner, std::int64_t n_vertices, std::int64_t n_faces,
                           std::int64_t n_cells) {
  using Of = PropertyHeader::Of;
  Properties properties;
  while (scanner.to_content()) {
    const std::string keyword = upper_case(scanner.word());
    if (!is_property(keyword))
      scanner.fail(in_quotes(keyword) + " is no property; the file is damaged");
    const PropertyHeader header = read_property_header(scanner, keyword);
    if (header.of == Of::Others || header.name.empty() || components_of(header.type) == 0) {
      skip_to_next_property(scanner);
    } else if (header.of == Of::Vertices) {
      add_field(properties.vertex, read_values(scanner, header, n_vertices));
    } else if (header.of == Of::Cells) {
      add_field(properties.cell, read_values(scanner, header, n_cells));
    } else {
      add_field(header.type == "bool" ? properties.face_flags : properties.face,
                read_values(scanner, header, n_faces));
    }
  }
  return properties;
}

/// A set of faces is a patch if it lies on the boundary.
std::vector<BoundaryPatch> to_patches(const PolyhedralMesh& mesh,
                                      const std::vector<Field>& face_flags) {
  std::vector<BoundaryPatch> patches;
  for (const Field& flags : face_flags) {
    // Where faces were merged, the file's numbers are no longer those of the mesh.
    if (flags.n_rows() != mesh.n_faces()) continue;
    BoundaryPatch patch{flags.name, "", {}};
    bool on_boundary = true;
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      if (flags.values[static_cast<std::size_t>(f)] == 0) continue;
      patch.faces.push_back(f);
      on_boundary = on_boundary && mesh.face_cells()[static_cast<std::size_t>(f)].boundary();
    }
    if (on_boundary) patches.push_back(std::move(patch));
  }
  return patches;
}

MeshData read_ovm(const FileContent& file) {
  Scanner scanner(file.bytes, kSyntax);
  if (!take_header(scanner)) scanner.fail("does not start with 'OVM ASCII', so it is no OVM file");
  Points points = read_vertices(scanner);
  const Edges edges = read_edges(scanner, points.rows());
  FaceCollector faces;
  read_faces(scanner, edges, faces);
  Csr cells = read_cells(scanner, faces.size());
  Properties properties = read_properties(scanner, points.rows(), faces.size(), cells.n_rows());
  if (cells.n_rows() == 0) {
    for (Field& flags : properties.face_flags) add_field(properties.face, std::move(flags));
    return SurfaceData{faces.build(std::move(points), file.bytes),
                       {std::move(properties.vertex), std::move(properties.face)}};
  }
  PolyhedralMesh mesh(std::move(points), faces.take(), std::move(cells));
  std::vector<BoundaryPatch> patches = to_patches(mesh, properties.face_flags);
  return VolumeData{std::move(mesh),
                    {std::move(properties.vertex), {}, std::move(properties.cell)},
                    std::move(patches)};
}

void write_mesh(BufferedWriter& out, const PolyhedralMesh& mesh) {
  out.put("OVM ASCII\nVertices\n").put(mesh.n_vertices()).put('\n');
  const Points& points = mesh.points();
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    for (int k = 0; k < 3; ++k) out.put(points(v, k)).put(k < 2 ? ' ' : '\n');
  const EdgeTopology& edges = mesh.face_mesh().edges();
  out.put("Edges\n").put(edges.size()).put('\n');
  for (const auto& edge : edges.vertices) out.put(edge[0]).put(' ').put(edge[1]).put('\n');
  const Csr& faces = mesh.face_mesh().faces();
  out.put("Faces\n").put(faces.n_rows()).put('\n');
  for (Index f = 0; f < faces.n_rows(); ++f) {
    out.put(faces.size(f));
    for (Index corner = faces.begin(f); corner < faces.end(f); ++corner) {
      const Index e = edges.of_corner[static_cast<std::size_t>(corner)];
      const bool backwards = edges.vertices[static_cast<std::size_t>(e)][0] !=
                             faces.indices[static_cast<std::size_t>(corner)];
      out.put(' ').put(2 * std::int64_t{e} + (backwards ? 1 : 0));
    }
    out.put('\n');
  }
  out.put("Polyhedra\n").put(mesh.n_cells()).put('\n');
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    out.put(mesh.cell(c).size());
    for (const Index f : mesh.cell(c)) {
      const bool outwards = mesh.face_cells()[static_cast<std::size_t>(f)].below == c;
      out.put(' ').put(2 * std::int64_t{f} + (outwards ? 1 : 0));
    }
    out.put('\n');
  }
}

/// Names that the format can hold, each once.
class PropertyNames {
 public:
  std::string make(std::string name) {
    for (char& c : name)
      if (c == '"' || static_cast<unsigned char>(c) < ' ') c = '_';
    while (!used_.insert(name).second) name += '_';
    return name;
  }

 private:
  std::set<std::string> used_;
};

void write_fields(BufferedWriter& out, const char* keyword, const std::vector<Field>& fields) {
  PropertyNames names;
  for (const Field& field : fields) {
    out.put(keyword);
    if (field.components == 1) {
      out.put(" double");
    } else {
      out.put(" vec").put(field.components).put('d');
    }
    out.put(" \"").put(names.make(field.name)).put("\"\n");
    const auto components = static_cast<std::size_t>(field.components);
    for (std::size_t i = 0; i < field.values.size(); ++i)
      out.put(field.values[i]).put((i + 1) % components == 0 ? '\n' : ' ');
  }
}

void write_patches(BufferedWriter& out, Index n_faces, const std::vector<BoundaryPatch>& patches) {
  PropertyNames names;
  std::vector<bool> flags(static_cast<std::size_t>(n_faces));
  for (const BoundaryPatch& patch : patches) {
    flags.assign(flags.size(), false);
    for (const Index f : patch.faces) flags[static_cast<std::size_t>(f)] = true;
    out.put("FProp bool \"").put(names.make(patch.name)).put("\"\n");
    for (const bool flag : flags) out.put(flag ? "1\n" : "0\n");
  }
}

void write_volume_ovm(const std::filesystem::path& path, const PolyhedralMesh& mesh,
                      const MeshFields& fields, const std::vector<BoundaryPatch>& patches) {
  BufferedWriter out(path);
  write_mesh(out, mesh);
  write_fields(out, "VProp", fields.vertex);
  write_patches(out, mesh.n_faces(), patches);
  write_fields(out, "CProp", fields.cell);
  out.close();
}

}  // namespace

FormatEntry ovm_format() {
  return {.format = {"ovm", "OpenVolumeMesh", {".ovm"}, true, false, true, true, true, true, true},
          .recognises = recognises_ovm,
          .read = read_ovm,
          .write_volume = write_volume_ovm};
}

}  // namespace carat::detail
