#include "carat/distributed/write_parts.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "carat/base/error.h"
#include "carat/distributed/processes.h"
#include "carat/io/mesh_file.h"
#include "carat/io/parallel_vtk.h"

namespace carat {
namespace {

namespace fs = std::filesystem;

/// Which vertices of the part go with its own elements; those without any go with the first part.
template <class Visit>
std::vector<bool> used_vertices(const PartNumbers& numbers, const Visit& visit_vertices) {
  std::vector<bool> used(numbers.vertices.size(), false);
  for (std::size_t v = 0; v < used.size(); ++v) used[v] = numbers.vertex_components[v] < 0;
  for (std::size_t e = 0; e < numbers.own_elements.size(); ++e)
    if (numbers.own_elements[e])
      for (const Index v : visit_vertices(static_cast<Index>(e)))
        used[static_cast<std::size_t>(v)] = true;
  return used;
}

Points select(const Points& points, const std::vector<Index>& rows) {
  return points(rows, Eigen::all);
}

std::vector<Index> places(const std::vector<bool>& flags) {
  std::vector<Index> places;
  for (std::size_t k = 0; k < flags.size(); ++k)
    if (flags[k]) places.push_back(static_cast<Index>(k));
  return places;
}

Csr renumbered(Csr rows, const std::vector<Index>& kept, std::size_t n) {
  std::vector<Index> number(n, -1);
  for (std::size_t k = 0; k < kept.size(); ++k) number[kept[k]] = static_cast<Index>(k);
  for (Index& index : rows.indices) index = number[index];
  return rows;
}

PolygonMesh with_vertices(const PolygonMesh& mesh, const std::vector<Index>& kept) {
  return PolygonMesh(select(mesh.points(), kept),
                     renumbered(mesh.faces(), kept, static_cast<std::size_t>(mesh.n_vertices())));
}

PolyhedralMesh with_vertices(const PolyhedralMesh& mesh, const std::vector<Index>& kept) {
  return PolyhedralMesh::from_face_cells(
      select(mesh.points(), kept),
      renumbered(mesh.face_mesh().faces(), kept, static_cast<std::size_t>(mesh.n_vertices())),
      mesh.cells(), mesh.face_cells());
}

std::vector<Field> select(const std::vector<Field>& fields, const std::vector<Index>& rows) {
  std::vector<Field> selected;
  for (const Field& field : fields) {
    Field& own = selected.emplace_back(Field{field.name, field.components, {}});
    own.values.reserve(rows.size() * static_cast<std::size_t>(field.components));
    for (const Index row : rows)
      for (Index j = 0; j < field.components; ++j)
        own.values.push_back(field.values[static_cast<std::size_t>(row * field.components + j)]);
  }
  return selected;
}

Field number_field(const std::string& name, const Array<Index>& numbers,
                   const std::vector<Index>& rows) {
  Field field{name, 1, {}};
  for (const Index row : rows) field.values.push_back(numbers[row]);
  return field;
}

std::vector<Field>& element_fields(MeshFields& fields, const PolygonMesh&) { return fields.face; }
std::vector<Field>& element_fields(MeshFields& fields, const PolyhedralMesh&) {
  return fields.cell;
}
auto vertices_of(const PolygonMesh& mesh) {
  return [&](Index face) { return mesh.face(face); };
}
auto vertices_of(const PolyhedralMesh& mesh) {
  return [&](Index cell) { return mesh.cell_vertices().row(cell); };
}

struct Piece {
  std::vector<FieldShape> vertex_fields, element_fields;
};

std::vector<FieldShape> shapes(const std::vector<Field>& fields) {
  std::vector<FieldShape> shapes;
  for (const Field& field : fields) shapes.push_back({field.name, field.components});
  return shapes;
}

/// Writes the part's own elements.
template <class Mesh>
Piece write_piece(const fs::path& path, const MeshPart<Mesh>& part, const MeshFields& fields) {
  constexpr bool kSurface = std::is_same_v<Mesh, PolygonMesh>;
  const PartNumbers& numbers = part.numbers;
  const std::vector<Index> vertices = places(used_vertices(numbers, vertices_of(part.mesh)));
  const std::vector<Index> elements = places(numbers.own_elements);
  MeshFields all = fields, own;
  own.vertex = select(all.vertex, vertices);
  own.vertex.push_back(number_field("vertex_id", numbers.vertices, vertices));
  std::vector<Field>& of_elements = element_fields(own, part.mesh);
  of_elements = select(element_fields(all, part.mesh), elements);
  of_elements.push_back(number_field(kSurface ? "face_id" : "cell_id", numbers.elements, elements));
  of_elements.push_back(
      {"part", 1, std::vector<double>(elements.size(), static_cast<double>(numbers.part))});
  const Mesh mesh = with_vertices(own_mesh(part), vertices);
  if constexpr (kSurface)
    write_surface(path, mesh, own);
  else
    write_volume(path, mesh, own);
  return {shapes(own.vertex), shapes(of_elements)};
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (failure) throw IoError(to.string() + ": cannot be written: " + failure.message());
}

/// A file that is removed in the end unless it was moved elsewhere.
class Temporary {
 public:
  explicit Temporary(fs::path path) : path_(std::move(path)) {}
  ~Temporary() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

template <class Mesh>
void write(const fs::path& path, const MeshPart<Mesh>& part, const MeshFields& fields) {
  const bool of_surfaces = path.extension() == ".pvtp";
  const std::string extension = of_surfaces ? ".vtp" : ".vtu", stem = path.stem().string(),
                    unique = ".part" + std::to_string(::getpid());
  const auto name_of = [&](int process) { return stem + "_" + std::to_string(process); };
  const std::string own = name_of(own_rank());
  const Temporary piece(path.parent_path() / (own + unique + extension)),
      index(path.parent_path() / (stem + unique + path.extension().string()));
  const fs::path target = path.parent_path() / (own + extension);
  Piece written;
  together([&] {
    std::error_code ignored;
    for (const fs::path& final_name : {path, target})
      if (fs::is_directory(final_name, ignored))
        throw IoError(final_name.string() + ": cannot be written: it is a folder; remove it");
    if (of_surfaces && std::is_same_v<Mesh, PolyhedralMesh>)
      throw InvalidOption(path.string() + ": of volumes the parts are written as .pvtu");
    written = write_piece(piece.path(), part, fields);
  });
  on_first([&] {
    std::vector<std::string> pieces;
    for (int process = 0; process < n_processes(); ++process)
      pieces.push_back(name_of(process) + extension);
    write_parallel_index(index.path(), pieces, written.vertex_fields, written.element_fields);
    // It would name pieces of both runs if the rest failed.
    std::error_code failure;
    fs::remove(path, failure);
    if (failure) throw IoError(path.string() + ": cannot be written: " + failure.message());
  });
  together([&] { move_file(piece.path(), target); });
  on_first([&] { move_file(index.path(), path); });
}

}  // namespace

bool is_parallel_index(const fs::path& path) {
  return path.extension() == ".pvtu" || path.extension() == ".pvtp";
}

void write_parts(const fs::path& path, const MeshPart<PolygonMesh>& part,
                 const MeshFields& fields) {
  write(path, part, fields);
}

void write_parts(const fs::path& path, const MeshPart<PolyhedralMesh>& part,
                 const MeshFields& fields) {
  write(path, part, fields);
}

}  // namespace carat
