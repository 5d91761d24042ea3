#include "carat/distributed/mesh_pieces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include "carat/base/error.h"
#include "carat/distributed/exchange.h"
#include "carat/distributed/message.h"
#include "carat/distributed/piece_interfaces.h"
#include "carat/distributed/piece_numbers.h"

namespace carat {
namespace {

constexpr std::size_t kIndexLimit = std::numeric_limits<Index>::max();

Index n_elements(const PolygonMesh& mesh) { return mesh.n_faces(); }
Index n_elements(const PolyhedralMesh& mesh) { return mesh.n_cells(); }
std::span<const Index> vertices_of(const PolygonMesh& mesh, Index face) { return mesh.face(face); }
std::span<const Index> vertices_of(const PolyhedralMesh& mesh, Index cell) {
  return mesh.cell_vertices().row(cell);
}
std::vector<Field>& element_fields(MeshFields& fields, const PolygonMesh&) { return fields.face; }
std::vector<Field>& element_fields(MeshFields& fields, const PolyhedralMesh&) {
  return fields.cell;
}

/// Elements with their vertices and interfaces, all by their numbers in the whole mesh.
struct Bundle {
  Array<Index> vertices, rows, components;
  Array<double> places;                                      ///< three a vertex
  std::vector<Array<double>> vertex_values, element_values;  ///< field by field
  Array<Index> elements;
  Csr entries;  ///< element -> vertices, of volumes -> places in `interfaces`
  /// Of surfaces those of the entries; of volumes the faces, with what follows.
  Array<std::int64_t> interfaces;
  Csr faces, patches;  ///< face -> vertices, -> patches that it is in
  Array<FaceCells> sides;
};

/// Calls visit(list) for each plain list.
template <class AnyBundle, class Visit>
void for_lists(AnyBundle& bundle, const Visit& visit) {
  visit(bundle.vertices);
  visit(bundle.rows);
  visit(bundle.components);
  visit(bundle.places);
  for (auto& values : bundle.vertex_values) visit(values);
  for (auto& values : bundle.element_values) visit(values);
  visit(bundle.elements);
  visit(bundle.interfaces);
  visit(bundle.sides);
}

void put(Message& message, const Bundle& bundle) {
  for_lists(bundle, [&](const auto& list) { message.put_list(list); });
  for (const Csr* rows : {&bundle.entries, &bundle.faces, &bundle.patches}) put(message, *rows);
}

void take(Message& message, Bundle& bundle) {
  for_lists(bundle, [&](auto& list) { message.take_list(list); });
  for (Csr* rows : {&bundle.entries, &bundle.faces, &bundle.patches}) take(message, *rows);
}

/// What a row of a Csr has, to the end of another one.
void append_row(Csr& rows, std::span<const Index> row) {
  if (rows.indices.size() + row.size() > kIndexLimit)
    throw InvalidMesh("a part has more than " + std::to_string(kIndexLimit) +
                      " corners; use more processes");
  rows.indices.insert(rows.indices.end(), row.begin(), row.end());
  rows.offsets.push_back(static_cast<Index>(rows.indices.size()));
}

void append_values(Array<double>& to, std::span<const double> from, std::size_t row,
                   std::size_t components) {
  const double* const first = from.data() + row * components;
  to.insert(to.end(), first, first + components);
}

/// Which bundle, and where in it.
template <class Number>
struct Place {
  Number number;
  std::uint32_t bundle, row;
};

/// The places of all numbers, ascending, each once: in the first bundle that has it.
template <class Number>
std::vector<Place<Number>> places_of(const std::vector<Bundle>& bundles,
                                     Array<Number> Bundle::*numbers) {
  using Entry = Place<Number>;
  std::vector<Entry> places;
  std::size_t n = 0;
  for (const Bundle& bundle : bundles) n += (bundle.*numbers).size();
  if (n > kIndexLimit)
    throw InvalidMesh("a part has more than " + std::to_string(kIndexLimit) +
                      " corners; use more processes");
  places.reserve(n);
  for (std::size_t b = 0; b < bundles.size(); ++b)
    for (std::size_t k = 0; k < (bundles[b].*numbers).size(); ++k)
      places.push_back(
          {(bundles[b].*numbers)[k], static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(k)});
  std::sort(places.begin(), places.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.number, a.bundle, a.row) < std::tie(b.number, b.bundle, b.row);
  });
  places.erase(std::unique(places.begin(), places.end(),
                           [](const Entry& a, const Entry& b) { return a.number == b.number; }),
               places.end());
  return places;
}

template <class Number>
Array<Number> numbers_of(const std::vector<Place<Number>>& places) {
  Array<Number> numbers;
  numbers.reserve(places.size());
  for (const Place<Number>& place : places) numbers.push_back(place.number);
  return numbers;
}

/// Where a number is in an ascending list; -1: nowhere.
template <class Number>
Index find(const Array<Number>& numbers, Number number) {
  const auto at = std::lower_bound(numbers.begin(), numbers.end(), number);
  return at != numbers.end() && *at == number ? static_cast<Index>(at - numbers.begin()) : -1;
}

/// Rows of all bundles, with their entries numbered as here(bundle, entry) says.
template <class Number, class Here>
Csr collect(const std::vector<Bundle>& bundles, Csr Bundle::*rows,
            const std::vector<Place<Number>>& places, const Here& here) {
  Csr collected;
  std::vector<Index> row;
  for (const Place<Number>& place : places) {
    row.clear();
    const Bundle& bundle = bundles[place.bundle];
    for (const Index entry : (bundle.*rows).row(static_cast<Index>(place.row)))
      row.push_back(here(bundle, entry));
    append_row(collected, row);
  }
  return collected;
}

std::vector<Field> collect(const std::vector<Bundle>& bundles,
                           std::vector<Array<double>> Bundle::*values,
                           const std::vector<Place<Index>>& places,
                           const std::vector<Field>& shapes) {
  std::vector<Field> fields;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    Field field{shapes[k].name, shapes[k].components, {}};
    const auto components = static_cast<std::size_t>(field.components);
    field.values.reserve(places.size() * components);
    for (const Place<Index>& place : places) {
      const double* const first =
          (bundles[place.bundle].*values)[k].data() + place.row * components;
      field.values.insert(field.values.end(), first, first + components);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

/// Names and components of fields, without values.
std::vector<Field> shapes_of(const std::vector<Field>& fields) {
  std::vector<Field> shapes;
  for (const Field& field : fields) shapes.push_back({field.name, field.components, {}});
  return shapes;
}

void put(Message& message, const std::vector<Field>& shapes) {
  message.put(static_cast<std::uint64_t>(shapes.size()));
  for (const Field& field : shapes) {
    message.put_list(field.name);
    message.put(field.components);
  }
}

void take(Message& message, std::vector<Field>& shapes) {
  std::uint64_t n = 0;
  message.take(n);
  shapes.resize(static_cast<std::size_t>(n));
  for (Field& field : shapes) {
    message.take_list(field.name);
    message.take(field.components);
  }
}

/// Collective. The fields of the first process that has rows. A process without any gets them; in
/// any other they must be the same, and are put into the same order.
void agree_on(std::vector<Field>& fields, bool has_rows, const std::string& where) {
  Message message;
  message.put(has_rows);
  put(message, shapes_of(fields));
  std::vector<Field> expected;
  std::size_t first = 0;
  bool found = false;
  for (Message& other : all_of(message)) {
    other.take(found);
    if (found) {
      take(other, expected);
      break;
    }
    ++first;
  }
  together([&] {
    if (!found || !has_rows) {
      fields = found ? std::move(expected) : std::vector<Field>();
      return;
    }
    const auto same_as = [](const Field& shape) {
      return [&shape](const Field& field) {
        return field.name == shape.name && field.components == shape.components;
      };
    };
    std::vector<Field> ordered;
    for (const Field& shape : expected) {
      const auto at = std::find_if(fields.begin(), fields.end(), same_as(shape));
      if (at == fields.end())
        throw IoError("its piece has no " + where + " field '" + shape.name + "' of " +
                      std::to_string(shape.components) + " components, that of process " +
                      std::to_string(first) + " has; the pieces are not of one mesh");
      ordered.push_back(std::move(*at));
      fields.erase(at);
    }
    if (!fields.empty())
      throw IoError("its piece has a " + where + " field '" + fields.front().name + "' of " +
                    std::to_string(fields.front().components) + " components, that of process " +
                    std::to_string(first) + " has none; the pieces are not of one mesh");
    fields = std::move(ordered);
  });
}

/// Collective. The patches of all processes by name, without faces, those of the first ones first;
/// the result says which of them each of `own` is.
std::vector<Index> agree_on(const std::vector<BoundaryPatch>& own,
                            std::vector<BoundaryPatch>& patches) {
  Message message;
  message.put(static_cast<std::uint64_t>(own.size()));
  for (const BoundaryPatch& patch : own) {
    message.put_list(patch.name);
    message.put_list(patch.type);
  }
  const auto place = [&](const std::string& name) {
    return static_cast<Index>(
        std::find_if(patches.begin(), patches.end(),
                     [&](const BoundaryPatch& patch) { return patch.name == name; }) -
        patches.begin());
  };
  for (Message& other : all_of(message)) {
    std::uint64_t n = 0;
    other.take(n);
    for (std::uint64_t k = 0; k < n; ++k) {
      BoundaryPatch patch;
      other.take_list(patch.name);
      other.take_list(patch.type);
      if (place(patch.name) == static_cast<Index>(patches.size()))
        patches.push_back(std::move(patch));
    }
  }
  std::vector<Index> numbers;
  for (const BoundaryPatch& patch : own) numbers.push_back(place(patch.name));
  return numbers;
}

/// Collective. Whether ids are known; in all pieces or none.
bool agree_on_ids(const std::vector<std::int64_t>& ids, std::size_t n, const std::string& what) {
  const bool none = ids.empty() && n > 0;
  const bool known = most_of_all(!ids.empty() ? 1 : 0) == 1;
  together([&] {
    if (known && none)
      throw InvalidMesh("its piece has no global ids of " + what +
                        ", but others have; all pieces need them or none");
    if (!ids.empty() && ids.size() != n)
      throw InvalidMesh("its piece has " + std::to_string(ids.size()) + " global ids for " +
                        std::to_string(n) + " " + what);
  });
  return known;
}

/// Connected components of a piece by its elements: vertex -> component; -1: no element has it.
template <class Mesh>
std::vector<Index> components_of(const Mesh& mesh) {
  std::vector<Index> root(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(root.begin(), root.end(), 0);
  const auto find_root = [&](Index v) {
    while (root[static_cast<std::size_t>(v)] != v) {
      Index& next = root[static_cast<std::size_t>(v)];
      v = next = root[static_cast<std::size_t>(next)];
    }
    return v;
  };
  std::vector<Index> component(root.size(), -1);
  for (Index e = 0; e < n_elements(mesh); ++e)
    for (const Index v : vertices_of(mesh, e)) {
      component[static_cast<std::size_t>(v)] = 0;
      const Index a = find_root(v), b = find_root(vertices_of(mesh, e).front());
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  Index n = 0;
  for (std::size_t v = 0; v < root.size(); ++v) {
    if (component[v] < 0) continue;
    const auto lowest = static_cast<std::size_t>(find_root(static_cast<Index>(v)));
    component[v] = lowest == v ? n++ : component[lowest];
  }
  return component;
}

/// Vertex -> numbers of the elements that have it, as often as they do.
template <class Mesh>
Csr elements_of_vertices(const Mesh& mesh, const Numbering& elements) {
  Csr result;
  result.offsets.assign(static_cast<std::size_t>(mesh.n_vertices()) + 1, 0);
  for (Index e = 0; e < n_elements(mesh); ++e)
    for (const Index v : vertices_of(mesh, e)) ++result.offsets[static_cast<std::size_t>(v) + 1];
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  Array<Index> next(result.offsets.begin(), result.offsets.end() - 1);
  result.indices.resize(static_cast<std::size_t>(result.offsets.back()));
  for (Index e = 0; e < n_elements(mesh); ++e)
    for (const Index v : vertices_of(mesh, e))
      result.indices[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] =
          elements.numbers[static_cast<std::size_t>(e)];
  return result;
}

/// Takes some elements of a piece with all that they need, numbered as in the whole mesh.
template <class Mesh>
class Packer {
 public:
  Packer(const MeshPiece<Mesh>& piece, const Numbering& vertices, const Numbering& elements,
         const VertexBook& vertex_book, const InterfaceBook& interface_book,
         const std::vector<Index>& patch_numbers)
      : piece_(piece),
        vertices_(vertices),
        elements_(elements),
        vertex_book_(vertex_book),
        interface_book_(interface_book),
        vertex_taken_(vertices.numbers.size(), 0) {
    if constexpr (std::is_same_v<Mesh, PolyhedralMesh>) {
      face_taken_.assign(static_cast<std::size_t>(piece.mesh.n_faces()), 0);
      face_place_.resize(face_taken_.size());
      std::vector<std::pair<Index, Index>> in_patch;
      for (std::size_t k = 0; k < piece.patches.size(); ++k)
        for (const Index f : piece.patches[k].faces) in_patch.emplace_back(f, patch_numbers[k]);
      std::sort(in_patch.begin(), in_patch.end());
      std::size_t next = 0;
      for (Index f = 0; f < piece.mesh.n_faces(); ++f) {
        for (; next < in_patch.size() && in_patch[next].first == f; ++next)
          patches_.indices.push_back(in_patch[next].second);
        patches_.offsets.push_back(static_cast<Index>(patches_.indices.size()));
      }
    }
  }

  Bundle pack(std::span<const Index> elements) {
    ++round_;
    Bundle bundle = empty();
    for (const Index e : elements) {
      bundle.elements.push_back(elements_.numbers[static_cast<std::size_t>(e)]);
      const std::vector<Field>& fields = fields_of_elements();
      for (std::size_t k = 0; k < fields.size(); ++k)
        append_values(bundle.element_values[k], fields[k].values, static_cast<std::size_t>(e),
                      static_cast<std::size_t>(fields[k].components));
      for (const Index v : vertices_of(piece_.mesh, e)) take_vertex(bundle, v);
      add_element(bundle, piece_.mesh, e);
    }
    return bundle;
  }

  /// Those without elements that this process brings.
  Bundle pack_loose() {
    ++round_;
    Bundle bundle = empty();
    for (std::size_t v = 0; v < vertices_.numbers.size(); ++v)
      if (vertex_book_.is_loose[v]) take_vertex(bundle, static_cast<Index>(v));
    return bundle;
  }

 private:
  const std::vector<Field>& fields_of_elements() const {
    return std::is_same_v<Mesh, PolygonMesh> ? piece_.fields.face : piece_.fields.cell;
  }

  Bundle empty() const {
    Bundle bundle;
    bundle.vertex_values.resize(piece_.fields.vertex.size());
    bundle.element_values.resize(fields_of_elements().size());
    return bundle;
  }

  void take_vertex(Bundle& bundle, Index vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    if (vertex_taken_[v] == round_) return;
    vertex_taken_[v] = round_;
    bundle.vertices.push_back(vertices_.numbers[v]);
    bundle.rows.push_back(vertex_book_.rows[v]);
    bundle.components.push_back(vertex_book_.components[v]);
    append_values(bundle.places, {piece_.mesh.points().data(), 3 * vertices_.numbers.size()}, v, 3);
    const std::vector<Field>& fields = piece_.fields.vertex;
    for (std::size_t k = 0; k < fields.size(); ++k)
      append_values(bundle.vertex_values[k], fields[k].values, v,
                    static_cast<std::size_t>(fields[k].components));
  }

  void add_element(Bundle& bundle, const PolygonMesh& mesh, Index e) {
    row_.clear();
    for (Index c = mesh.faces().begin(e); c < mesh.faces().end(e); ++c) {
      const auto corner = static_cast<std::size_t>(c);
      row_.push_back(vertices_.numbers[static_cast<std::size_t>(mesh.faces().indices[corner])]);
      bundle.interfaces.push_back(
          interface_book_.numbers[static_cast<std::size_t>(mesh.edges().of_corner[corner])]);
    }
    append_row(bundle.entries, row_);
  }

  void add_element(Bundle& bundle, const PolyhedralMesh& mesh, Index e) {
    row_.clear();
    for (const Index face : mesh.cell(e)) {
      const auto f = static_cast<std::size_t>(face);
      if (face_taken_[f] == round_) {
        row_.push_back(face_place_[f]);
        continue;
      }
      face_taken_[f] = round_;
      face_place_[f] = static_cast<Index>(bundle.interfaces.size());
      row_.push_back(face_place_[f]);
      bundle.interfaces.push_back(interface_book_.numbers[f]);
      bundle.sides.push_back(interface_book_.sides[f]);
      append_row(bundle.faces, interface_book_.faces.row(face));
      append_row(bundle.patches, patches_.row(face));
    }
    append_row(bundle.entries, row_);
  }

  const MeshPiece<Mesh>& piece_;
  const Numbering &vertices_, &elements_;
  const VertexBook& vertex_book_;
  const InterfaceBook& interface_book_;
  Csr patches_;  // face -> its patches in the whole mesh
  int round_ = 0;
  std::vector<int> vertex_taken_, face_taken_;
  std::vector<Index> face_place_;  // in the bundle of the round
  std::vector<Index> row_;
};

/// Entries that are numbers of vertices.
auto vertices_in(const PartNumbers& numbers) {
  return [&numbers](const Bundle&, Index vertex) { return find(numbers.vertices, vertex); };
}

PolygonMesh make_mesh(const std::vector<Bundle>& bundles, const std::vector<Place<Index>>& elements,
                      const PartNumbers& numbers, Points points, std::vector<BoundaryPatch>&,
                      const PolygonMesh&) {
  return PolygonMesh(std::move(points),
                     collect(bundles, &Bundle::entries, elements, vertices_in(numbers)));
}

PolyhedralMesh make_mesh(const std::vector<Bundle>& bundles,
                         const std::vector<Place<Index>>& elements, const PartNumbers& numbers,
                         Points points, std::vector<BoundaryPatch>& patches,
                         const PolyhedralMesh&) {
  const std::vector<Place<std::int64_t>> places = places_of(bundles, &Bundle::interfaces);
  const auto here = [&](Index cell) { return cell < 0 ? -1 : find(numbers.elements, cell); };
  Array<FaceCells> face_cells;
  for (const Place<std::int64_t>& place : places) {
    const Bundle& bundle = bundles[place.bundle];
    const FaceCells sides = bundle.sides[place.row];
    for (const Index patch : bundle.patches.row(static_cast<Index>(place.row)))
      patches[static_cast<std::size_t>(patch)].faces.push_back(
          static_cast<Index>(face_cells.size()));
    face_cells.push_back({here(sides.below), here(sides.above)});
  }
  return PolyhedralMesh::from_face_cells(
      std::move(points), collect(bundles, &Bundle::faces, places, vertices_in(numbers)),
      collect(bundles, &Bundle::entries, elements,
              [&](const Bundle& bundle, Index face) {
                return find(numbers.interfaces, bundle.interfaces[static_cast<std::size_t>(face)]);
              }),
      std::move(face_cells));
}

InterfaceBook keep(const MeshPiece<PolygonMesh>& piece, const Numbering& vertices,
                   const Numbering& elements, std::int64_t first) {
  return keep_interfaces(piece.mesh, vertices, elements, first);
}

InterfaceBook keep(const MeshPiece<PolyhedralMesh>& piece, const Numbering& vertices,
                   const Numbering& elements, std::int64_t first) {
  const bool have_ids =
      agree_on_ids(piece.interface_ids, static_cast<std::size_t>(piece.mesh.n_faces()), "faces");
  return keep_interfaces(piece.mesh, vertices, elements, piece.interface_ids, have_ids, first);
}

/// What a process has to make its part of.
struct Packed {
  std::vector<Bundle> bundles;  ///< its own elements, then those from others
  Array<std::int64_t> own_interfaces;
  PartNumbers numbers;                               ///< those of the whole mesh
  std::vector<Field> vertex_fields, element_fields;  ///< without values
  std::vector<BoundaryPatch> patches;                ///< without faces
};

/// Collective. The piece and all lists about it are gone when it returns.
template <class Mesh>
Packed pack(MeshPiece<Mesh> piece, std::int64_t first_interface) {
  Packed packed;
  const auto n_vertices = static_cast<std::size_t>(piece.mesh.n_vertices());
  const auto n_own = static_cast<std::size_t>(n_elements(piece.mesh));
  std::vector<Field>& of_elements = element_fields(piece.fields, piece.mesh);
  agree_on(piece.fields.vertex, n_vertices > 0, "vertex");
  agree_on(of_elements, n_own > 0, "element");
  packed.vertex_fields = shapes_of(piece.fields.vertex);
  packed.element_fields = shapes_of(of_elements);
  const std::vector<Index> patch_numbers = agree_on(piece.patches, packed.patches);

  const std::vector<Index> component = components_of(piece.mesh);
  std::vector<bool> used(n_vertices);
  for (std::size_t v = 0; v < n_vertices; ++v) used[v] = component[v] >= 0;
  const Numbering vertices = agree_on_ids(piece.vertex_ids, n_vertices, "vertices")
                                 ? number_ids(piece.vertex_ids, "vertices", false)
                                 : number_places(piece.mesh.points(), used);
  const Numbering elements = agree_on_ids(piece.element_ids, n_own, "elements")
                                 ? number_ids(piece.element_ids, "elements", true)
                                 : number_in_order(n_own, "elements");
  const VertexBook vertex_book = keep_vertices(
      vertices, piece.mesh.points(), elements_of_vertices(piece.mesh, elements), component);
  const InterfaceBook interface_book = keep(piece, vertices, elements, first_interface);
  const int rank = own_rank();
  const auto n = static_cast<std::size_t>(n_processes());
  packed.numbers.part = rank;
  packed.numbers.n_parts = static_cast<Index>(n);
  packed.numbers.first_row = vertex_book.first_row;
  packed.numbers.end_row = vertex_book.end_row;
  packed.numbers.n_vertices = vertices.n;
  packed.numbers.n_components = vertex_book.n_components;

  std::vector<Message> messages(n);
  together([&] {
    Packer<Mesh> packer(piece, vertices, elements, vertex_book, interface_book, patch_numbers);
    std::vector<Index> list(n_own);
    std::iota(list.begin(), list.end(), 0);
    packed.bundles.push_back(packer.pack(list));
    for (std::size_t k = 0, p = 0; p < n; ++p) {
      list.clear();
      for (;
           k < interface_book.halo.size() && interface_book.halo[k].process == static_cast<int>(p);
           ++k)
        list.push_back(interface_book.halo[k].element);
      put(messages[p], packer.pack(list));
      if (p == 0) put(messages[p], packer.pack_loose());
    }
    for (std::size_t i = 0; i < interface_book.numbers.size(); ++i)
      if (interface_book.own[i]) packed.own_interfaces.push_back(interface_book.numbers[i]);
  });
  for (Message& message : exchange(messages))
    for (int k = 0; k < (rank == 0 ? 2 : 1); ++k) {
      Bundle bundle;
      bundle.vertex_values.resize(packed.vertex_fields.size());
      bundle.element_values.resize(packed.element_fields.size());
      take(message, bundle);
      packed.bundles.push_back(std::move(bundle));
    }
  return packed;
}

template <class Mesh>
PartData<Mesh> assemble(Packed packed) {
  const std::vector<Bundle>& bundles = packed.bundles;
  PartNumbers& numbers = packed.numbers;
  PartData<Mesh> data;
  const std::vector<Place<Index>> elements = places_of(bundles, &Bundle::elements);
  numbers.elements = numbers_of(elements);
  numbers.interfaces = numbers_of(places_of(bundles, &Bundle::interfaces));
  for (const Place<Index>& place : elements) numbers.own_elements.push_back(place.bundle == 0);
  std::sort(packed.own_interfaces.begin(), packed.own_interfaces.end());
  for (const std::int64_t i : numbers.interfaces)
    numbers.own_interfaces.push_back(find(packed.own_interfaces, i) >= 0);
  const std::vector<Place<Index>> vertices = places_of(bundles, &Bundle::vertices);
  numbers.vertices = numbers_of(vertices);
  Points points(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Bundle& bundle = bundles[vertices[k].bundle];
    const std::size_t row = vertices[k].row;
    numbers.vertex_rows.push_back(bundle.rows[row]);
    numbers.vertex_components.push_back(bundle.components[row]);
    for (std::size_t x = 0; x < 3; ++x)
      points(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(x)) =
          bundle.places[3 * row + x];
  }
  data.fields.vertex = collect(bundles, &Bundle::vertex_values, vertices, packed.vertex_fields);
  element_fields(data.fields, data.part.mesh) =
      collect(bundles, &Bundle::element_values, elements, packed.element_fields);
  data.part.mesh =
      make_mesh(bundles, elements, numbers, std::move(points), packed.patches, data.part.mesh);
  data.part.numbers = std::move(numbers);
  data.patches = std::move(packed.patches);
  return data;
}

template <class Mesh>
PartData<Mesh> join(MeshPiece<Mesh> piece, std::int64_t first_interface) {
  Packed packed = pack(std::move(piece), first_interface);
  PartData<Mesh> data;
  together([&] { data = assemble<Mesh>(std::move(packed)); });
  return data;
}

}  // namespace

PartData<PolygonMesh> join_pieces(MeshPiece<PolygonMesh> piece, std::int64_t first_interface) {
  return join(std::move(piece), first_interface);
}
PartData<PolyhedralMesh> join_pieces(MeshPiece<PolyhedralMesh> piece,
                                     std::int64_t first_interface) {
  return join(std::move(piece), first_interface);
}

}  // namespace carat
