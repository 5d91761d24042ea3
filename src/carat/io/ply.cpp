// Stanford PLY: the elements "vertex" (x, y, z) and "face" (vertex_indices). Their other scalar
// properties become fields, lists and other elements are passed over. Properties that follow each
// other as nx ny nz, name_x name_y name_z or name_0 name_1 ... are the components of one field.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "carat/io/face_collector.h"
#include "carat/io/format.h"
#include "carat/io/ply_header.h"
#include "carat/io/scanner.h"

namespace carat::detail {
namespace {

constexpr const char* kNormals = "normals";

bool recognises_ply(std::string_view content) {
  return content.starts_with("ply\n") || content.starts_with("ply\r\n");
}

/// Where the values of a property go: a coordinate, a field, or nowhere.
struct Target {
  int coordinate = -1;
  int field = -1;
  Index component = 0;
};

struct Layout {
  std::vector<Target> targets;  ///< one a property
  std::vector<Field> fields;
};

/// Name of component `k` of a field of that many components.
std::string component_name(const std::string& field, Index components, Index k) {
  if (components == 1) return field;
  if (components == 3)
    return field == kNormals ? std::string("n") + "xyz"[k] : field + "_" + "xyz"[k];
  return field + "_" + std::to_string(k);
}

/// The field that starts at property `first`: its name and how many properties it takes.
std::pair<std::string, Index> group_at(const std::vector<PlyProperty>& properties,
                                       std::size_t first) {
  const auto follows = [&](const std::string& field, Index components, Index k) {
    const std::size_t i = first + static_cast<std::size_t>(k);
    return i < properties.size() && !properties[i].is_list &&
           properties[i].name == component_name(field, components, k);
  };
  const auto is_free = [&](const std::string& field) {
    return std::none_of(properties.begin(), properties.end(),
                        [&](const PlyProperty& other) { return other.name == field; });
  };
  const auto vector_of = [&](const std::string& field) {
    return follows(field, 3, 0) && follows(field, 3, 1) && follows(field, 3, 2) && is_free(field);
  };
  const std::string& name = properties[first].name;
  if (vector_of(kNormals)) return {kNormals, 3};
  if (name.size() > 2) {
    const std::string base = name.substr(0, name.size() - 2);
    if (vector_of(base)) return {base, 3};
    Index components = 0;
    while (follows(base, 2, components)) ++components;
    if (components > 1 && is_free(base)) return {base, components};
  }
  return {name, 1};
}

int coordinate_of(const PlyProperty& property) {
  if (property.is_list || property.name.size() != 1) return -1;
  const std::size_t k = std::string_view("xyz").find(property.name[0]);
  return k == std::string_view::npos ? -1 : static_cast<int>(k);
}

Layout plan_layout(const PlyElement& element, bool has_coordinates) {
  Layout layout;
  layout.targets.resize(element.properties.size());
  for (std::size_t p = 0; p < element.properties.size();) {
    Target& target = layout.targets[p];
    if (has_coordinates) target.coordinate = coordinate_of(element.properties[p]);
    if (element.properties[p].is_list || target.coordinate >= 0) {
      ++p;
      continue;
    }
    const auto [name, components] = group_at(element.properties, p);
    for (Index k = 0; k < components; ++k)
      layout.targets[p++] = {-1, static_cast<int>(layout.fields.size()), k};
    Field field{name, components, {}};
    field.values.resize(static_cast<std::size_t>(element.count) *
                        static_cast<std::size_t>(components));
    layout.fields.push_back(std::move(field));
  }
  return layout;
}

/// Least size of an element: a list may be empty, but its length is there.
void require_room(const Scanner& scanner, const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties)
    bytes += size_of(property.is_list ? property.count_type : property.type);
  const bool known = element.name == "vertex" || element.name == "face";
  scanner.require(element.count,
                  known ? (element.name == "face" ? "faces" : "vertices") : "elements",
                  element.properties.size(), bytes);
}

void store(Layout& layout, const Target& target, std::int64_t row, double value) {
  Field& field = layout.fields[static_cast<std::size_t>(target.field)];
  field.values[static_cast<std::size_t>(row * field.components + target.component)] = value;
}

void skip_list(Scanner& scanner, const PlyProperty& property) {
  scanner.skip_values(scanner.whole(property.count_type), property.type);
}

Points read_vertices(Scanner& scanner, const PlyElement& element, std::vector<Field>& fields) {
  Layout layout = plan_layout(element, true);
  std::array<bool, 3> found{};
  for (const Target& target : layout.targets)
    if (target.coordinate >= 0) found[static_cast<std::size_t>(target.coordinate)] = true;
  if (!(found[0] && found[1] && found[2]))
    throw IoError("the PLY element vertex has no properties x, y and z; export it again");
  Points points(element.count, 3);
  for (std::int64_t v = 0; v < element.count; ++v)
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const Target& target = layout.targets[p];
      if (property.is_list) {
        skip_list(scanner, property);
        continue;
      }
      const double value = scanner.real(property.type);
      if (target.coordinate < 0) {
        store(layout, target, v, value);
        continue;
      }
      if (!std::isfinite(value))
        scanner.fail("vertex " + std::to_string(v) + ": coordinate " + property.name + " is " +
                     std::to_string(value) + "; every coordinate must be a finite number");
      points(v, target.coordinate) = value;
    }
  fields = std::move(layout.fields);
  return points;
}

void read_corners(Scanner& scanner, const PlyProperty& property, FaceCollector& faces) {
  const std::int64_t size = scanner.whole(property.count_type);
  scanner.require(size, "vertices of a face", 1, size_of(property.type));
  for (std::int64_t k = 0; k < size; ++k) faces.add_corner(scanner.whole(property.type));
}

void read_faces(Scanner& scanner, const PlyElement& element, FaceCollector& faces,
                std::vector<Field>& fields) {
  Layout layout = plan_layout(element, false);
  const auto corners = std::find_if(
      element.properties.begin(), element.properties.end(), [](const PlyProperty& property) {
        return property.is_list &&
               (property.name == "vertex_indices" || property.name == "vertex_index");
      });
  if (corners == element.properties.end() && element.count > 0)
    throw IoError("the PLY element face has no list vertex_indices; export it again");
  faces.reserve(element.count);
  for (std::int64_t f = 0; f < element.count; ++f) {
    if (scanner.encoding() == Encoding::Text) scanner.to_content();
    const std::size_t position = scanner.position();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (&property == &*corners) {
        read_corners(scanner, property, faces);
      } else if (property.is_list) {
        skip_list(scanner, property);
      } else {
        store(layout, layout.targets[p], f, scanner.real(property.type));
      }
    }
    if (scanner.encoding() == Encoding::Text) {
      faces.end_face(position);
    } else {
      faces.end_face();
    }
  }
  fields = std::move(layout.fields);
}

void skip_element(Scanner& scanner, const PlyElement& element) {
  if (element.properties.empty()) return;
  for (std::int64_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties)
      if (property.is_list) {
        skip_list(scanner, property);
      } else {
        scanner.skip_values(1, property.type);
      }
}

MeshData read_ply(const FileContent& file) {
  Scanner scanner(file.bytes);
  const std::vector<PlyElement> elements = read_ply_header(scanner);
  const auto has = [&](std::string_view name) {
    return std::count_if(elements.begin(), elements.end(),
                         [&](const PlyElement& element) { return element.name == name; });
  };
  if (has("vertex") != 1 || has("face") > 1)
    throw IoError("the PLY header needs one element vertex and at most one element face");
  if (has("tristrips") > 0 && has("face") == 0)
    throw IoError("holds triangle strips instead of faces; export it with faces");
  Points points;
  FaceCollector faces;
  MeshFields fields;
  for (const PlyElement& element : elements) {
    require_room(scanner, element);
    if (element.name == "vertex") {
      points = read_vertices(scanner, element, fields.vertex);
    } else if (element.name == "face") {
      read_faces(scanner, element, faces, fields.face);
    } else {
      skip_element(scanner, element);
    }
  }
  return SurfaceData{faces.build(std::move(points), file.bytes), std::move(fields)};
}

/// Property names for all components of all fields: without blanks, and none of them twice.
std::vector<std::string> property_names(const std::vector<Field>& fields,
                                        std::vector<std::string> taken) {
  const std::size_t first = taken.size();
  for (const Field& field : fields) {
    std::string base = field.name;
    for (char& c : base)
      if (c <= ' ' || c == '\x7f') c = '_';
    const auto collides = [&] {
      for (Index k = 0; k < field.components; ++k)
        if (std::find(taken.begin(), taken.end(), component_name(base, field.components, k)) !=
            taken.end())
          return true;
      return false;
    };
    while (collides()) base += '_';
    for (Index k = 0; k < field.components; ++k)
      taken.push_back(component_name(base, field.components, k));
  }
  taken.erase(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(first));
  return taken;
}

template <class T>
void put_little_endian(BufferedWriter& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if constexpr (std::endian::native != std::endian::little) std::reverse(bytes, bytes + sizeof(T));
  out.put_bytes(bytes, sizeof(T));
}

void put_field_row(BufferedWriter& out, const std::vector<Field>& fields, Index row) {
  for (const Field& field : fields)
    for (Index k = 0; k < field.components; ++k)
      put_little_endian(
          out,
          field.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(field.components) +
                       static_cast<std::size_t>(k)]);
}

void write_ply(const std::filesystem::path& path, const PolygonMesh& mesh,
               const MeshFields& fields) {
  std::size_t longest_face = 0;
  for (Index f = 0; f < mesh.n_faces(); ++f)
    longest_face = std::max(longest_face, mesh.face(f).size());
  const bool short_faces = longest_face <= 255;
  BufferedWriter out(path);
  out.put("ply\nformat binary_little_endian 1.0\nelement vertex ").put(mesh.n_vertices());
  out.put("\nproperty double x\nproperty double y\nproperty double z\n");
  for (const std::string& name : property_names(fields.vertex, {"x", "y", "z"}))
    out.put("property double ").put(name).put('\n');
  out.put("element face ").put(mesh.n_faces());
  out.put(short_faces ? "\nproperty list uchar int vertex_indices\n"
                      : "\nproperty list int int vertex_indices\n");
  for (const std::string& name : property_names(fields.face, {"vertex_indices"}))
    out.put("property double ").put(name).put('\n');
  out.put("end_header\n");
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    for (int k = 0; k < 3; ++k) put_little_endian(out, mesh.points()(v, k));
    put_field_row(out, fields.vertex, v);
  }
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const auto face = mesh.face(f);
    if (short_faces) {
      put_little_endian(out, static_cast<std::uint8_t>(face.size()));
    } else {
      put_little_endian(out, static_cast<std::int32_t>(face.size()));
    }
    for (const Index v : face) put_little_endian(out, v);
    put_field_row(out, fields.face, f);
  }
  out.close();
}

}  // namespace

FormatEntry ply_format() {
  return {{"ply", "Stanford PLY", {".ply"}, true, true, true}, recognises_ply, read_ply, write_ply};
}

}  // namespace carat::detail
