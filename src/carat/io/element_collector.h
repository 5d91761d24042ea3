#pragma once
// Meshes from the elements of formats that list nodes and elements by shape: Medit, Gmsh.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "carat/io/face_collector.h"
#include "carat/io/mesh_file.h"

namespace carat::detail {

enum class ElementShape { Triangle, Quadrilateral, Tetrahedron, Hexahedron, Wedge, Pyramid };

std::size_t n_vertices_of(ElementShape shape);

/// Collects elements of both dimensions. With volume elements they become a volume mesh, and the
/// groups of its boundary's 2-D elements patches; without, a surface mesh. Groups of the elements
/// that make the mesh become a field if there are several.
class ElementCollector {
 public:
  /// \param vertices  0-based, in the order of VTK
  /// \param group     0: none
  /// \throws InvalidMesh  a vertex that cannot exist
  void add(ElementShape shape, std::span<const std::int64_t> vertices, std::int64_t group);

  /// \param field_name     of the field of groups
  /// \param name_of_patch  the name of a group of 2-D elements
  MeshData build(Points points, const char* field_name,
                 const std::function<std::string(std::int64_t group)>& name_of_patch);

 private:
  std::vector<BoundaryPatch> patches(
      const PolyhedralMesh& mesh,
      const std::function<std::string(std::int64_t group)>& name_of_patch) const;

  FaceCollector faces_;
  CellCollector cells_;
  std::vector<std::int64_t> face_groups_, cell_groups_;
  std::vector<Index> scratch_;
};

}  // namespace carat::detail
