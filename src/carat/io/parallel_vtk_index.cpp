// The index file of PVTU and PVTP.

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/io/buffered_writer.h"
#include "carat/io/parallel_vtk.h"
#include "carat/io/vtk_xml.h"

namespace carat {
namespace {

/// A text as the value of an attribute.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

void put_arrays(detail::BufferedWriter& file, const char* element,
                const std::vector<FieldShape>& fields) {
  file.put("    <").put(element).put(">\n");
  std::vector<std::string> names;
  for (const FieldShape& field : fields) {
    // As the pieces name them.
    names.push_back(detail::vtk_field_name(field.name, names));
    file.put("      <PDataArray type=\"")
        .put(field.name == kGhostField ? "UInt8" : "Float64")
        .put("\" Name=\"")
        .put(names.back())
        .put("\" NumberOfComponents=\"")
        .put(field.components)
        .put("\"/>\n");
  }
  file.put("    </").put(element).put(">\n");
}

}  // namespace

void write_parallel_index(const std::filesystem::path& path, const std::vector<std::string>& pieces,
                          const std::vector<FieldShape>& vertex_fields,
                          const std::vector<FieldShape>& element_fields, int n_ghost_layers) {
  const bool grid = path.extension() == ".pvtu";
  if (!grid && path.extension() != ".pvtp")
    throw IoError(path.string() + ": the extension '" + path.extension().string() +
                  "' is no index of pieces; use .pvtu for pieces .vtu, .pvtp for .vtp");
  if (pieces.empty()) throw IoError(path.string() + ": an index of no piece; name at least one");
  const std::string type = grid ? "PUnstructuredGrid" : "PPolyData";
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    detail::BufferedWriter file(temporary);
    file.put("<?xml version=\"1.0\"?>\n<VTKFile type=\"")
        .put(type)
        .put("\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <")
        .put(type)
        .put(" GhostLevel=\"")
        .put(n_ghost_layers)
        .put("\">\n");
    put_arrays(file, "PPointData", vertex_fields);
    put_arrays(file, "PCellData", element_fields);
    file.put(
        "    <PPoints>\n      <PDataArray type=\"Float64\" Name=\"Points\" "
        "NumberOfComponents=\"3\"/>\n    </PPoints>\n");
    for (const std::string& piece : pieces)
      file.put("    <Piece Source=\"").put(escaped(piece)).put("\"/>\n");
    file.put("  </").put(type).put(">\n</VTKFile>\n");
    file.close();
  });
}

}  // namespace carat
