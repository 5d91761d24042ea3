#include "carat/distributed/piece_interfaces.h"

#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "carat/base/error.h"
#include "carat/distributed/exchange.h"
#include "carat/mesh/mesh_part.h"

namespace carat {
namespace {

void sort_unique(std::vector<HaloElement>& halo) {
  std::sort(halo.begin(), halo.end());
  halo.erase(std::unique(halo.begin(), halo.end()), halo.end());
}

/// An edge of a process with the faces that it has there.
struct EdgeUse {
  Index low, high, n_elements;
};

struct EdgeAnswer {
  std::int64_t number;
  Index part, n_others;
};

/// An edge's use at the process that keeps the edge.
struct EdgeEntry {
  Index low, high;
  int process;
  std::size_t place;
  std::span<const Index> elements;
};

/// A face of one cell of a process, followed by its vertices in a list of its own.
struct FaceUse {
  std::int64_t id;
  Index cell, face, size;  ///< number of the cell; the face's place in the piece
  bool below;              ///< the cell is below the face
};

struct FaceAnswer {
  Index other_cell, other_face;
  int other_process;  ///< -1: the face lies on no other piece
  Index size;         ///< of the face's vertices as the other cell names them, if that is lower
};

struct FaceEntry {
  FaceUse use;
  int process;
  std::size_t place;
  std::span<const Index> vertices;
  std::vector<Index> cycle;  ///< from the lowest vertex towards the lower of its neighbours
  bool forward;              ///< so runs the face
};

void make_cycle(FaceEntry& entry) {
  const std::span<const Index> face = entry.vertices;
  const std::size_t n = face.size();
  const auto start =
      static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  entry.forward = face[(start + 1) % n] < face[(start + n - 1) % n];
  entry.cycle.resize(n);
  for (std::size_t k = 0; k < n; ++k)
    entry.cycle[k] = face[(start + k * (entry.forward ? 1 : n - 1)) % n];
}

std::vector<FaceEntry> sorted_entries(const Lists<FaceUse>& uses, const Lists<Index>& vertices) {
  std::vector<FaceEntry> entries;
  for (std::size_t p = 0; p < uses.size(); ++p) {
    std::size_t at = 0;
    for (std::size_t k = 0; k < uses[p].size(); ++k) {
      const auto size = static_cast<std::size_t>(uses[p][k].size);
      entries.push_back({uses[p][k],
                         static_cast<int>(p),
                         k,
                         std::span(vertices[p]).subspan(at, size),
                         {},
                         false});
      make_cycle(entries.back());
      at += size;
    }
  }
  std::sort(entries.begin(), entries.end(), [](const FaceEntry& a, const FaceEntry& b) {
    return std::tie(a.use.id, a.cycle, a.use.cell) < std::tie(b.use.id, b.cycle, b.use.cell);
  });
  return entries;
}

std::string name_of(const FaceEntry& entry) {
  return "cell " + std::to_string(entry.use.cell) + " of process " + std::to_string(entry.process);
}

/// Refuses two cells that cannot be the ones on the two sides of a face.
void check_pair(const FaceEntry& low, const FaceEntry& high) {
  const std::string both = name_of(low) + " and " + name_of(high);
  if (low.cycle != high.cycle)
    throw InvalidMesh("a face with the same global id in " + both +
                      " has different vertices; the pieces are not of one mesh");
  if ((low.forward == high.forward) == (low.use.below == high.use.below))
    throw InvalidMesh(both +
                      " lie on the same side of their face; the cells around them do not fit "
                      "together, or a piece has cells that are folded over");
}

/// The face of another process of which `entries` has this one's, if there is one.
class FaceGroups {
 public:
  FaceGroups(std::vector<FaceEntry> entries, bool have_ids) : entries_(std::move(entries)) {
    for (std::size_t begin = 0, end = 0; begin < entries_.size(); begin = end) {
      while (end < entries_.size() && entries_[end].use.id == entries_[begin].use.id &&
             (have_ids || entries_[end].cycle == entries_[begin].cycle))
        ++end;
      match(std::span(entries_).subspan(begin, end - begin), have_ids);
    }
  }
  /// Calls visit(entry, other), `other` null if there is none.
  template <class Visit>
  void for_entries(const Visit& visit) const {
    std::size_t next = 0;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const bool paired = next < pairs_.size() && (pairs_[next] == k || pairs_[next] + 1 == k);
      if (!paired) {
        visit(entries_[k], nullptr);
        continue;
      }
      visit(entries_[k], &entries_[pairs_[next] == k ? k + 1 : k - 1]);
      if (pairs_[next] + 1 == k) ++next;
    }
  }

 private:
  void match(std::span<const FaceEntry> same, bool have_ids) {
    if (same.size() < 2) return;
    const bool one_process = std::all_of(same.begin(), same.end(), [&](const FaceEntry& entry) {
      return entry.process == same.front().process;
    });
    // The two sides of a baffle.
    if (one_process && !have_ids) return;
    if (one_process || same.size() > 2)
      throw InvalidMesh("a face belongs to " + std::to_string(same.size()) + " cells, among them " +
                        name_of(same[0]) + " and " + name_of(same[1]) +
                        "; two of different pieces are possible, or give the faces global ids");
    check_pair(same[0], same[1]);
    pairs_.push_back(static_cast<std::size_t>(same.data() - entries_.data()));
  }

  std::vector<FaceEntry> entries_;
  std::vector<std::size_t> pairs_;  ///< the first of two neighbours in the list
};

/// What other processes have of a piece's faces.
struct Across {
  Index cell = -1, face = -1;
  int process = -1;
};

struct Named {
  Index cell, n_faces;
};

struct Told {
  std::int64_t number;
  Index face;
};

/// Faces in the order in which the cells name them first, from `first` on.
void number_by_cells(const PolyhedralMesh& mesh, const Numbering& elements,
                     const std::vector<Across>& across, std::int64_t first, InterfaceBook& book) {
  const auto first_names = [&](Index c, Index f) {
    const Index other = mesh.face_cells()[static_cast<std::size_t>(f)].other(c);
    const Index beyond = other >= 0 ? elements.numbers[static_cast<std::size_t>(other)]
                                    : across[static_cast<std::size_t>(f)].cell;
    return beyond < 0 || beyond > elements.numbers[static_cast<std::size_t>(c)];
  };
  std::vector<Named> questions;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    Index n = 0;
    for (const Index f : mesh.cell(c)) n += first_names(c, f) ? 1 : 0;
    questions.push_back({elements.numbers[static_cast<std::size_t>(c)], n});
  }
  const Blocks blocks(0, std::int64_t{elements.n} - 1);
  std::int64_t n_here = 0, total = 0;
  const auto before = ask<std::int64_t>(
      questions, [&](const Named& q) { return blocks.owner(q.cell); },
      [&](std::vector<Asked<Named>>& asked, const auto& reply) {
        std::sort(asked.begin(), asked.end(),
                  [](const auto& a, const auto& b) { return a.question.cell < b.question.cell; });
        for (const Asked<Named>& a : asked) {
          reply(a, n_here);
          n_here += a.question.n_faces;
        }
      });
  first += sum_before(n_here, total);
  const Lists<std::int64_t> starts =
      exchange(Lists<std::int64_t>(static_cast<std::size_t>(n_processes()), {first}));
  Lists<Told> telling(static_cast<std::size_t>(n_processes()));
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    const auto owner =
        static_cast<std::size_t>(blocks.owner(questions[static_cast<std::size_t>(c)].cell));
    std::int64_t next = starts[owner].front() + before[static_cast<std::size_t>(c)];
    for (const Index f : mesh.cell(c)) {
      if (!first_names(c, f)) continue;
      const std::int64_t number = next++;
      book.numbers[static_cast<std::size_t>(f)] = number;
      const Across& other = across[static_cast<std::size_t>(f)];
      if (other.process >= 0)
        telling[static_cast<std::size_t>(other.process)].push_back({number, other.face});
    }
  }
  for (const std::vector<Told>& list : exchange(telling))
    for (const Told& told : list) book.numbers[static_cast<std::size_t>(told.face)] = told.number;
}

}  // namespace

InterfaceBook keep_interfaces(const PolygonMesh& mesh, const Numbering& vertices,
                              const Numbering& elements, std::int64_t first) {
  const auto n = static_cast<std::size_t>(n_processes());
  const EdgeTopology& edges = mesh.edges();
  const Blocks blocks(0, std::int64_t{vertices.n} - 1);
  const auto ends = [&](std::size_t e) {
    const auto [a, b] = edges.vertices[e];
    return std::minmax(vertices.numbers[static_cast<std::size_t>(a)],
                       vertices.numbers[static_cast<std::size_t>(b)]);
  };
  const auto n_edges = static_cast<std::size_t>(edges.size());
  Lists<EdgeUse> uses(n);
  Lists<Index> faces(n);
  for (std::size_t e = 0; e < n_edges; ++e) {
    const auto [low, high] = ends(e);
    const auto to = static_cast<std::size_t>(blocks.owner(low));
    const std::span<const Index> corners = edges.corners.row(static_cast<Index>(e));
    uses[to].push_back({low, high, static_cast<Index>(corners.size())});
    for (const Index corner : corners)
      faces[to].push_back(elements.numbers[static_cast<std::size_t>(mesh.corner_faces()[corner])]);
  }
  const Lists<EdgeUse> uses_here = exchange(uses);
  const Lists<Index> faces_here = exchange(faces);
  uses.clear();
  faces.clear();
  std::vector<EdgeEntry> entries;
  for (std::size_t p = 0; p < n; ++p) {
    std::size_t at = 0;
    for (std::size_t k = 0; k < uses_here[p].size(); ++k) {
      const EdgeUse& use = uses_here[p][k];
      const auto size = static_cast<std::size_t>(use.n_elements);
      entries.push_back(
          {use.low, use.high, static_cast<int>(p), k, std::span(faces_here[p]).subspan(at, size)});
      at += size;
    }
  }
  std::sort(entries.begin(), entries.end(), [](const EdgeEntry& a, const EdgeEntry& b) {
    return std::tie(a.low, a.high, a.process) < std::tie(b.low, b.high, b.process);
  });
  const auto same = [&](std::size_t a, std::size_t b) {
    return entries[a].low == entries[b].low && entries[a].high == entries[b].high;
  };
  std::int64_t n_here = 0, total = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) n_here += k == 0 || !same(k, k - 1) ? 1 : 0;
  std::int64_t next = first + sum_before(n_here, total);
  Lists<EdgeAnswer> answers(n);
  // The other processes of an edge that several share, by its place in the answers.
  Lists<std::pair<std::size_t, int>> others(n);
  for (std::size_t p = 0; p < n; ++p) answers[p].resize(uses_here[p].size());
  std::vector<std::pair<Index, Index>> element_parts;
  std::vector<Index> parts;
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    element_parts.clear();
    parts.clear();
    std::uint64_t sum = 0;
    for (; end < entries.size() && same(begin, end); ++end)
      for (const Index element : entries[end].elements) {
        element_parts.emplace_back(element, entries[end].process);
        sum += static_cast<std::uint64_t>(element);
      }
    std::sort(element_parts.begin(), element_parts.end());
    for (const auto& [element, part] : element_parts) parts.push_back(part);
    const Index part = choose_part(parts, sum);
    for (std::size_t k = begin; k < end; ++k) {
      const auto p = static_cast<std::size_t>(entries[k].process);
      for (std::size_t other = begin; other < end; ++other)
        if (other != k) others[p].emplace_back(entries[k].place, entries[other].process);
      answers[p][entries[k].place] = {next, part, static_cast<Index>(end - begin - 1)};
    }
    ++next;
  }
  Lists<int> flat(n);
  for (std::size_t p = 0; p < n; ++p) {
    std::sort(others[p].begin(), others[p].end());
    for (const auto& [place, process] : others[p]) flat[p].push_back(process);
  }
  const Lists<EdgeAnswer> got = exchange(answers);
  const Lists<int> others_got = exchange(flat);

  InterfaceBook book;
  const int rank = own_rank();
  std::vector<std::size_t> taken(n, 0), taken_others(n, 0);
  for (std::size_t e = 0; e < n_edges; ++e) {
    const auto from = static_cast<std::size_t>(blocks.owner(ends(e).first));
    const EdgeAnswer& answer = got[from][taken[from]++];
    book.numbers.push_back(answer.number);
    book.own.push_back(answer.part == rank);
    for (Index k = 0; k < answer.n_others; ++k) {
      const int other = others_got[from][taken_others[from]++];
      for (const Index corner : edges.corners.row(static_cast<Index>(e)))
        book.halo.push_back({other, mesh.corner_faces()[corner]});
    }
  }
  sort_unique(book.halo);
  return book;
}

InterfaceBook keep_interfaces(const PolyhedralMesh& mesh, const Numbering& vertices,
                              const Numbering& elements, const std::vector<std::int64_t>& ids,
                              bool have_ids, std::int64_t first) {
  const auto n = static_cast<std::size_t>(n_processes());
  const auto n_faces = static_cast<std::size_t>(mesh.n_faces());
  InterfaceBook book;
  book.numbers.assign(n_faces, -1);
  std::int64_t last = 0;
  if (have_ids) {
    std::int64_t total = 0;
    book.numbers = number_many_ids(ids, "faces", false, total);
    for (std::int64_t& number : book.numbers) number += first;
    last = first + std::max<std::int64_t>(total - 1, 0);
  }
  // By the numbers of faces or those of vertices.
  const Blocks blocks(have_ids ? first : 0,
                      have_ids ? last : std::max<std::int64_t>(vertices.n - 1, 0));

  // Faces of one cell here may have another one elsewhere.
  Lists<FaceUse> uses(n);
  Lists<Index> corners(n);
  const auto owner = [&](std::size_t f) {
    if (have_ids) return static_cast<std::size_t>(blocks.owner(book.numbers[f]));
    Index lowest = std::numeric_limits<Index>::max();
    for (const Index v : mesh.face(static_cast<Index>(f)))
      lowest = std::min(lowest, vertices.numbers[static_cast<std::size_t>(v)]);
    return static_cast<std::size_t>(blocks.owner(lowest));
  };
  for (std::size_t f = 0; f < n_faces; ++f) {
    const FaceCells cells = mesh.face_cells()[f];
    if (!cells.boundary()) continue;
    const bool below = cells.below >= 0;
    const std::span<const Index> face = mesh.face(static_cast<Index>(f));
    const std::size_t to = owner(f);
    uses[to].push_back(
        {have_ids ? book.numbers[f] : 0,
         elements.numbers[static_cast<std::size_t>(below ? cells.below : cells.above)],
         static_cast<Index>(f), static_cast<Index>(face.size()), below});
    for (const Index v : face) corners[to].push_back(vertices.numbers[static_cast<std::size_t>(v)]);
  }
  const Lists<FaceUse> uses_here = exchange(uses);
  const Lists<Index> corners_here = exchange(corners);
  uses.clear();
  corners.clear();
  Lists<FaceAnswer> answers(n);
  Lists<std::span<const Index>> named(n);
  for (std::size_t p = 0; p < n; ++p) {
    answers[p].resize(uses_here[p].size());
    named[p].resize(uses_here[p].size());
  }
  together([&] {
    const FaceGroups groups(sorted_entries(uses_here, corners_here), have_ids);
    groups.for_entries([&](const FaceEntry& entry, const FaceEntry* other) {
      const auto p = static_cast<std::size_t>(entry.process);
      FaceAnswer& answer = answers[p][entry.place];
      answer = {-1, -1, -1, 0};
      if (other == nullptr) return;
      const bool other_is_lower = other->use.cell < entry.use.cell;
      answer = {other->use.cell, other->use.face, other->process,
                other_is_lower ? other->use.size : 0};
      if (other_is_lower) named[p][entry.place] = other->vertices;
    });
  });
  Lists<Index> flat(n);
  for (std::size_t p = 0; p < n; ++p)
    for (const std::span<const Index> face : named[p])
      flat[p].insert(flat[p].end(), face.begin(), face.end());
  const Lists<FaceAnswer> got = exchange(answers);
  const Lists<Index> faces_got = exchange(flat);

  std::vector<Across> across(n_faces);
  std::vector<std::size_t> taken(n, 0), taken_corners(n, 0);
  const int rank = own_rank();
  book.own.assign(n_faces, false);
  for (std::size_t f = 0; f < n_faces; ++f) {
    const FaceCells cells = mesh.face_cells()[f];
    FaceCells sides{cells.below < 0 ? -1 : elements.numbers[static_cast<std::size_t>(cells.below)],
                    cells.above < 0 ? -1 : elements.numbers[static_cast<std::size_t>(cells.above)]};
    book.own[f] = cells.below >= 0 || cells.above >= 0;
    std::span<const Index> as_other_names;
    if (cells.boundary()) {
      const std::size_t from = owner(f);
      const FaceAnswer& answer = got[from][taken[from]++];
      if (answer.other_process >= 0) {
        across[f] = {answer.other_cell, answer.other_face, answer.other_process};
        const Index here = std::max(cells.below, cells.above);
        book.halo.push_back({answer.other_process, here});
        const auto [low, high] =
            std::minmax(elements.numbers[static_cast<std::size_t>(here)], answer.other_cell);
        const bool own_is_low = low != answer.other_cell;
        const std::array<Index, 2> parts{own_is_low ? rank : answer.other_process,
                                         own_is_low ? answer.other_process : rank};
        book.own[f] = choose_part(parts, static_cast<std::uint64_t>(low) +
                                             static_cast<std::uint64_t>(high)) == rank;
        if (own_is_low) {
          (cells.below < 0 ? sides.below : sides.above) = answer.other_cell;
        } else {
          const auto size = static_cast<std::size_t>(answer.size);
          as_other_names = std::span(faces_got[from]).subspan(taken_corners[from], size);
          taken_corners[from] += size;
        }
      }
    }
    if (as_other_names.empty()) {
      for (const Index v : mesh.face(static_cast<Index>(f)))
        book.faces.indices.push_back(vertices.numbers[static_cast<std::size_t>(v)]);
    } else {
      // The own cell is where it was if both run the same way, else on the other side.
      const std::size_t begin = book.faces.indices.size();
      std::vector<Index> own;
      for (const Index v : mesh.face(static_cast<Index>(f)))
        own.push_back(vertices.numbers[static_cast<std::size_t>(v)]);
      const auto at = std::find(own.begin(), own.end(), as_other_names[0]);
      const Index next = at + 1 == own.end() ? own.front() : at[1];
      const bool same_way = next == as_other_names[1];
      const Index here = std::max(sides.below, sides.above);
      const bool below = (sides.below >= 0) == same_way;
      sides = below ? FaceCells{here, across[f].cell} : FaceCells{across[f].cell, here};
      book.faces.indices.insert(book.faces.indices.begin() + static_cast<std::ptrdiff_t>(begin),
                                as_other_names.begin(), as_other_names.end());
    }
    book.faces.offsets.push_back(static_cast<Index>(book.faces.indices.size()));
    book.sides.push_back(sides);
  }
  sort_unique(book.halo);
  if (!have_ids) number_by_cells(mesh, elements, across, first, book);
  return book;
}

}  // namespace carat
