#include <numeric>
#include <string>

#include "arrays.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/generators/families.h"
#include "carat/mesh/statistics.h"
#include "carat/mesh/transform.h"
#include "carat/mesh/volume_statistics.h"
#include "modules.h"
#include "run.h"

namespace carat::python {
namespace {

/// A number that does not fit in 32 bits is out of the range of any mesh; -1 elsewhere may mean
/// that there is nothing.
template <class T>
Index to_index(T value, const char* what, std::size_t position) {
  const auto index = static_cast<Index>(value);
  if (static_cast<T>(index) != value || (index < 0) != (value < 0))
    throw InvalidMesh(std::string(what) + ": entry " + std::to_string(position) + " is " +
                      std::to_string(value) + ", which no vertex, face or cell can have as number");
  return index;
}

template <class T>
Array<Index> to_indices(const In<T>& array, const char* what) {
  Array<Index> indices(static_cast<std::size_t>(array.size()));
  const T* const data = array.data();
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = to_index(data[i], what, i);
  return indices;
}

/// Rows of a rectangular array, without what fills them up with -1 at their ends.
template <class T>
Csr rows_of(const In<T>& array, const char* what) {
  const py::ssize_t rows = array.shape(0), width = array.shape(1);
  // Offsets are 32 bit like all numbers.
  if (array.size() > std::numeric_limits<Index>::max())
    throw InvalidMesh(std::string(what) + ": " + std::to_string(array.size()) +
                      " corners; at most 2^31 - 1 are possible");
  Csr result;
  result.offsets.resize(static_cast<std::size_t>(rows) + 1);
  result.indices.resize(static_cast<std::size_t>(array.size()));
  const T* data = array.data();
  Index end = 0;
  for (py::ssize_t row = 0; row < rows; ++row, data += width) {
    result.offsets[static_cast<std::size_t>(row)] = end;
    py::ssize_t k = 0;
    for (; k < width && data[k] != T(-1); ++k)
      result.indices[static_cast<std::size_t>(end++)] =
          to_index(data[k], what, static_cast<std::size_t>(row * width + k));
    for (; k < width; ++k)
      if (data[k] != T(-1))
        throw InvalidMesh(std::string(what) + ": row " + std::to_string(row) +
                              " goes on behind -1, which may only fill it up at its end",
                          {static_cast<Index>(row)});
  }
  result.offsets.back() = end;
  result.indices.resize(static_cast<std::size_t>(end));
  return result;
}

template <class T>
Csr csr_of(const In<T>& indices, const In<T>& offsets, const char* what) {
  return {to_indices(offsets, what), to_indices(indices, what)};
}

/// What derives connectivity takes a moment on large meshes; other threads go on meanwhile.
template <class Mesh, Index (Mesh::*number)() const>
Index unlocked(const Mesh& mesh) {
  const py::gil_scoped_release released;
  return (mesh.*number)();
}
template <class Make>
decltype(auto) unlocked(Make make) {
  const py::gil_scoped_release released;
  return make();
}

/// (indices, offsets) over the mesh's own memory.
template <class Mesh>
py::tuple views(const std::shared_ptr<Mesh>& mesh, const Csr& rows) {
  return py::make_tuple(
      view_of(mesh, rows.indices.data(), {static_cast<py::ssize_t>(rows.indices.size())}),
      view_of(mesh, rows.offsets.data(), {static_cast<py::ssize_t>(rows.offsets.size())}));
}

template <class Mesh>
py::array_t<double> points_view(const std::shared_ptr<Mesh>& mesh) {
  return view_of(mesh, mesh->points().data(), {mesh->n_vertices(), 3});
}

py::array_t<Index> edges_view(const Surface& mesh) {
  const auto& edges = unlocked([&]() -> const EdgeTopology& { return mesh->edges(); }).vertices;
  return view_of(mesh, edges.empty() ? nullptr : edges.front().data(),
                 {static_cast<py::ssize_t>(edges.size()), 2});
}

std::vector<Index> boundary_edges(const PolygonMesh& mesh) {
  std::vector<Index> ids;
  const EdgeTopology& edges = mesh.edges();
  for (Index e = 0; e < edges.size(); ++e)
    if (edges.corners.size(e) == 1) ids.push_back(e);
  return ids;
}

std::vector<Index> boundary_faces(const PolyhedralMesh& mesh) {
  std::vector<Index> ids;
  for (std::size_t f = 0; f < mesh.face_cells().size(); ++f)
    if (mesh.face_cells()[f].boundary()) ids.push_back(static_cast<Index>(f));
  return ids;
}

py::dict range_dict(const Range& range) {
  return py::dict(py::arg("min") = range.min, py::arg("mean") = range.mean,
                  py::arg("max") = range.max);
}

py::dict statistics(const PolygonMesh& mesh) {
  const MeshStatistics s = run([mesh](Job&) { return mesh_statistics(mesh); });
  py::dict dict;
  dict["vertices"] = s.vertices;
  dict["edges"] = s.edges;
  dict["faces"] = s.faces;
  py::dict valences;
  for (std::size_t k = 0; k < s.faces_of_valence.size(); ++k)
    if (s.faces_of_valence[k] > 0) valences[py::int_(k)] = s.faces_of_valence[k];
  dict["faces_of_valence"] = valences;
  dict["components"] = s.components;
  dict["closed"] = s.closed;
  dict["boundary_edges"] = s.boundary_edges;
  dict["boundary_loops"] = s.boundary_loops;
  dict["nonmanifold_edges"] = s.nonmanifold_edges;
  dict["nonmanifold_vertices"] = s.nonmanifold_vertices;
  dict["inconsistent_edges"] = s.inconsistent_edges;
  dict["unreferenced_vertices"] = s.unreferenced_vertices;
  dict["nonplanar_faces"] = s.nonplanar_faces;
  dict["nonconvex_faces"] = s.nonconvex_faces;
  dict["degenerate_faces"] = s.degenerate_faces;
  dict["duplicate_faces"] = s.duplicate_faces;
  dict["dropped_corners"] = s.dropped_corners;
  dict["euler_characteristic"] = s.euler_characteristic;
  dict["area"] = s.area;
  dict["enclosed_volume"] = s.enclosed_volume;
  dict["edge_length"] = range_dict(s.edge_length);
  dict["face_area"] = range_dict(s.face_area);
  dict["face_quality"] = range_dict(s.face_quality);
  return dict;
}

py::dict statistics(const PolyhedralMesh& mesh) {
  const VolumeStatistics s = run([mesh](Job&) { return volume_statistics(mesh); });
  py::dict dict;
  dict["vertices"] = s.all_faces.vertices;
  dict["edges"] = s.all_faces.edges;
  dict["faces"] = s.all_faces.faces;
  dict["cells"] = s.cells;
  py::dict kinds;
  for (std::size_t k = 0; k < kCellKinds.size(); ++k)
    if (s.cells_of_kind[k] > 0) kinds[cell_kind_name(kCellKinds[k])] = s.cells_of_kind[k];
  dict["cells_of_kind"] = kinds;
  dict["inner_faces"] = s.inner_faces;
  dict["boundary_faces"] = s.boundary_faces;
  dict["components"] = s.components;
  dict["volume"] = s.volume;
  dict["boundary_area"] = s.boundary.area;
  dict["cell_volume"] = range_dict(s.cell_volume);
  dict["cell_quality"] = range_dict(s.cell_quality);
  dict["edge_length"] = range_dict(s.all_faces.edge_length);
  for (const Finding& finding : s.findings.findings())
    dict[finding.name.c_str()] = finding.elements.size();
  return dict;
}

template <class Mesh>
std::vector<Index> on_boundary(const Mesh& mesh) {
  return ids_where(boundary_vertices(mesh));
}

py::list family_list() {
  py::list list;
  const auto add = [&](const char* kind, const auto& families) {
    for (const auto& family : families)
      list.append(py::make_tuple(family.name, kind, family.title, family.domain));
  };
  add("surface", mesh_families());
  add("volume", volume_families());
  return list;
}

bool is_volume_family(const std::string& name) {
  for (const VolumeFamilyEntry& family : volume_families())
    if (name == family.name) return true;
  return false;
}

py::object generate(const std::string& family, const FamilyOptions& options) {
  if (is_volume_family(family))
    return py::cast(run(
        [=](Job&) { return std::make_shared<PolyhedralMesh>(generate_volume(family, options)); }));
  for (const FamilyEntry& entry : mesh_families())
    if (family == entry.name)
      return py::cast(
          run([=](Job&) { return std::make_shared<PolygonMesh>(generate_mesh(family, options)); }));
  std::string known;
  for (const FamilyEntry& entry : mesh_families()) known += std::string(entry.name) + ", ";
  for (const VolumeFamilyEntry& entry : volume_families()) known += std::string(entry.name) + ", ";
  throw InvalidOption("there is no mesh family \"" + family + "\"; choose one of " +
                      known.substr(0, known.size() - 2));
}

/// The stream of a VTK polyhedron: number of faces, then for each its size and vertices.
template <class Next>
void add_polyhedron(CellCollector& collector, py::ssize_t cell, Next next) {
  const auto n_faces = next();
  std::vector<Index> face;
  for (std::int64_t f = 0; f < n_faces; ++f) {
    const auto size = next();
    if (size < 0)
      throw InvalidMesh(
          "cell " + std::to_string(cell) + ": a face of " + std::to_string(size) + " vertices",
          {static_cast<Index>(cell)});
    face.clear();
    for (std::int64_t k = 0; k < size; ++k) face.push_back(static_cast<Index>(next()));
    collector.add_face(face);
  }
  collector.end_cell();
}

/// Cells as VTK holds them.
/// \param stream  of every cell its length and vertices; of polyhedra (type 42) its length and the
///                stream of its faces
PolyhedralMesh from_vtk(Points points, const std::vector<std::int64_t>& stream,
                        const std::vector<std::int64_t>& types) {
  CellCollector collector;
  std::size_t at = 0;
  std::vector<Index> vertices;
  for (std::size_t cell = 0; cell < types.size(); ++cell) {
    const auto refuse = [&](const std::string& what) {
      throw InvalidMesh("cell " + std::to_string(cell) + ": " + what, {static_cast<Index>(cell)});
    };
    if (at >= stream.size()) refuse("the list of cells ends before it");
    const std::int64_t length = stream[at++];
    if (length < 0 || length > static_cast<std::int64_t>(stream.size() - at))
      refuse("its length is " + std::to_string(length) + ", but the list of cells has " +
             std::to_string(stream.size() - at) + " numbers left");
    const std::size_t end = at + static_cast<std::size_t>(length);
    const auto next = [&]() -> std::int64_t {
      if (at >= end) refuse("its list of faces ends early");
      const std::int64_t value = stream[at++];
      return to_index(value, "cells", at - 1);
    };
    if (types[cell] == 42) {
      add_polyhedron(collector, static_cast<py::ssize_t>(cell), next);
      if (at != end) refuse("its list of faces has numbers left over");
      continue;
    }
    vertices.clear();
    while (at < end) vertices.push_back(static_cast<Index>(next()));
    switch (types[cell]) {
      case 10:
      case 11:
      case 12:
      case 13:
      case 14:
        collector.add(static_cast<CellType>(types[cell]), vertices);
        break;
      default:
        refuse("VTK's type " + std::to_string(types[cell]) +
               " is none of 10 (tetrahedron), 11 (voxel), 12 (hexahedron), 13 (wedge), "
               "14 (pyramid), 42 (polyhedron)");
    }
  }
  if (at != stream.size())
    throw InvalidMesh("the list of cells has " + std::to_string(stream.size() - at) +
                      " numbers left over behind the last of " + std::to_string(types.size()) +
                      " cells");
  return std::move(collector).build(std::move(points));
}

/// Builds without Python's lock, from what has been taken out of arrays.
template <class Mesh, class... Parts>
std::shared_ptr<Mesh> build(Parts... parts) {
  const py::gil_scoped_release released;
  return std::make_shared<Mesh>(std::move(parts)...);
}

template <class T>
void define_constructors(py::module_& module) {
  module.def("polygon_mesh",
             [](const In<double>& points, const In<T>& indices, const In<T>& offsets) {
               return build<PolygonMesh>(to_points(points), csr_of(indices, offsets, "faces"));
             });
  module.def("polygon_mesh_of_rows", [](const In<double>& points, const In<T>& faces) {
    return build<PolygonMesh>(to_points(points), rows_of(faces, "faces"));
  });
  module.def("polyhedral_mesh", [](const In<double>& points, const In<T>& face_indices,
                                   const In<T>& face_offsets, const In<T>& cell_indices,
                                   const In<T>& cell_offsets) {
    return build<PolyhedralMesh>(to_points(points), csr_of(face_indices, face_offsets, "faces"),
                                 csr_of(cell_indices, cell_offsets, "cells"));
  });
  module.def("polyhedral_mesh_of_owners",
             [](const In<double>& points, const In<T>& face_indices, const In<T>& face_offsets,
                const In<T>& owner, const In<T>& neighbour) {
               Points vertices = to_points(points);
               Csr faces = csr_of(face_indices, face_offsets, "faces");
               const Array<Index> owners = to_indices(owner, "owner");
               const Array<Index> neighbours = to_indices(neighbour, "neighbour");
               const py::gil_scoped_release released;
               return std::make_shared<PolyhedralMesh>(PolyhedralMesh::from_owner_neighbour(
                   std::move(vertices), std::move(faces), owners, neighbours));
             });
  module.def("polyhedral_mesh_of_rows", [](const In<double>& points, const In<T>& cells) {
    const Array<Index> indices = to_indices(cells, "cells");
    const Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        rows(indices.data(), cells.shape(0), cells.shape(1));
    Points vertices = to_points(points);
    const bool tets = cells.shape(1) == 4;
    const py::gil_scoped_release released;
    return std::make_shared<PolyhedralMesh>(
        tets ? PolyhedralMesh::from_tets(std::move(vertices), rows)
             : PolyhedralMesh::from_hexes(std::move(vertices), rows));
  });
}

}  // namespace

void define_meshes(py::module_& module) {
  py::class_<PolygonMesh, Surface>(module, "PolygonMesh")
      .def_property_readonly("n_vertices", &PolygonMesh::n_vertices)
      .def_property_readonly("n_faces", &PolygonMesh::n_faces)
      .def_property_readonly("n_edges", &unlocked<PolygonMesh, &PolygonMesh::n_edges>)
      .def_property_readonly("n_dropped_corners", &PolygonMesh::n_dropped_corners)
      .def_property_readonly("points", &points_view<PolygonMesh>)
      .def_property_readonly("faces",
                             [](const Surface& mesh) { return views(mesh, mesh->faces()); })
      .def_property_readonly("edges", &edges_view)
      .def("boundary_vertices",
           [](const PolygonMesh& mesh) {
             return moved_vector(unlocked([&] { return on_boundary(mesh); }));
           })
      .def("boundary_sides",
           [](const PolygonMesh& mesh) {
             return moved_vector(unlocked([&] { return boundary_edges(mesh); }));
           })
      .def("vertex_components",
           [](const PolygonMesh& mesh) {
             return moved_vector(unlocked([&] { return vertex_components(mesh); }));
           })
      .def("vertex_normals",
           [](const PolygonMesh& mesh) {
             return moved_points(unlocked([&] { return vertex_normals(mesh); }));
           })
      .def("face_area_vectors",
           [](const PolygonMesh& mesh) {
             return moved_points(unlocked([&] { return face_area_vectors(mesh); }));
           })
      .def("statistics", [](const PolygonMesh& mesh) { return statistics(mesh); })
      .def("with_points",
           [](const PolygonMesh& mesh, const In<double>& points) {
             return std::make_shared<PolygonMesh>(mesh.with_points(to_points(points)));
           })
      .def("dual",
           [](const Surface& mesh) {
             return run([=](Job&) { return std::make_shared<PolygonMesh>(dual_mesh(*mesh)); });
           })
      .def("triangulate", [](const Surface& mesh) {
        auto [triangles, sources] = run([=](Job&) {
          std::vector<Index> source;
          auto result = std::make_shared<PolygonMesh>(triangulate(*mesh, &source));
          return std::make_pair(result, std::move(source));
        });
        return py::make_tuple(triangles, moved_vector(std::move(sources)));
      });

  py::class_<PolyhedralMesh, Volume>(module, "PolyhedralMesh")
      .def_property_readonly("n_vertices", &PolyhedralMesh::n_vertices)
      .def_property_readonly("n_edges", &unlocked<PolyhedralMesh, &PolyhedralMesh::n_edges>)
      .def_property_readonly("n_faces", &PolyhedralMesh::n_faces)
      .def_property_readonly("n_cells", &PolyhedralMesh::n_cells)
      .def_property_readonly("points", &points_view<PolyhedralMesh>)
      .def_property_readonly(
          "faces", [](const Volume& mesh) { return views(mesh, mesh->face_mesh().faces()); })
      .def_property_readonly("cells", [](const Volume& mesh) { return views(mesh, mesh->cells()); })
      .def_property_readonly(
          "cell_vertices",
          [](const Volume& mesh) {
            return views(mesh, unlocked([&]() -> const Csr& { return mesh->cell_vertices(); }));
          })
      .def_property_readonly("face_cells",
                             [](const Volume& mesh) {
                               const auto& cells = mesh->face_cells();
                               return view_of(mesh, cells.empty() ? nullptr : &cells.front().below,
                                              {static_cast<py::ssize_t>(cells.size()), 2});
                             })
      .def_property_readonly(
          "edges",
          [](const Volume& mesh) {
            return edges_view(Surface(mesh, const_cast<PolygonMesh*>(&mesh->face_mesh())));
          })
      .def("boundary_vertices",
           [](const PolyhedralMesh& mesh) {
             return moved_vector(unlocked([&] { return on_boundary(mesh); }));
           })
      .def("boundary_sides",
           [](const PolyhedralMesh& mesh) {
             return moved_vector(unlocked([&] { return boundary_faces(mesh); }));
           })
      .def("statistics", [](const PolyhedralMesh& mesh) { return statistics(mesh); })
      .def("with_points",
           [](const PolyhedralMesh& mesh, const In<double>& points) {
             return std::make_shared<PolyhedralMesh>(mesh.with_points(to_points(points)));
           })
      .def("boundary_surface", [](const Volume& mesh) {
        BoundarySurface surface = run([=](Job&) { return boundary_surface(*mesh); });
        return py::make_tuple(std::make_shared<PolygonMesh>(std::move(surface.mesh)),
                              moved_vector(std::move(surface.vertex_ids)),
                              moved_vector(std::move(surface.face_ids)));
      });

  define_constructors<std::int32_t>(module);
  define_constructors<std::int64_t>(module);
  module.def("polyhedral_mesh_of_vtk", [](const In<double>& points, const In<std::int64_t>& cells,
                                          const In<std::int64_t>& types) {
    Points vertices = to_points(points);
    const std::vector<std::int64_t> stream = to_list(cells), cell_types = to_list(types);
    const py::gil_scoped_release released;
    return std::make_shared<PolyhedralMesh>(from_vtk(std::move(vertices), stream, cell_types));
  });
  module.def("families", &family_list);
  module.def("generate", [](const std::string& family, int level, double jitter, double anisotropy,
                            std::uint64_t seed) {
    return generate(family, {level, jitter, anisotropy, seed});
  });
}

}  // namespace carat::python
