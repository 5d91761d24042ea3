#include "carat/mesh/mesh_part.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat {
namespace {

/// Elements, interfaces and vertices of either kind of mesh under the same names.
struct Surface {
  const PolygonMesh& mesh;

  Index n_elements() const { return mesh.n_faces(); }
  Index n_interfaces() const { return mesh.n_edges(); }
  std::span<const Index> vertices(Index element) const { return mesh.face(element); }
  template <class Visit>
  void for_elements(Index interface, const Visit& visit) const {
    for (const Index corner : mesh.edges().corners.row(interface))
      visit(mesh.corner_faces()[corner]);
  }
  template <class Visit>
  void for_elements_of_vertex(Index v, const Visit& visit) const {
    for (const Index corner : mesh.vertex_corners().row(v)) visit(mesh.corner_faces()[corner]);
  }
  template <class Visit>
  void for_interfaces(Index element, const Visit& visit) const {
    for (Index c = mesh.faces().begin(element); c < mesh.faces().end(element); ++c)
      visit(mesh.edges().of_corner[c]);
  }
};

struct Volume {
  const PolyhedralMesh& mesh;

  Index n_elements() const { return mesh.n_cells(); }
  Index n_interfaces() const { return mesh.n_faces(); }
  std::span<const Index> vertices(Index element) const { return mesh.cell_vertices().row(element); }
  template <class Visit>
  void for_elements(Index interface, const Visit& visit) const {
    const auto [low, high] =
        std::minmax(mesh.face_cells()[interface].below, mesh.face_cells()[interface].above);
    if (low >= 0) visit(low);
    if (high >= 0) visit(high);
  }
  template <class Visit>
  void for_elements_of_vertex(Index v, const Visit& visit) const {
    for (const Index corner : mesh.vertex_cell_corners().row(v)) visit(mesh.corner_cells()[corner]);
  }
  template <class Visit>
  void for_interfaces(Index element, const Visit& visit) const {
    for (const Index f : mesh.cell(element)) visit(f);
  }
};

void sort_unique(Array<Index>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Place of a number in an ascending list that holds it.
Index place(const Array<Index>& numbers, Index number) {
  return static_cast<Index>(std::lower_bound(numbers.begin(), numbers.end(), number) -
                            numbers.begin());
}

/// The part of one of the elements that `for_elements` names, chosen by their numbers; -1: there is
/// none. `parts` receives those of all.
template <class ForElements>
Index choose(const Array<Index>& element_part, std::vector<Index>& parts,
             const ForElements& for_elements) {
  parts.clear();
  std::uint64_t sum = 0;
  for_elements([&](Index element) {
    parts.push_back(element_part[element]);
    sum += static_cast<std::uint64_t>(element);
  });
  return choose_part(parts, sum);
}

template <class View>
void find_components(const View& view, Index n_vertices, MeshDivision& division) {
  Array<Index>& root = division.vertex_component;
  root.resize(static_cast<std::size_t>(n_vertices));
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::vector<bool> has_element(static_cast<std::size_t>(n_vertices), false);
  for (Index element = 0; element < view.n_elements(); ++element) {
    const std::span<const Index> vertices = view.vertices(element);
    for (const Index v : vertices) {
      has_element[v] = true;
      const Index a = find(v), b = find(vertices.front());
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  // The root of a component is its lowest vertex, so it has its number when others ask for it.
  for (Index v = 0; v < n_vertices; ++v) {
    if (!has_element[v])
      root[v] = -1;
    else
      root[v] = root[v] == v ? division.n_components++ : root[root[v]];
  }
}

template <class View>
MeshDivision divide_elements(const View& view, Index n_parts, std::span<const Index> given) {
  const Index n_elements = view.n_elements(), n_vertices = view.mesh.n_vertices();
  if (n_parts < 1)
    throw InvalidOption("a mesh cannot be divided into " + std::to_string(n_parts) +
                        " parts; at least 1");
  if (given.size() != static_cast<std::size_t>(n_elements))
    throw InvalidOption(std::to_string(given.size()) + " part numbers for " +
                        std::to_string(n_elements) + " elements");
  MeshDivision division;
  division.n_parts = n_parts;
  division.element_part.assign(given.begin(), given.end());
  division.elements.offsets.assign(static_cast<std::size_t>(n_parts) + 1, 0);
  for (Index element = 0; element < n_elements; ++element) {
    const Index part = given[element];
    if (part < 0 || part >= n_parts)
      throw InvalidOption("element " + std::to_string(element) + " is given to part " +
                              std::to_string(part) + "; there are parts 0 to " +
                              std::to_string(n_parts - 1),
                          {element});
    ++division.elements.offsets[part + 1];
  }
  Array<Index>& offsets = division.elements.offsets;
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  division.elements.indices.resize(static_cast<std::size_t>(n_elements));
  Array<Index> next = offsets;
  for (Index element = 0; element < n_elements; ++element)
    division.elements.indices[next[given[element]]++] = element;

  std::vector<Index> parts;
  division.interface_part.resize(static_cast<std::size_t>(view.n_interfaces()));
  for (Index i = 0; i < view.n_interfaces(); ++i) {
    division.interface_part[i] =
        choose(division.element_part, parts, [&](auto&& visit) { view.for_elements(i, visit); });
    if (std::any_of(parts.begin(), parts.end(), [&](Index p) { return p != parts.front(); }))
      ++division.n_cut_interfaces;
  }
  division.vertex_part.resize(static_cast<std::size_t>(n_vertices));
  division.first_row.assign(static_cast<std::size_t>(n_parts) + 1, 0);
  for (Index v = 0; v < n_vertices; ++v) {
    const Index part = choose(division.element_part, parts,
                              [&](auto&& visit) { view.for_elements_of_vertex(v, visit); });
    division.vertex_part[v] = std::max(part, 0);
    ++division.first_row[division.vertex_part[v] + 1];
  }
  std::partial_sum(division.first_row.begin(), division.first_row.end(),
                   division.first_row.begin());
  division.vertex_row.resize(static_cast<std::size_t>(n_vertices));
  next = division.first_row;
  for (Index v = 0; v < n_vertices; ++v) division.vertex_row[v] = next[division.vertex_part[v]]++;
  find_components(view, n_vertices, division);
  return division;
}

/// What a part has of the mesh, and its interfaces once more as the mesh numbers them.
struct Collected {
  PartNumbers numbers;
  Array<Index> interfaces;
};

template <class View>
Collected collect(const View& view, const MeshDivision& division, Index part) {
  if (part < 0 || part >= division.n_parts)
    throw InvalidOption("part " + std::to_string(part) + " does not exist; there are parts 0 to " +
                        std::to_string(division.n_parts - 1));
  Collected collected;
  PartNumbers& numbers = collected.numbers;
  Array<Index>& interfaces = collected.interfaces;
  numbers.part = part;
  numbers.n_parts = division.n_parts;
  numbers.first_row = division.first_row[part];
  numbers.end_row = division.first_row[part + 1];
  numbers.n_vertices = view.mesh.n_vertices();
  numbers.n_components = division.n_components;
  std::size_t n_sides = 0;
  for (const Index own : division.elements.row(part))
    view.for_interfaces(own, [&](Index) { ++n_sides; });
  // A manifold has at most one other element a side.
  numbers.elements.reserve(static_cast<std::size_t>(division.elements.size(part)) + n_sides);
  for (const Index own : division.elements.row(part)) {
    numbers.elements.push_back(own);
    view.for_interfaces(own, [&](Index interface) {
      view.for_elements(interface, [&](Index other) {
        if (other != own) numbers.elements.push_back(other);
      });
    });
  }
  sort_unique(numbers.elements);
  // Room first: large arrays that grow are new pages every time.
  std::size_t n_vertices = 0, n_interfaces = 0;
  for (const Index element : numbers.elements) {
    n_vertices += view.vertices(element).size();
    view.for_interfaces(element, [&](Index) { ++n_interfaces; });
  }
  numbers.vertices.reserve(n_vertices);
  interfaces.reserve(n_interfaces);
  for (const Index element : numbers.elements) {
    numbers.own_elements.push_back(division.element_part[element] == part);
    const std::span<const Index> vertices = view.vertices(element);
    numbers.vertices.insert(numbers.vertices.end(), vertices.begin(), vertices.end());
    view.for_interfaces(element, [&](Index i) { interfaces.push_back(i); });
  }
  if (part == 0)
    for (Index v = 0; v < numbers.n_vertices; ++v)
      if (division.vertex_component[v] < 0) numbers.vertices.push_back(v);
  sort_unique(numbers.vertices);
  sort_unique(interfaces);
  numbers.interfaces.assign(interfaces.begin(), interfaces.end());
  numbers.vertex_rows.reserve(numbers.vertices.size());
  numbers.vertex_components.reserve(numbers.vertices.size());
  for (const Index v : numbers.vertices) {
    numbers.vertex_rows.push_back(division.vertex_row[v]);
    numbers.vertex_components.push_back(division.vertex_component[v]);
  }
  for (const Index i : interfaces)
    numbers.own_interfaces.push_back(division.interface_part[i] == part);
  return collected;
}

Points select(const Points& points, const Array<Index>& vertices) {
  Points selected(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    selected.row(static_cast<Eigen::Index>(k)) = points.row(vertices[k]);
  return selected;
}

/// The rows named, with their entries numbered by their places in `numbers`.
Csr select(const Csr& rows, const Array<Index>& named, const Array<Index>& numbers) {
  Csr selected;
  std::size_t n_entries = 0;
  for (const Index row : named) n_entries += rows.row(row).size();
  selected.offsets.reserve(named.size() + 1);
  selected.indices.reserve(n_entries);
  for (const Index row : named) {
    for (const Index entry : rows.row(row)) selected.indices.push_back(place(numbers, entry));
    selected.offsets.push_back(static_cast<Index>(selected.indices.size()));
  }
  return selected;
}

/// The rows of which a flag is set.
Csr select(const Csr& rows, const std::vector<bool>& flags) {
  Csr selected;
  selected.offsets.reserve(rows.offsets.size());
  selected.indices.reserve(rows.indices.size());
  for (Index row = 0; row < rows.n_rows(); ++row) {
    if (!flags[row]) continue;
    const std::span<const Index> entries = rows.row(row);
    selected.indices.insert(selected.indices.end(), entries.begin(), entries.end());
    selected.offsets.push_back(static_cast<Index>(selected.indices.size()));
  }
  return selected;
}

}  // namespace

double MeshDivision::imbalance() const {
  Index largest = 0;
  for (Index part = 0; part < n_parts; ++part) largest = std::max(largest, elements.size(part));
  return element_part.empty()
             ? 1.0
             : largest * static_cast<double>(n_parts) / static_cast<double>(element_part.size());
}

Index choose_part(std::span<const Index> parts, std::uint64_t sum_of_elements) {
  return parts.empty() ? -1 : parts[sum_of_elements % parts.size()];
}

MeshDivision divide(const PolygonMesh& mesh, Index n_parts, std::span<const Index> element_part) {
  return divide_elements(Surface{mesh}, n_parts, element_part);
}

MeshDivision divide(const PolyhedralMesh& mesh, Index n_parts,
                    std::span<const Index> element_part) {
  return divide_elements(Volume{mesh}, n_parts, element_part);
}

MeshPart<PolygonMesh> part_of(const PolygonMesh& mesh, const MeshDivision& division, Index part) {
  PartNumbers numbers = collect(Surface{mesh}, division, part).numbers;
  PolygonMesh own(select(mesh.points(), numbers.vertices),
                  select(mesh.faces(), numbers.elements, numbers.vertices));
  // Edges are sorted by their vertices, whose order is kept.
  return {std::move(own), std::move(numbers)};
}

MeshPart<PolyhedralMesh> part_of(const PolyhedralMesh& mesh, const MeshDivision& division,
                                 Index part) {
  auto [numbers, interfaces] = collect(Volume{mesh}, division, part);
  const Array<Index>& elements = numbers.elements;
  const auto here = [&](Index cell) {
    const Index at = cell < 0 ? -1 : place(elements, cell);
    return at >= 0 && at < static_cast<Index>(elements.size()) && elements[at] == cell ? at : -1;
  };
  Array<FaceCells> face_cells;
  face_cells.reserve(interfaces.size());
  for (const Index f : interfaces) {
    const FaceCells cells = mesh.face_cells()[f];
    face_cells.push_back({here(cells.below), here(cells.above)});
  }
  PolyhedralMesh own = PolyhedralMesh::from_face_cells(
      select(mesh.points(), numbers.vertices),
      select(mesh.face_mesh().faces(), interfaces, numbers.vertices),
      select(mesh.cells(), elements, interfaces), std::move(face_cells));
  return {std::move(own), std::move(numbers)};
}

PolygonMesh own_mesh(const MeshPart<PolygonMesh>& part) {
  return PolygonMesh(part.mesh.points(), select(part.mesh.faces(), part.numbers.own_elements));
}

PolyhedralMesh own_mesh(const MeshPart<PolyhedralMesh>& part) {
  const PolyhedralMesh& mesh = part.mesh;
  const PartNumbers& numbers = part.numbers;
  Array<Index> number(numbers.own_elements.size());
  Index n_own = 0;
  for (Index c = 0; c < mesh.n_cells(); ++c) number[c] = numbers.own_elements[c] ? n_own++ : -1;
  const auto own = [&](Index cell) { return cell < 0 ? -1 : number[cell]; };
  std::vector<bool> kept(static_cast<std::size_t>(mesh.n_faces()));
  Array<Index> kept_faces;
  Array<FaceCells> face_cells;
  kept_faces.reserve(kept.size());
  face_cells.reserve(kept.size());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const FaceCells cells{own(mesh.face_cells()[f].below), own(mesh.face_cells()[f].above)};
    kept[f] = cells.below >= 0 || cells.above >= 0;
    if (!kept[f]) continue;
    kept_faces.push_back(f);
    face_cells.push_back(cells);
  }
  Csr cells = select(mesh.cells(), numbers.own_elements);
  for (Index& f : cells.indices) f = place(kept_faces, f);
  return PolyhedralMesh::from_face_cells(mesh.points(), select(mesh.face_mesh().faces(), kept),
                                         std::move(cells), std::move(face_cells));
}

}  // namespace carat
