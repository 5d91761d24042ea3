#include "carat/report/html_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/mesh/transform.h"
#include "carat/report/page_blocks.h"
#include "carat/report/viewer_template.h"

namespace carat {
namespace {

using nlohmann::json;

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// ASCII without "<", so that no text can end the script element it stands in.
std::string script_json(const json& value) {
  const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) c == '<' ? safe += "\\u003c" : safe += c;
  return safe;
}

void check_fields(const std::vector<Field>& fields, Index n_rows, const char* element,
                  const std::string& item) {
  for (const Field& field : fields) {
    const auto expected = static_cast<std::size_t>(n_rows) *
                          static_cast<std::size_t>(std::max<Index>(field.components, 0));
    if (field.components < 1)
      throw InvalidOption(item + ": field \"" + field.name + "\" has " +
                          std::to_string(field.components) + " components; at least 1 is needed");
    if (field.values.size() != expected)
      throw InvalidOption(
          item + ": field \"" + field.name + "\" has " + std::to_string(field.values.size()) +
          " values, but " + std::to_string(n_rows) + " " + element + " of " +
          std::to_string(field.components) + " components need " + std::to_string(expected));
  }
}

/// How doubles are stored in single precision: value = offset + scale * stored.
struct Quantisation {
  double offset = 0;
  double scale = 1;
};

/// Plain single precision unless its exponent range or its 24 bits would lose the field's shape.
Quantisation quantise(const Field& field) {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -lower;
  for (const double value : field.values)
    if (std::isfinite(value)) {
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  Quantisation result;
  if (!(lower <= upper)) return result;
  const double largest = std::max(std::abs(lower), std::abs(upper));
  if (largest > 1e30 || (largest > 0 && largest < 1e-30)) result.scale = largest;
  const bool nearly_constant = upper / 2 - lower / 2 < 5e-4 * largest;
  if (field.components == 1 && lower < upper && nearly_constant)
    result.offset = lower / 2 + upper / 2;
  return result;
}

void write_fields(const std::vector<Field>& fields, const char* element,
                  detail::BlockWriter& blocks, json& list) {
  std::vector<float> stored;
  for (const Field& field : fields) {
    const Quantisation q = quantise(field);
    stored.resize(field.values.size());
    std::transform(field.values.begin(), field.values.end(), stored.begin(),
                   [&](double value) { return static_cast<float>((value - q.offset) / q.scale); });
    list.push_back({{"name", field.name},
                    {"on", element},
                    {"components", field.components},
                    {"offset", q.offset},
                    {"scale", q.scale},
                    {"block", blocks.write_floats(stored)}});
  }
}

/// Positions in a ball of radius 1 about the middle of the bounding box.
json write_positions(const Points& points, detail::BlockWriter& blocks) {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
  if (points.rows() > 0) {
    const Vec3 lower = points.colwise().minCoeff().transpose();
    const Vec3 upper = points.colwise().maxCoeff().transpose();
    centre = lower / 2 + upper / 2;
    radius = (upper / 2 - lower / 2).stableNorm();
  }
  const double scale = radius > 0 ? radius : 1;
  std::vector<float> stored(static_cast<std::size_t>(points.size()));
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (Eigen::Index k = 0; k < 3; ++k)
      stored[static_cast<std::size_t>(3 * v + k)] =
          static_cast<float>((points(v, k) - centre[k]) / scale);
  return {{"centre", {centre.x(), centre.y(), centre.z()}},
          {"scale", scale},
          {"positions", blocks.write_floats(stored)}};
}

/// Every triangle corner as a corner of the polygon mesh: almost a constant pattern, so that the
/// triangles cost next to nothing beside the faces.
std::vector<Index> triangle_corners(const PolygonMesh& mesh, const PolygonMesh& triangles,
                                    const std::vector<Index>& source_faces) {
  std::vector<Index> corner_of_vertex(static_cast<std::size_t>(mesh.n_vertices()));
  std::vector<Index> corners(static_cast<std::size_t>(triangles.n_corners()));
  Index face = -1;
  for (Index t = 0; t < triangles.n_faces(); ++t) {
    if (source_faces[static_cast<std::size_t>(t)] != face) {
      face = source_faces[static_cast<std::size_t>(t)];
      for (Index c = mesh.faces().begin(face); c < mesh.faces().end(face); ++c)
        corner_of_vertex[static_cast<std::size_t>(mesh.faces().indices[c])] = c;
    }
    for (Index c = triangles.faces().begin(t); c < triangles.faces().end(t); ++c)
      corners[static_cast<std::size_t>(c)] =
          corner_of_vertex[static_cast<std::size_t>(triangles.faces().indices[c])];
  }
  return corners;
}

/// One bit a corner: set where the face's side from that corner is the first of its edge.
std::vector<std::uint8_t> edge_bits(const PolygonMesh& mesh) {
  const Csr& corners = mesh.edges().corners;
  std::vector<std::uint8_t> bits(static_cast<std::size_t>(mesh.n_corners()) / 8 + 1, 0);
  for (Index e = 0; e < corners.n_rows(); ++e) {
    const Index c = corners.indices[corners.begin(e)];
    bits[static_cast<std::size_t>(c) / 8] |= static_cast<std::uint8_t>(1U << c % 8);
  }
  return bits;
}

/// The faces of a mesh and their triangles.
void write_faces(const PolygonMesh& mesh, detail::BlockWriter& blocks, json& entry,
                 std::vector<Index>& source_faces) {
  std::vector<Index> sizes(static_cast<std::size_t>(mesh.n_faces()));
  for (Index f = 0; f < mesh.n_faces(); ++f)
    sizes[static_cast<std::size_t>(f)] = mesh.faces().size(f);
  entry["vertices"] = mesh.n_vertices();
  entry["edges"] = mesh.n_edges();
  entry["faceSizes"] = blocks.write_integers(sizes);
  entry["faceVertices"] = blocks.write_integers(mesh.faces().indices);
  const PolygonMesh triangles = triangulate(mesh, &source_faces);
  entry["triangleCorners"] = blocks.write_integers(triangle_corners(mesh, triangles, source_faces));
}

json write_mesh(const SurfaceData& data, detail::BlockWriter& blocks) {
  json entry = write_positions(data.mesh.points(), blocks);
  entry["kind"] = "surface";
  std::vector<Index> source_faces;
  write_faces(data.mesh, blocks, entry, source_faces);
  entry["triangleFaces"] = blocks.write_integers(source_faces);
  entry["edgeBits"] = blocks.write_bytes(edge_bits(data.mesh));
  entry["fields"] = json::array();
  write_fields(data.fields.vertex, "vertex", blocks, entry["fields"]);
  write_fields(data.fields.face, "face", blocks, entry["fields"]);
  return entry;
}

/// Every face of every cell: twice its number, and one more where its normal points into the cell.
/// An Index holds that, as it holds the number of the faces' corners.
std::vector<Index> cell_sides(const PolyhedralMesh& mesh) {
  const Csr& cells = mesh.cells();
  std::vector<Index> sides(cells.indices.size());
  for (Index c = 0; c < mesh.n_cells(); ++c)
    for (Index i = cells.begin(c); i < cells.end(c); ++i) {
      const Index f = cells.indices[i];
      sides[static_cast<std::size_t>(i)] =
          2 * f + (mesh.face_cells()[static_cast<std::size_t>(f)].above == c ? 1 : 0);
    }
  return sides;
}

json write_mesh(const VolumeData& data, detail::BlockWriter& blocks) {
  const PolyhedralMesh& mesh = data.mesh;
  json entry = write_positions(mesh.points(), blocks);
  entry["kind"] = "volume";
  std::vector<Index> source_faces;
  write_faces(mesh.face_mesh(), blocks, entry, source_faces);
  std::vector<Index> sizes(static_cast<std::size_t>(mesh.n_cells()));
  for (Index c = 0; c < mesh.n_cells(); ++c)
    sizes[static_cast<std::size_t>(c)] = mesh.cells().size(c);
  entry["cellSizes"] = blocks.write_integers(sizes);
  entry["cellSides"] = blocks.write_integers(cell_sides(mesh));
  entry["patches"] = json::array();
  for (const BoundaryPatch& patch : data.patches)
    entry["patches"].push_back(
        {{"name", patch.name}, {"faces", blocks.write_integers(patch.faces)}});
  entry["fields"] = json::array();
  write_fields(data.fields.vertex, "vertex", blocks, entry["fields"]);
  write_fields(data.fields.cell, "cell", blocks, entry["fields"]);
  return entry;
}

json write_item(const ViewItem& item, detail::BlockWriter& blocks) {
  json entry = std::visit([&](const auto& data) { return write_mesh(data, blocks); }, item.data);
  entry["title"] = item.title;
  return entry;
}

void check_item(const SurfaceData& data, const std::string& title) {
  check_fields(data.fields.vertex, data.mesh.n_vertices(), "vertices", title);
  check_fields(data.fields.face, data.mesh.n_faces(), "faces", title);
}

void check_item(const VolumeData& data, const std::string& title) {
  check_fields(data.fields.vertex, data.mesh.n_vertices(), "vertices", title);
  check_fields(data.fields.cell, data.mesh.n_cells(), "cells", title);
  for (const BoundaryPatch& patch : data.patches)
    for (const Index f : patch.faces)
      if (f < 0 || f >= data.mesh.n_faces())
        throw InvalidOption(title + ": patch \"" + patch.name + "\" has face " + std::to_string(f) +
                            ", but the mesh has " + std::to_string(data.mesh.n_faces()) + " faces");
}

void write_data(std::ostream& out, const std::vector<ViewItem>& items, const std::string& title) {
  detail::BlockWriter blocks(out);
  json description = {{"title", title}, {"items", json::array()}};
  for (const ViewItem& item : items) description["items"].push_back(write_item(item, blocks));
  out << "<script type=\"application/json\" id=\"description\">" << script_json(description)
      << "</script>";
}

void check_items(const std::vector<ViewItem>& items) {
  for (const ViewItem& item : items)
    std::visit([&](const auto& data) { check_item(data, item.title); }, item.data);
}

void write_page(std::ostream& out, const std::vector<ViewItem>& items, const std::string& title) {
  constexpr std::string_view title_mark = "<!--carat:title-->";
  constexpr std::string_view data_mark = "<!--carat:data-->";
  const std::string_view page = detail::viewer_template();
  const std::size_t title_at = page.find(title_mark);
  const std::size_t data_at = page.find(data_mark);
  const std::size_t middle = title_at + title_mark.size();
  out << page.substr(0, title_at) << escape_html(title) << page.substr(middle, data_at - middle);
  write_data(out, items, title);
  out << page.substr(data_at + data_mark.size());
}

}  // namespace

void write_html_view(const std::filesystem::path& path, const std::vector<ViewItem>& items,
                     const std::string& title) {
  if (items.empty())
    throw InvalidOption(path.string() + ": no mesh to show; pass at least one item");
  check_items(items);
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    write_page(out, items, title);
    out.close();
    if (!out) throw IoError(path.string() + ": cannot be written completely; is the disk full?");
  });
}

std::string html_view_data(const std::vector<ViewItem>& items, const std::string& title) {
  check_items(items);
  std::ostringstream out;
  write_data(out, items, title);
  return out.str();
}

}  // namespace carat
