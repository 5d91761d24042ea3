#pragma once
// What the two versions of Gmsh's format share.

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "carat/io/element_collector.h"
#include "carat/io/scanner.h"

namespace carat::detail {

/// Nodes and elements as they come in. Nodes are named by numbers of any size and order.
class GmshMesh {
 public:
  void reserve_nodes(std::int64_t n) { coordinates_.reserve(static_cast<std::size_t>(3 * n)); }
  void add_node_tag(std::int64_t tag) { tags_.push_back(tag); }
  /// The coordinates of the next node.
  void add_coordinates(double x, double y, double z) {
    coordinates_.insert(coordinates_.end(), {x, y, z});
  }
  /// After the last node.
  /// \throws IoError  a number is there twice
  void end_nodes();

  /// Nodes of an element of Gmsh's type.
  /// \throws IoError  an unknown or curved type
  std::size_t n_nodes(std::int64_t type) const;
  /// Adds an element; points and lines are passed over.
  /// \throws IoError  a node that does not exist
  void add_element(std::int64_t type, std::span<std::int64_t> nodes, std::int64_t group);

  void name_group(std::int64_t dimension, std::int64_t group, std::string name) {
    names_[{dimension, group}] = std::move(name);
  }
  MeshData build();

 private:
  std::int64_t number_of(std::int64_t tag) const;

  std::vector<std::int64_t> tags_;
  std::vector<std::pair<std::int64_t, std::int64_t>> sorted_;  ///< tag, number; unless 1 to n
  std::vector<double> coordinates_;
  ElementCollector elements_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> names_;
};

/// Reads the body of a section, its first line is passed.
void read_gmsh_2_nodes(Scanner& scanner, GmshMesh& mesh);
void read_gmsh_2_elements(Scanner& scanner, GmshMesh& mesh);

/// Dimension and number of a part of the geometry -> its first physical group.
using GmshEntities = std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t>;
GmshEntities read_gmsh_4_entities(Scanner& scanner);
void read_gmsh_4_nodes(Scanner& scanner, GmshMesh& mesh);
void read_gmsh_4_elements(Scanner& scanner, const GmshEntities& entities, GmshMesh& mesh);

}  // namespace carat::detail
