#include "carat/distributed/piece_numbers.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "carat/base/error.h"
#include "carat/distributed/exchange.h"
#include "carat/mesh/join_points.h"
#include "carat/mesh/mesh_part.h"

namespace carat {
namespace {

using Place = std::array<double, 3>;

Place place_of(const Points& points, std::size_t v) {
  const auto row = static_cast<Eigen::Index>(v);
  // Zeros of either sign are the same place.
  return {points(row, 0) + 0.0, points(row, 1) + 0.0, points(row, 2) + 0.0};
}

std::uint64_t hash(const Place& place) {
  std::uint64_t value = 0;
  for (const double x : place) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    value = (value ^ bits) * 0x9E3779B97F4A7C15U;
    value ^= value >> 29;
  }
  return value;
}

struct PlacedVertex {
  Place place;
  std::int64_t index;
  bool used;
};

/// Vertex `index` of a process.
struct Held {
  std::int64_t process, index;
};

struct VertexUse {
  Index vertex, n_elements;
  Place place;
};

struct VertexAnswer {
  Index row;
  bool shared, is_loose;
};

/// A use by a process, at the process that keeps the vertex.
struct Entry {
  Index vertex;
  int process;
  std::size_t place;
  Place position;
  std::span<const Index> elements;
};

/// One process's list of uses, and the elements of them one after the other.
std::vector<Entry> sorted_entries(const Lists<VertexUse>& uses, const Lists<Index>& elements) {
  std::vector<Entry> entries;
  for (std::size_t p = 0; p < uses.size(); ++p) {
    std::size_t at = 0;
    for (std::size_t k = 0; k < uses[p].size(); ++k) {
      const VertexUse& use = uses[p][k];
      const auto n = static_cast<std::size_t>(use.n_elements);
      entries.push_back(
          {use.vertex, static_cast<int>(p), k, use.place, std::span(elements[p]).subspan(at, n)});
      at += n;
    }
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.vertex, a.process, a.place) < std::tie(b.vertex, b.process, b.place);
  });
  return entries;
}

/// Calls visit(begin, end) for the entries of every vertex.
template <class Visit>
void for_vertices(std::span<const Entry> entries, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].vertex == entries[begin].vertex) ++end;
    visit(entries.subspan(begin, end - begin));
  }
}

void check_vertex(std::span<const Entry> same) {
  for (std::size_t k = 1; k < same.size(); ++k) {
    const std::string who = "process " + std::to_string(same[k].process);
    if (same[k].process == same[k - 1].process)
      throw InvalidMesh("the piece of " + who +
                        " has two vertices with the same global id (number " +
                        std::to_string(same[k].vertex) + " by their ids); merge them");
    if (same[k].position != same[0].position)
      throw InvalidMesh("vertex " + std::to_string(same[k].vertex) +
                        " (by the ids) lies elsewhere in " + "the piece of " + who +
                        " than in that of process " + std::to_string(same[0].process) +
                        "; the pieces are not of one mesh");
  }
}

/// The part of a vertex, and whether its elements are of several processes.
std::pair<Index, bool> part_of_vertex(std::span<const Entry> same,
                                      std::vector<std::pair<Index, Index>>& element_parts,
                                      std::vector<Index>& parts) {
  element_parts.clear();
  parts.clear();
  std::uint64_t sum = 0;
  for (const Entry& entry : same)
    for (const Index element : entry.elements) {
      element_parts.emplace_back(element, entry.process);
      sum += static_cast<std::uint64_t>(element);
    }
  std::sort(element_parts.begin(), element_parts.end());
  bool shared = false;
  for (const auto& [element, part] : element_parts) {
    parts.push_back(part);
    shared |= part != parts.front();
  }
  return {choose_part(parts, sum), shared};
}

struct Label {
  Index vertex, label;
};

/// Component by component its lowest vertex in the whole mesh.
std::vector<Index> lowest_vertices(const Numbering& vertices, const Blocks& blocks,
                                   const std::vector<bool>& shared,
                                   const std::vector<Index>& component) {
  std::vector<Index> label;
  for (std::size_t v = 0; v < component.size(); ++v) {
    if (component[v] < 0) continue;
    const auto c = static_cast<std::size_t>(component[v]);
    if (c >= label.size()) label.resize(c + 1, std::numeric_limits<Index>::max());
    label[c] = std::min(label[c], vertices.numbers[v]);
  }
  std::vector<std::size_t> meeting;
  for (std::size_t v = 0; v < component.size(); ++v)
    if (component[v] >= 0 && shared[v]) meeting.push_back(v);
  for (std::int64_t changed = 1; changed > 0;) {
    std::vector<Label> questions;
    for (const std::size_t v : meeting)
      questions.push_back({vertices.numbers[v], label[static_cast<std::size_t>(component[v])]});
    const auto lowest = ask<Index>(
        questions, [&](const Label& q) { return blocks.owner(q.vertex); },
        [](std::vector<Asked<Label>>& asked, const auto& reply) {
          std::sort(asked.begin(), asked.end(), [](const auto& a, const auto& b) {
            return std::tie(a.question.vertex, a.question.label) <
                   std::tie(b.question.vertex, b.question.label);
          });
          Index vertex = -1, least = 0;
          for (const Asked<Label>& a : asked) {
            if (a.question.vertex != vertex) least = a.question.label;
            vertex = a.question.vertex;
            reply(a, least);
          }
        });
    changed = 0;
    for (std::size_t k = 0; k < meeting.size(); ++k) {
      Index& own = label[static_cast<std::size_t>(component[meeting[k]])];
      if (lowest[k] < own) changed = 1;
      own = std::min(own, lowest[k]);
    }
    changed = most_of_all(changed);
  }
  return label;
}

}  // namespace

Numbering number_ids(const std::vector<std::int64_t>& ids, const std::string& what, bool distinct) {
  std::int64_t total = 0;
  const std::vector<std::int64_t> numbers = number_many_ids(ids, what, distinct, total);
  check_count(total, what);
  Numbering result;
  result.n = static_cast<Index>(total);
  result.numbers.reserve(numbers.size());
  for (const std::int64_t number : numbers) result.numbers.push_back(static_cast<Index>(number));
  return result;
}

std::vector<std::int64_t> number_many_ids(const std::vector<std::int64_t>& ids,
                                          const std::string& what, bool distinct,
                                          std::int64_t& total) {
  std::int64_t least = std::numeric_limits<std::int64_t>::max(),
               most = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t id : ids) {
    least = std::min(least, id);
    most = std::max(most, id);
  }
  least = least_of_all(least);
  most = most_of_all(most);
  total = 0;
  if (least > most) return {};
  const Blocks blocks(least, most);
  // Those that keep a block number it, then learn where it starts.
  std::int64_t n_here = 0;
  const auto places = ask<std::int64_t>(
      ids, [&](std::int64_t id) { return blocks.owner(id); },
      [&](std::vector<Asked<std::int64_t>>& asked, const auto& reply) {
        std::sort(asked.begin(), asked.end(), [](const auto& a, const auto& b) {
          return std::tie(a.question, a.process) < std::tie(b.question, b.process);
        });
        for (std::size_t k = 0; k < asked.size(); ++k) {
          const bool again = k > 0 && asked[k].question == asked[k - 1].question;
          if (again && distinct)
            throw InvalidMesh("the global id " + std::to_string(asked[k].question) +
                              " is given to several " + what + ", in the pieces of processes " +
                              std::to_string(asked[k - 1].process) + " and " +
                              std::to_string(asked[k].process) +
                              "; every one is in one piece, leave copies out");
          if (!again) ++n_here;
          reply(asked[k], n_here - 1);
        }
      });
  const std::int64_t first = sum_before(n_here, total);
  const Lists<std::int64_t> starts =
      exchange(Lists<std::int64_t>(static_cast<std::size_t>(n_processes()), {first}));
  std::vector<std::int64_t> numbers;
  numbers.reserve(ids.size());
  for (std::size_t k = 0; k < ids.size(); ++k)
    numbers.push_back(starts[static_cast<std::size_t>(blocks.owner(ids[k]))].front() + places[k]);
  return numbers;
}

Numbering number_in_order(std::size_t n, const std::string& what) {
  std::int64_t total = 0;
  const std::int64_t first = sum_before(static_cast<std::int64_t>(n), total);
  check_count(total, what);
  Numbering result{std::vector<Index>(n), static_cast<Index>(total)};
  std::iota(result.numbers.begin(), result.numbers.end(), static_cast<Index>(first));
  return result;
}

Numbering number_places(const Points& points, const std::vector<bool>& used) {
  std::vector<PlacedVertex> questions;
  for (std::size_t v = 0; v < used.size(); ++v)
    questions.push_back({place_of(points, v), static_cast<std::int64_t>(v), used[v]});
  const auto n = static_cast<std::uint64_t>(n_processes());
  const auto held = ask<Held>(
      questions, [&](const PlacedVertex& q) { return static_cast<int>(hash(q.place) % n); },
      [](std::vector<Asked<PlacedVertex>>& asked, const auto& reply) {
        std::sort(asked.begin(), asked.end(), [](const auto& a, const auto& b) {
          return std::tie(a.question.place, a.process, a.question.index) <
                 std::tie(b.question.place, b.process, b.question.index);
        });
        std::vector<PiecePoint> same;
        for (std::size_t begin = 0, end = 0; begin < asked.size(); begin = end) {
          same.clear();
          for (; end < asked.size() && asked[end].question.place == asked[begin].question.place;
               ++end)
            same.push_back(
                {asked[end].process, asked[end].question.index, asked[end].question.used});
          const std::vector<std::int64_t> joined = join_points(same);
          for (std::size_t k = 0; k < same.size(); ++k) {
            const PiecePoint* const stands =
                joined[k] < 0 ? nullptr : &same[static_cast<std::size_t>(joined[k])];
            reply(asked[begin + k], stands ? Held{stands->piece, stands->index} : Held{-1, -1});
          }
        }
      });
  std::vector<std::int64_t> own(used.size(), -1);
  std::int64_t n_own = 0, total = 0;
  const int rank = own_rank();
  for (std::size_t v = 0; v < used.size(); ++v)
    if (held[v].process == rank && held[v].index == static_cast<std::int64_t>(v)) own[v] = n_own++;
  const std::int64_t first = sum_before(n_own, total);
  check_count(total, "vertices");
  std::vector<Held> questions_of_numbers;
  for (const Held& vertex : held)
    if (vertex.process >= 0) questions_of_numbers.push_back(vertex);
  const auto answers = ask<Index>(
      questions_of_numbers, [](const Held& q) { return static_cast<int>(q.process); },
      [&](std::vector<Asked<Held>>& asked, const auto& reply) {
        for (const Asked<Held>& a : asked)
          reply(a, static_cast<Index>(first + own[static_cast<std::size_t>(a.question.index)]));
      });
  Numbering result{std::vector<Index>(used.size(), -1), static_cast<Index>(total)};
  std::size_t next = 0;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (held[v].process >= 0) result.numbers[v] = answers[next++];
  return result;
}

VertexBook keep_vertices(const Numbering& vertices, const Points& points,
                         const Csr& vertex_elements, const std::vector<Index>& component) {
  const auto n_processes_here = static_cast<std::size_t>(n_processes());
  const Blocks blocks(0, std::int64_t{vertices.n} - 1);
  const std::size_t n = vertices.numbers.size();
  Lists<VertexUse> uses(n_processes_here);
  Lists<Index> elements(n_processes_here);
  for (std::size_t v = 0; v < n; ++v) {
    if (vertices.numbers[v] < 0) continue;
    const auto to = static_cast<std::size_t>(blocks.owner(vertices.numbers[v]));
    const std::span<const Index> of_vertex = vertex_elements.row(static_cast<Index>(v));
    uses[to].push_back(
        {vertices.numbers[v], static_cast<Index>(of_vertex.size()), place_of(points, v)});
    elements[to].insert(elements[to].end(), of_vertex.begin(), of_vertex.end());
  }
  const Lists<VertexUse> uses_here = exchange(uses);
  const Lists<Index> elements_here = exchange(elements);
  const std::vector<Entry> entries = sorted_entries(uses_here, elements_here);

  std::vector<Index> part;  // of the vertices here, in their order
  std::vector<std::int64_t> n_of_part(n_processes_here, 0), n_rows;
  Lists<VertexAnswer> answers(n_processes_here);
  for (std::size_t p = 0; p < n_processes_here; ++p) answers[p].resize(uses_here[p].size());
  together([&] {
    std::vector<std::pair<Index, Index>> element_parts;
    std::vector<Index> parts;
    for_vertices(entries, [&](std::span<const Entry> same) {
      check_vertex(same);
      const auto [chosen, shared] = part_of_vertex(same, element_parts, parts);
      for (const Entry& entry : same)
        answers[static_cast<std::size_t>(entry.process)][entry.place] = {
            0, shared, chosen < 0 && &entry == same.data()};
      part.push_back(std::max(chosen, 0));
      ++n_of_part[static_cast<std::size_t>(part.back())];
    });
  });
  std::vector<std::int64_t> next = sums_before(n_of_part, n_rows);
  std::int64_t first = 0;
  for (std::size_t p = 0; p < n_processes_here; ++p) {
    next[p] += first;
    first += n_rows[p];
  }
  std::size_t at = 0;
  for_vertices(entries, [&](std::span<const Entry> same) {
    const auto row = static_cast<Index>(next[static_cast<std::size_t>(part[at++])]++);
    for (const Entry& entry : same)
      answers[static_cast<std::size_t>(entry.process)][entry.place].row = row;
  });
  const Lists<VertexAnswer> got = exchange(answers);

  VertexBook book;
  book.rows.assign(n, -1);
  book.shared.assign(n, false);
  book.is_loose.assign(n, false);
  std::vector<std::size_t> taken(n_processes_here, 0);
  for (std::size_t v = 0; v < n; ++v) {
    if (vertices.numbers[v] < 0) continue;
    const auto p = static_cast<std::size_t>(blocks.owner(vertices.numbers[v]));
    const VertexAnswer& answer = got[p][taken[p]++];
    book.rows[v] = answer.row;
    book.shared[v] = answer.shared;
    book.is_loose[v] = answer.is_loose;
  }
  const auto rank = static_cast<std::size_t>(own_rank());
  book.first_row = static_cast<Index>(std::accumulate(
      n_rows.begin(), n_rows.begin() + static_cast<std::ptrdiff_t>(rank), std::int64_t{0}));
  book.end_row = book.first_row + static_cast<Index>(n_rows[rank]);

  const std::vector<Index> lowest = lowest_vertices(vertices, blocks, book.shared, component);
  const Numbering components = number_ids({lowest.begin(), lowest.end()}, "components", false);
  book.n_components = components.n;
  for (const Index c : component)
    book.components.push_back(c < 0 ? -1 : components.numbers[static_cast<std::size_t>(c)]);
  return book;
}

}  // namespace carat
