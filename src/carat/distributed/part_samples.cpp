#include "carat/distributed/part_samples.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/distributed/message.h"
#include "carat/distributed/number_exchange.h"
#include "carat/distributed/processes.h"
#include "carat/operators/common.h"

namespace carat {
namespace {

/// The samples at an interface of the part.
Index n_samples_at(const PolygonMesh& mesh, Index edge) {
  const Index n_faces = mesh.edges().corners.size(edge);
  return n_faces > 2 ? n_faces : 1;
}
Index n_samples_at(const PolyhedralMesh& mesh, Index face) {
  return mesh.face_mesh().faces().size(face);
}

/// The sides of an element, of cells those of all their faces.
Index n_sides(const PolygonMesh& mesh, Index face) { return mesh.faces().size(face); }
Index n_sides(const PolyhedralMesh& mesh, Index cell) {
  Index n = 0;
  for (const Index f : mesh.cell(cell)) n += mesh.face_mesh().faces().size(f);
  return n;
}

/// What consecutive samples of the part belong to.
struct Group {
  std::int64_t number;  // in the whole mesh
  bool own;
  Index n_samples;
};

template <class Mesh>
std::vector<Group> groups_of(const MeshPart<Mesh>& part, const Discretization& d) {
  const PartNumbers& numbers = part.numbers;
  std::vector<Group> groups;
  if (d.n_samples() == 0) return groups;
  if (!d.options.own_interfaces.empty()) {
    for (std::size_t i = 0; i < numbers.interfaces.size(); ++i)
      groups.push_back({numbers.interfaces[i], numbers.own_interfaces[i],
                        n_samples_at(part.mesh, static_cast<Index>(i))});
  } else {
    Index n_own = 0;
    for (const bool own : numbers.own_elements) n_own += own;
    const bool one_each = d.n_samples() == n_own;
    for (std::size_t e = 0; e < numbers.elements.size(); ++e)
      if (numbers.own_elements[e])
        groups.push_back(
            {numbers.elements[e], true, one_each ? 1 : n_sides(part.mesh, static_cast<Index>(e))});
  }
  std::int64_t total = 0;
  for (const Group& group : groups) total += group.n_samples;
  if (total != d.n_samples())
    throw InvalidOption("the samples of the operator " + d.name + " cannot be numbered in parts");
  return groups;
}

template <class Mesh>
PartSamples number_groups(const MeshPart<Mesh>& part, const Discretization& d) {
  std::vector<Group> groups;
  std::vector<std::int64_t> ids, n_samples, n_rows;
  together([&] {
    groups = groups_of(part, d);
    Index sample = 0;
    for (const Group& group : groups) {
      const Index end = sample + group.n_samples;
      if (group.own) {
        ids.push_back(group.number);
        n_samples.push_back(group.n_samples);
        n_rows.push_back(d.gradient_dimension > 0 ? d.first_row(end) - d.first_row(sample) : 0);
      }
      sample = end;
    }
  });
  const NumberExchange exchange(std::move(ids));
  PartSamples result;
  const std::vector<std::int64_t> samples_before =
      exchange.sums_before(n_samples, result.n_samples);
  const std::vector<std::int64_t> rows_before = exchange.sums_before(n_rows, result.n_rows);
  Index sample = 0;
  std::size_t own = 0;
  for (const Group& group : groups) {
    const Index first = sample;
    for (; sample < first + group.n_samples; ++sample) {
      result.numbers.push_back(group.own ? samples_before[own] + sample - first : -1);
      result.first_rows.push_back(group.own && d.gradient_dimension > 0
                                      ? rows_before[own] + d.first_row(sample) - d.first_row(first)
                                      : -1);
    }
    if (group.own) ++own;
  }
  return result;
}

/// Collective. A finding of all processes, ascending and with the words of one that knows it; in
/// the first process alone. Some operators look for other things on simplices.
WholeFinding gather(WholeFinding finding) {
  if (own_rank() > 0) {
    Message message;
    message.put_list(finding.meaning);
    message.put_list(finding.elements);
    message.send(0);
    return {};
  }
  for (int process = 1; process < n_processes(); ++process) {
    Message message = Message::receive(process);
    std::string meaning;
    std::vector<std::int64_t> more;
    message.take_list(meaning);
    message.take_list(more);
    if (finding.meaning.empty()) finding.meaning = meaning;
    finding.elements.insert(finding.elements.end(), more.begin(), more.end());
  }
  std::sort(finding.elements.begin(), finding.elements.end());
  return finding;
}

/// Those that Index can number.
std::vector<Index> numbered(const std::vector<std::int64_t>& elements) {
  std::vector<Index> result;
  for (const std::int64_t element : elements)
    if (element <= std::numeric_limits<Index>::max()) result.push_back(static_cast<Index>(element));
  return result;
}

// What a part knows of the whole mesh, in the order of one process.
constexpr const char* kExcluded = "excluded_samples";
constexpr const char* kFindings[] = {"unreferenced_vertices",    "moved_virtual_vertices",
                                     "flipped_virtual_vertices", "degenerate_faces",
                                     "moved_cell_points",        "flipped_cell_points",
                                     "degenerate_cells",         kExcluded};

/// The elements, as the part's discretization numbers them, in the whole mesh; -1: not own.
std::vector<std::int64_t> own_elements(const PartNumbers& numbers, const Discretization& d) {
  std::vector<std::int64_t> elements;
  for (std::size_t e = 0; e < numbers.elements.size(); ++e) {
    if (numbers.own_elements[e])
      elements.push_back(numbers.elements[e]);
    else if (!d.options.own_interfaces.empty())
      elements.push_back(-1);
  }
  return elements;
}

/// The faces in the same way.
std::vector<std::int64_t> own_faces(const MeshPart<PolygonMesh>& part, const Discretization& d) {
  return own_elements(part.numbers, d);
}
std::vector<std::int64_t> own_faces(const MeshPart<PolyhedralMesh>& part, const Discretization& d) {
  const PartNumbers& numbers = part.numbers;
  const auto is_own = [&](Index cell) {
    return cell >= 0 && numbers.own_elements[static_cast<std::size_t>(cell)];
  };
  std::vector<std::int64_t> faces;
  for (std::size_t f = 0; f < numbers.interfaces.size(); ++f) {
    const FaceCells cells = part.mesh.face_cells()[f];
    // As own_mesh() keeps them.
    if (d.options.own_interfaces.empty() && !is_own(cells.below) && !is_own(cells.above)) continue;
    faces.push_back(numbers.own_interfaces[f] ? numbers.interfaces[f] : -1);
  }
  return faces;
}

/// A finding of the part with the numbers of the whole mesh.
template <class Mesh>
std::vector<std::int64_t> whole_numbers(const MeshPart<Mesh>& part, const Discretization& d,
                                        const Finding& finding, const PartSamples& samples) {
  const PartNumbers& numbers = part.numbers;
  std::vector<std::int64_t> result;
  if (finding.name == "unreferenced_vertices") {
    // A vertex of the halo may have elements of other parts alone.
    for (Index v = 0; v < part.mesh.n_vertices(); ++v)
      if (numbers.own_vertex(v) && numbers.vertex_components[v] < 0)
        result.push_back(numbers.vertices[v]);
  } else if (finding.name == kExcluded && d.n_samples() > 0) {
    for (const Index sample : finding.elements)
      if (const std::int64_t number = samples.numbers[static_cast<std::size_t>(sample)];
          number >= 0)
        result.push_back(number);
  } else {
    constexpr bool kVolume = std::is_same_v<Mesh, PolyhedralMesh>;
    const bool of_faces = finding.name.ends_with("_virtual_vertices") ||
                          finding.name == "degenerate_faces" || !kVolume;
    const std::vector<std::int64_t> places =
        of_faces ? own_faces(part, d) : own_elements(numbers, d);
    for (const Index element : finding.elements)
      if (const std::int64_t place = places[static_cast<std::size_t>(element)]; place >= 0)
        result.push_back(place);
  }
  return result;
}

template <class Mesh>
std::vector<WholeFinding> diagnose(const MeshPart<Mesh>& part, const Discretization& d,
                                   bool strict) {
  PartSamples samples;
  if (sum_of_all(std::int64_t{d.diagnostics.count(kExcluded)}) > 0)
    samples = number_groups(part, d);
  std::vector<WholeFinding> result;
  for (const char* const name : kFindings) {
    WholeFinding own{name, "", {}};
    if (const Finding* const found = d.diagnostics.find(name))
      own = {name, found->meaning, whole_numbers(part, d, *found, samples)};
    WholeFinding all = gather(std::move(own));
    on_first([&] {
      if (!strict || std::string(name) != kExcluded || all.elements.empty()) return;
      const std::string kind = all.meaning.substr(0, all.meaning.find("s whose"));
      throw DegenerateElement(kind + " " + std::to_string(all.elements[0]) +
                                  " is degenerate: its measure is below " +
                                  number(d.options.eps_rel) +
                                  " of its diameter to the power of its dimension, as for " +
                                  std::to_string(all.elements.size() - 1) +
                                  " more; repair the mesh, or leave out --strict",
                              numbered(all.elements));
    });
    if (!all.meaning.empty()) result.push_back(std::move(all));
  }
  return result;
}

}  // namespace

PartSamples number_samples(const MeshPart<PolygonMesh>& part, const Discretization& d) {
  return number_groups(part, d);
}

PartSamples number_samples(const MeshPart<PolyhedralMesh>& part, const Discretization& d) {
  return number_groups(part, d);
}

std::vector<WholeFinding> whole_diagnostics(const MeshPart<PolygonMesh>& part,
                                            const Discretization& d, bool strict) {
  return diagnose(part, d, strict);
}

std::vector<WholeFinding> whole_diagnostics(const MeshPart<PolyhedralMesh>& part,
                                            const Discretization& d, bool strict) {
  return diagnose(part, d, strict);
}

}  // namespace carat
