#include <filesystem>
#include <string>
#include <variant>

#include "arrays.h"
#include "carat/io/mesh_file.h"
#include "carat/report/html_view.h"
#include "modules.h"
#include "run.h"

namespace carat::python {
namespace {

using NamedArrays = std::vector<std::pair<std::string, In<double>>>;
using Patches = std::vector<std::tuple<std::string, std::string, In<Index>>>;

std::vector<Field> to_fields(const NamedArrays& arrays) {
  std::vector<Field> fields;
  for (const auto& [name, array] : arrays)
    fields.push_back({name,
                      array.ndim() == 1 ? 1 : static_cast<Index>(array.shape(1)),
                      {array.data(), array.data() + array.size()}});
  return fields;
}

py::dict from_fields(std::vector<Field>&& fields) {
  py::dict dict;
  for (Field& field : fields) {
    const py::ssize_t rows = field.n_rows(), columns = field.components;
    auto held = std::make_shared<std::vector<double>>(std::move(field.values));
    const double* const data = held->data();
    dict[py::str(field.name)] = columns == 1 ? array_over(std::move(held), data, {rows})
                                             : array_over(std::move(held), data, {rows, columns});
  }
  return dict;
}

/// (mesh, vertex fields, element fields, patches: name -> (type, faces)).
py::tuple from_data(SurfaceData&& data) {
  return py::make_tuple(std::make_shared<PolygonMesh>(std::move(data.mesh)),
                        from_fields(std::move(data.fields.vertex)),
                        from_fields(std::move(data.fields.face)), py::dict());
}
py::tuple from_data(VolumeData&& data) {
  py::dict patches;
  for (BoundaryPatch& patch : data.patches)
    patches[py::str(patch.name)] = py::make_tuple(patch.type, moved_vector(std::move(patch.faces)));
  return py::make_tuple(std::make_shared<PolyhedralMesh>(std::move(data.mesh)),
                        from_fields(std::move(data.fields.vertex)),
                        from_fields(std::move(data.fields.cell)), patches);
}

std::vector<BoundaryPatch> to_patches(const Patches& patches) {
  std::vector<BoundaryPatch> list;
  for (const auto& [name, type, faces] : patches) list.push_back({name, type, to_list(faces)});
  return list;
}

MeshData to_data(const Surface& mesh, const NamedArrays& vertex, const NamedArrays& element,
                 const Patches&) {
  return SurfaceData{*mesh, {to_fields(vertex), to_fields(element)}};
}
MeshData to_data(const Volume& mesh, const NamedArrays& vertex, const NamedArrays& element,
                 const Patches& patches) {
  return VolumeData{*mesh, {to_fields(vertex), {}, to_fields(element)}, to_patches(patches)};
}

bool write_data(const std::filesystem::path& path, const MeshData& data) {
  if (const auto* const surface = std::get_if<SurfaceData>(&data)) {
    write_surface(path, surface->mesh, surface->fields);
  } else {
    const auto& volume = std::get<VolumeData>(data);
    write_volume(path, volume.mesh, volume.fields, volume.patches);
  }
  return true;
}

template <class Mesh>
void define_writers(py::module_& module) {
  module.def(
      "write", [](const std::string& path, const std::shared_ptr<Mesh>& mesh,
                  const NamedArrays& vertex, const NamedArrays& element, const Patches& patches) {
        const auto data = std::make_shared<MeshData>(to_data(mesh, vertex, element, patches));
        run([=](Job&) { return write_data(path, *data); });
      });
  module.def("write_view",
             [](const std::string& path, const std::shared_ptr<Mesh>& mesh,
                const NamedArrays& vertex, const NamedArrays& element, const std::string& title) {
               const auto items = std::make_shared<std::vector<ViewItem>>();
               items->push_back({title, to_data(mesh, vertex, element, {})});
               run([=](Job&) {
                 write_html_view(path, *items, title);
                 return true;
               });
             });
}

}  // namespace

void define_files(py::module_& module) {
  module.def("read", [](const std::string& path) {
    MeshData data = run([=](Job&) { return read_mesh(path); });
    return std::visit([](auto& held) { return from_data(std::move(held)); }, data);
  });
  define_writers<PolygonMesh>(module);
  define_writers<PolyhedralMesh>(module);
  module.def("formats", [] {
    py::list list;
    for (const FileFormat& f : file_formats())
      list.append(py::make_tuple(f.name, f.title, f.extensions, f.surfaces && f.reads,
                                 f.surfaces && f.writes, f.reads_volumes, f.writes_volumes,
                                 f.fields));
    return list;
  });
}

}  // namespace carat::python
