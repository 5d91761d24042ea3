#include "carat/io/gmsh_elements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

struct Shape {
  std::int64_t type;
  std::size_t n_nodes;
  ElementShape shape;
};
constexpr std::array<Shape, 6> kShapes = {{{2, 3, ElementShape::Triangle},
                                           {3, 4, ElementShape::Quadrilateral},
                                           {4, 4, ElementShape::Tetrahedron},
                                           {5, 8, ElementShape::Hexahedron},
                                           {6, 6, ElementShape::Wedge},
                                           {7, 5, ElementShape::Pyramid}}};
/// Points and lines of the orders 1 to 5.
constexpr std::array<std::pair<std::int64_t, std::size_t>, 6> kPassedOver = {
    {{15, 1}, {1, 2}, {8, 3}, {26, 4}, {27, 5}, {28, 6}}};
constexpr std::size_t kMostNodes = 8;

double read_coordinate(Scanner& scanner, std::int64_t tag) {
  const double value = scanner.real(NumberType::Float64);
  if (!std::isfinite(value))
    scanner.fail("node " + std::to_string(tag) + ": coordinate " + std::to_string(value) +
                 "; every coordinate must be a finite number");
  return value;
}

void add_node(Scanner& scanner, GmshMesh& mesh, std::int64_t tag) {
  const double x = read_coordinate(scanner, tag), y = read_coordinate(scanner, tag),
               z = read_coordinate(scanner, tag);
  mesh.add_coordinates(x, y, z);
}

}  // namespace

void GmshMesh::end_nodes() {
  bool in_order = true;
  for (std::size_t i = 0; in_order && i < tags_.size(); ++i)
    in_order = tags_[i] == static_cast<std::int64_t>(i) + 1;
  if (in_order) return;
  sorted_.reserve(tags_.size());
  for (std::size_t i = 0; i < tags_.size(); ++i)
    sorted_.emplace_back(tags_[i], static_cast<std::int64_t>(i));
  std::sort(sorted_.begin(), sorted_.end());
  for (std::size_t i = 1; i < sorted_.size(); ++i)
    if (sorted_[i].first == sorted_[i - 1].first)
      throw IoError("node " + std::to_string(sorted_[i].first) +
                    " is there twice; the file is damaged");
}

std::int64_t GmshMesh::number_of(std::int64_t tag) const {
  const auto n = static_cast<std::int64_t>(tags_.size());
  if (sorted_.empty() && tag >= 1 && tag <= n) return tag - 1;
  const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(tag, std::int64_t{0}));
  if (at == sorted_.end() || at->first != tag)
    throw IoError("an element has node " + std::to_string(tag) + ", which is none of the " +
                  std::to_string(n) + " nodes; the file is damaged");
  return at->second;
}

std::size_t GmshMesh::n_nodes(std::int64_t type) const {
  for (const Shape& shape : kShapes)
    if (shape.type == type) return shape.n_nodes;
  for (const auto& [passed_over, n] : kPassedOver)
    if (passed_over == type) return n;
  throw IoError("holds elements of Gmsh's type " + std::to_string(type) +
                ", which are curved or unknown; save the mesh with elements of first order");
}

void GmshMesh::add_element(std::int64_t type, std::span<std::int64_t> nodes, std::int64_t group) {
  for (const Shape& shape : kShapes) {
    if (shape.type != type) continue;
    for (std::int64_t& node : nodes) node = number_of(node);
    elements_.add(shape.shape, nodes, group);
  }
}

MeshData GmshMesh::build() {
  const auto n = static_cast<Eigen::Index>(tags_.size());
  Points points(n, 3);
  std::copy(coordinates_.begin(), coordinates_.end(), points.data());
  return elements_.build(std::move(points), "physical_group", [this](std::int64_t group) {
    const auto name = names_.find({2, group});
    return name == names_.end() ? std::to_string(group) : name->second;
  });
}

void read_gmsh_2_nodes(Scanner& scanner, GmshMesh& mesh) {
  const Encoding encoding = scanner.encoding();
  scanner.set_encoding(Encoding::Text);
  const std::int64_t n = scanner.whole(NumberType::Int64);
  scanner.set_encoding(encoding);
  scanner.start_values();
  scanner.require(n, "nodes", 4, 28);
  mesh.reserve_nodes(n);
  for (std::int64_t i = 0; i < n; ++i) {
    const std::int64_t tag = scanner.whole(NumberType::Int32);
    mesh.add_node_tag(tag);
    add_node(scanner, mesh, tag);
  }
  mesh.end_nodes();
}

void read_gmsh_2_elements(Scanner& scanner, GmshMesh& mesh) {
  const Encoding encoding = scanner.encoding();
  scanner.set_encoding(Encoding::Text);
  const std::int64_t n = scanner.whole(NumberType::Int64);
  scanner.set_encoding(encoding);
  scanner.start_values();
  scanner.require(n, "elements", 3, 8);
  const auto next = [&] { return scanner.whole(NumberType::Int32); };
  std::array<std::int64_t, kMostNodes> nodes{};
  const auto read_rest = [&](std::int64_t type, std::int64_t n_tags) {
    scanner.require(n_tags, "tags of an element", 1, 4);
    std::int64_t group = 0;
    for (std::int64_t t = 0; t < n_tags; ++t) {
      const std::int64_t tag = next();
      if (t == 0) group = tag;
    }
    const std::span<std::int64_t> used = std::span(nodes).first(mesh.n_nodes(type));
    for (std::int64_t& node : used) node = next();
    mesh.add_element(type, used, group);
  };
  for (std::int64_t i = 0; i < n;) {
    if (encoding == Encoding::Text) {
      next();
      const std::int64_t type = next(), n_tags = next();
      read_rest(type, n_tags);
      ++i;
      continue;
    }
    // In binary, elements of one type follow each other under one header.
    const std::int64_t type = next(), n_block = next(), n_tags = next();
    scanner.require(n_block, "elements", 3, 8);
    if (n_block < 1 || n_block > n - i)
      scanner.fail(std::to_string(n_block) +
                   " elements in a block, which is not what the section "
                   "says; the file is damaged");
    for (std::int64_t k = 0; k < n_block; ++k, ++i) {
      next();
      read_rest(type, n_tags);
    }
  }
}

GmshEntities read_gmsh_4_entities(Scanner& scanner) {
  constexpr NumberType kSize = NumberType::Int64, kTag = NumberType::Int32;
  std::array<std::int64_t, 4> counts{};
  for (std::int64_t& count : counts) count = scanner.whole(kSize);
  GmshEntities groups;
  for (std::int64_t dimension = 0; dimension < 4; ++dimension) {
    const std::int64_t n = counts[static_cast<std::size_t>(dimension)];
    scanner.require(n, "parts of the geometry", 5, 36);
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int64_t tag = scanner.whole(kTag);
      scanner.skip_values(dimension == 0 ? 3 : 6, NumberType::Float64);
      const std::int64_t n_groups = scanner.whole(kSize);
      scanner.require(n_groups, "physical groups", 1, 4);
      for (std::int64_t g = 0; g < n_groups; ++g) {
        const std::int64_t group = scanner.whole(kTag);
        if (g == 0) groups[{dimension, tag}] = group;
      }
      if (dimension > 0) scanner.skip_values(scanner.whole(kSize), kTag);
    }
  }
  return groups;
}

void read_gmsh_4_nodes(Scanner& scanner, GmshMesh& mesh) {
  constexpr NumberType kSize = NumberType::Int64, kInt = NumberType::Int32;
  const std::int64_t n_blocks = scanner.whole(kSize), n_nodes = scanner.whole(kSize);
  scanner.whole(kSize);
  scanner.whole(kSize);
  scanner.require(n_nodes, "nodes", 4, 32);
  mesh.reserve_nodes(n_nodes);
  std::vector<std::int64_t> tags;
  std::int64_t n_read = 0;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const std::int64_t dimension = scanner.whole(kInt);
    scanner.whole(kInt);
    const bool parametric = scanner.whole(kInt) != 0;
    const std::int64_t n = scanner.whole(kSize);
    scanner.require(n, "nodes", 4, 32);
    n_read += n;
    tags.resize(static_cast<std::size_t>(n));
    for (std::int64_t& tag : tags) mesh.add_node_tag(tag = scanner.whole(kSize));
    for (const std::int64_t tag : tags) {
      add_node(scanner, mesh, tag);
      if (parametric)
        scanner.skip_values(std::clamp<std::int64_t>(dimension, 0, 3), NumberType::Float64);
    }
  }
  if (n_read != n_nodes)
    scanner.fail(std::to_string(n_read) + " nodes, but the section says " +
                 std::to_string(n_nodes) + "; the file is damaged");
  mesh.end_nodes();
}

void read_gmsh_4_elements(Scanner& scanner, const GmshEntities& entities, GmshMesh& mesh) {
  constexpr NumberType kSize = NumberType::Int64, kInt = NumberType::Int32;
  const std::int64_t n_blocks = scanner.whole(kSize), n_elements = scanner.whole(kSize);
  scanner.whole(kSize);
  scanner.whole(kSize);
  std::array<std::int64_t, kMostNodes> nodes{};
  std::int64_t n_read = 0;
  for (std::int64_t b = 0; b < n_blocks; ++b) {
    const std::int64_t dimension = scanner.whole(kInt), entity = scanner.whole(kInt);
    const std::int64_t type = scanner.whole(kInt), n = scanner.whole(kSize);
    const std::size_t size = mesh.n_nodes(type);
    scanner.require(n, "elements", 1 + size, 8 * (1 + size));
    n_read += n;
    const auto found = entities.find({dimension, entity});
    const std::int64_t group = found == entities.end() ? 0 : found->second;
    const std::span<std::int64_t> used = std::span(nodes).first(size);
    for (std::int64_t i = 0; i < n; ++i) {
      scanner.whole(kSize);
      for (std::int64_t& node : used) node = scanner.whole(kSize);
      mesh.add_element(type, used, group);
    }
  }
  if (n_read != n_elements)
    scanner.fail(std::to_string(n_read) + " elements, but the section says " +
                 std::to_string(n_elements) + "; the file is damaged");
}

}  // namespace carat::detail
