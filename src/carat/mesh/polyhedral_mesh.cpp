#include "carat/mesh/polyhedral_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "carat/base/error.h"

namespace carat {
namespace {

constexpr std::size_t kIndexLimit = std::numeric_limits<Index>::max();

std::string cell_name(Index c) { return "cell " + std::to_string(c); }

void check_cells(const Csr& cells, Index n_faces) {
  if (cells.offsets.empty() || cells.offsets.front() != 0 ||
      static_cast<std::size_t>(cells.offsets.back()) != cells.indices.size())
    throw InvalidMesh("cell offsets must start at 0 and end at the number of cell faces (" +
                      std::to_string(cells.indices.size()) + ")");
  for (Index c = 0; c < cells.n_rows(); ++c) {
    if (cells.size(c) < 0) throw InvalidMesh(cell_name(c) + ": cell offsets must not descend", {c});
    if (cells.size(c) < 4)
      throw InvalidMesh(cell_name(c) + " has " + std::to_string(cells.size(c)) +
                            " faces; a closed cell needs at least 4; add the missing faces or "
                            "remove the cell",
                        {c});
    for (const Index f : cells.row(c))
      if (f < 0 || f >= n_faces)
        throw InvalidMesh(cell_name(c) + ": face " + std::to_string(f) +
                              " does not exist; the mesh has faces 0 to " +
                              std::to_string(n_faces - 1),
                          {c});
  }
}

/// The same cycle of vertices in one way of writing it: from the lowest vertex towards the lower
/// one of its two neighbours.
struct Cycle {
  std::span<const Index> face;
  Index start, step;

  explicit Cycle(std::span<const Index> vertices) : face(vertices) {
    const Index n = size();
    start = static_cast<Index>(std::min_element(face.begin(), face.end()) - face.begin());
    const Index after = face[start + 1 == n ? 0 : start + 1];
    const Index before = face[start == 0 ? n - 1 : start - 1];
    step = after < before ? 1 : n - 1;
  }
  Index size() const { return static_cast<Index>(face.size()); }
  Index operator[](Index k) const {
    return face[static_cast<std::size_t>((start + std::int64_t{k} * step) % size())];
  }
  friend bool operator==(const Cycle& a, const Cycle& b) {
    if (a.size() != b.size()) return false;
    for (Index k = 0; k < a.size(); ++k)
      if (a[k] != b[k]) return false;
    return true;
  }
};

/// Face -> the first face with the same cycle of vertices. Faces are in range.
Array<Index> first_of_equal_faces(const Csr& faces, Index n_vertices) {
  struct Key {
    Index second, last, face;
  };
  const Index n = faces.n_rows();
  Array<Index> start(static_cast<std::size_t>(n_vertices) + 1, 0);
  Array<Index> first_vertex(static_cast<std::size_t>(n));
  for (Index f = 0; f < n; ++f) {
    const std::span<const Index> face = faces.row(f);
    first_vertex[f] = *std::min_element(face.begin(), face.end());
    ++start[first_vertex[f] + 1];
  }
  for (Index v = 0; v < n_vertices; ++v) start[v + 1] += start[v];
  Array<Key> keys(static_cast<std::size_t>(n));
  {
    Array<Index> next(start.begin(), start.end() - 1);
    for (Index f = 0; f < n; ++f) {
      const Cycle cycle(faces.row(f));
      keys[next[first_vertex[f]]++] = {cycle[1], cycle[cycle.size() - 1], f};
    }
  }
  Array<Index> first(static_cast<std::size_t>(n));
  for (Index v = 0; v < n_vertices; ++v) {
    Key* const begin = keys.data() + start[v];
    Key* const end = keys.data() + start[v + 1];
    std::sort(begin, end, [](const Key& a, const Key& b) {
      if (a.second != b.second) return a.second < b.second;
      return a.last != b.last ? a.last < b.last : a.face < b.face;
    });
    for (Key* key = begin; key < end; ++key) {
      first[key->face] = key->face;
      for (const Key* other = key; other > begin;) {
        --other;
        if (other->second != key->second || other->last != key->last) break;
        if (first[other->face] == other->face &&
            Cycle(faces.row(other->face)) == Cycle(faces.row(key->face))) {
          first[key->face] = other->face;
          break;
        }
      }
    }
  }
  return first;
}

/// Drops faces that repeat others and renumbers; returns the numbers of those that were repeated.
std::vector<Index> merge_equal_faces(Csr& faces, Csr& cells, Index n_vertices) {
  const Array<Index> first = first_of_equal_faces(faces, n_vertices);
  const Index n = faces.n_rows();
  Index kept = 0;
  Array<Index> number(static_cast<std::size_t>(n));
  for (Index f = 0; f < n; ++f) number[f] = first[f] == f ? kept++ : number[first[f]];
  std::vector<Index> merged;
  if (kept == n) return merged;
  Index corner = 0;
  for (Index f = 0, begin = 0; f < n; ++f) {
    const Index end = faces.offsets[f + 1];
    if (first[f] == f) {
      std::copy(faces.indices.begin() + begin, faces.indices.begin() + end,
                faces.indices.begin() + corner);
      corner += end - begin;
      faces.offsets[number[f] + 1] = corner;
    } else {
      merged.push_back(number[f]);
    }
    begin = end;
  }
  faces.indices.resize(static_cast<std::size_t>(corner));
  faces.offsets.resize(static_cast<std::size_t>(kept) + 1);
  for (Index& f : cells.indices) f = number[f];
  std::sort(merged.begin(), merged.end());
  merged.erase(std::unique(merged.begin(), merged.end()), merged.end());
  return merged;
}

/// One side of a face of a cell, for matching the two faces at every edge of the cell.
struct Side {
  Index lower, upper;
  Index face;    // position in the cell
  bool forward;  // the face runs from lower to upper
};

/// Scratch memory of orient_cell.
struct CellScratch {
  std::vector<Side> sides;
  std::vector<signed char> sign;
  std::vector<Index> stack, first_side, links;
};

/// Which faces of a cell point the same way as its first: +1 or -1 a face, up to a common sign.
void orient_cell(const Csr& faces, std::span<const Index> cell, Index c, CellScratch& scratch) {
  std::vector<Side>& sides = scratch.sides;
  const Index n = static_cast<Index>(cell.size());
  sides.clear();
  for (Index k = 0; k < n; ++k) {
    const std::span<const Index> face = faces.row(cell[k]);
    Index v = face.back();
    for (const Index next : face) {
      sides.push_back({std::min(v, next), std::max(v, next), k, v < next});
      v = next;
    }
  }
  const auto by_edge = [](const Side& a, const Side& b) {
    if (a.lower != b.lower) return a.lower < b.lower;
    return a.upper != b.upper ? a.upper < b.upper : a.face < b.face;
  };
  if (sides.size() > 32) {
    std::sort(sides.begin(), sides.end(), by_edge);
  } else {
    for (std::size_t i = 1; i < sides.size(); ++i)
      for (std::size_t j = i; j > 0 && by_edge(sides[j], sides[j - 1]); --j)
        std::swap(sides[j], sides[j - 1]);
  }
  // Faces linked across edges of exactly two of the cell's faces: 2 * other + (turned).
  scratch.first_side.assign(static_cast<std::size_t>(n) + 1, 0);
  const auto same_edge = [&](std::size_t i, std::size_t j) {
    return sides[i].lower == sides[j].lower && sides[i].upper == sides[j].upper;
  };
  const auto for_edges = [&](auto&& visit) {
    for (std::size_t i = 0, j; i < sides.size(); i = j) {
      for (j = i + 1; j < sides.size() && same_edge(i, j);) ++j;
      visit(i, j);
    }
  };
  for_edges([&](std::size_t i, std::size_t j) {
    if ((j - i) % 2 != 0)
      throw InvalidMesh(cell_name(c) + " is not closed: " + std::to_string(j - i) +
                            " of its faces meet at the edge between vertices " +
                            std::to_string(sides[i].lower) + " and " +
                            std::to_string(sides[i].upper) +
                            ", not 2; add the missing face or remove the cell",
                        {c});
    if (j - i != 2) return;
    ++scratch.first_side[sides[i].face + 1];
    ++scratch.first_side[sides[i + 1].face + 1];
  });
  for (Index k = 0; k < n; ++k) scratch.first_side[k + 1] += scratch.first_side[k];
  scratch.links.resize(static_cast<std::size_t>(scratch.first_side[n]));
  scratch.stack.assign(scratch.first_side.begin(), scratch.first_side.end() - 1);
  for_edges([&](std::size_t i, std::size_t j) {
    if (j - i != 2) return;
    const Side &a = sides[i], &b = sides[i + 1];
    const Index turned = a.forward == b.forward ? 1 : 0;
    scratch.links[scratch.stack[a.face]++] = 2 * b.face + turned;
    scratch.links[scratch.stack[b.face]++] = 2 * a.face + turned;
  });
  scratch.sign.assign(static_cast<std::size_t>(n), 0);
  scratch.sign[0] = 1;
  scratch.stack.assign(1, 0);
  Index reached = 1;
  while (!scratch.stack.empty()) {
    const Index k = scratch.stack.back();
    scratch.stack.pop_back();
    for (Index l = scratch.first_side[k]; l < scratch.first_side[k + 1]; ++l) {
      const Index other = scratch.links[l] / 2;
      if (scratch.sign[other] != 0) continue;
      scratch.sign[other] =
          static_cast<signed char>(scratch.links[l] % 2 == 1 ? -scratch.sign[k] : scratch.sign[k]);
      scratch.stack.push_back(other);
      ++reached;
    }
  }
  if (reached < n)
    throw InvalidMesh(cell_name(c) + " consists of several parts: " + std::to_string(reached) +
                          " of its " + std::to_string(n) +
                          " faces form one of them; make each part a cell of its own",
                      {c});
  for_edges([&](std::size_t i, std::size_t j) {
    int balance = 0;
    for (std::size_t k = i; k < j; ++k)
      balance += sides[k].forward ? scratch.sign[sides[k].face] : -scratch.sign[sides[k].face];
    if (balance != 0)
      throw InvalidMesh(cell_name(c) +
                            " is no solid: its faces cannot be turned to point outwards "
                            "at the edge between vertices " +
                            std::to_string(sides[i].lower) + " and " +
                            std::to_string(sides[i].upper) + "; repair the cell",
                        {c});
  });
}

/// Six times the volume on the inner side of the faces, each taken with its sign.
double six_volumes(const Points& points, const Csr& faces, std::span<const Index> cell,
                   const signed char* sign) {
  const Vec3 anchor = points.row(faces.row(cell[0])[0]).transpose();
  double sum = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const std::span<const Index> face = faces.row(cell[k]);
    const Vec3 a = Vec3(points.row(face[0]).transpose()) - anchor;
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vec3 b = Vec3(points.row(face[i]).transpose()) - anchor;
      const Vec3 d = Vec3(points.row(face[i + 1]).transpose()) - anchor;
      sum += sign[k] * a.dot(b.cross(d));
    }
  }
  return sum;
}

/// The two cells of every face in the order of the cells.
Array<FaceCells> incident_cells(const Csr& cells, Index n_faces) {
  Array<FaceCells> result(static_cast<std::size_t>(n_faces), FaceCells{-1, -1});
  for (Index c = 0; c < cells.n_rows(); ++c)
    for (const Index f : cells.row(c)) {
      FaceCells& face = result[f];
      if (face.below == c || face.above == c)
        throw InvalidMesh(cell_name(c) + " names face " + std::to_string(f) +
                              " twice; a cell has every face once",
                          {c});
      if (face.above >= 0)
        throw InvalidMesh("face " + std::to_string(f) +
                              " belongs to three cells: " + std::to_string(face.below) + ", " +
                              std::to_string(face.above) + " and " + std::to_string(c) +
                              "; at most two are possible, remove the wrong one",
                          {face.below, face.above, c});
      (face.below < 0 ? face.below : face.above) = c;
    }
  return result;
}

/// Puts the cells of every face on their sides. Cells are turned as their neighbours are, and each
/// connected part so that its volume is positive.
/// \param face_cells  the cells of every face in any order; receives them on their sides
void orient(const Points& points, const Csr& faces, const Csr& cells,
            Array<FaceCells>& face_cells) {
  Array<signed char> sign(cells.indices.size());
  /// Of every face in its first and second cell.
  Array<std::array<signed char, 2>> face_signs(face_cells.size());
  const auto slot = [&](Index c, Index f) { return face_cells[f].below == c ? 0U : 1U; };
  Array<double> volume(static_cast<std::size_t>(cells.n_rows()));
  CellScratch scratch;
  for (Index c = 0; c < cells.n_rows(); ++c) {
    orient_cell(faces, cells.row(c), c, scratch);
    std::copy(scratch.sign.begin(), scratch.sign.end(), sign.begin() + cells.begin(c));
    for (Index k = cells.begin(c); k < cells.end(c); ++k)
      face_signs[cells.indices[k]][slot(c, cells.indices[k])] = sign[k];
    volume[c] = six_volumes(points, faces, cells.row(c), scratch.sign.data());
  }
  Array<signed char> turn(static_cast<std::size_t>(cells.n_rows()), 0);
  std::vector<Index> part;
  for (Index seed = 0; seed < cells.n_rows(); ++seed) {
    if (turn[seed] != 0) continue;
    part.assign(1, seed);
    turn[seed] = 1;
    double total = 0;
    for (std::size_t next = 0; next < part.size(); ++next) {
      const Index c = part[next];
      total += turn[c] * volume[c];
      for (Index k = cells.begin(c); k < cells.end(c); ++k) {
        const Index other = face_cells[cells.indices[k]].other(c);
        if (other < 0) continue;
        const Index f = cells.indices[k];
        const int wanted = -turn[c] * sign[k] * face_signs[f][slot(other, f)];
        if (turn[other] == 0) {
          turn[other] = static_cast<signed char>(wanted);
          part.push_back(other);
        } else if (turn[other] != wanted) {
          throw InvalidMesh("cells " + std::to_string(c) + " and " + std::to_string(other) +
                                " lie on the same side of face " + std::to_string(f) +
                                "; the cells around them do not fit together, remove one",
                            {c, other});
        }
      }
    }
    if (total < 0)
      for (const Index c : part) turn[c] = static_cast<signed char>(-turn[c]);
  }
  for (FaceCells& face : face_cells) face = {-1, -1};
  for (Index c = 0; c < cells.n_rows(); ++c)
    for (Index k = cells.begin(c); k < cells.end(c); ++k) {
      FaceCells& face = face_cells[cells.indices[k]];
      (sign[k] * turn[c] > 0 ? face.below : face.above) = c;
    }
}

PolyhedralMesh from_rows(Points points, const PolyhedralMesh::CellArray& rows, CellType type,
                         Index n_corners) {
  if (rows.cols() != n_corners)
    throw InvalidMesh("cells of " + std::to_string(rows.cols()) + " vertices; " +
                      std::to_string(n_corners) + " are needed");
  CellCollector cells;
  std::vector<Index> cell(static_cast<std::size_t>(n_corners));
  for (Eigen::Index c = 0; c < rows.rows(); ++c) {
    for (Index k = 0; k < n_corners; ++k) cell[k] = rows(c, k);
    cells.add(type, cell);
  }
  return std::move(cells).build(std::move(points));
}

/// Faces of the cell types in VTK's numbering of vertices, pointing outwards.
std::span<const std::array<signed char, 4>> face_template(CellType type) {
  static constexpr std::array<std::array<signed char, 4>, 4> tetrahedron{
      {{0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}, {0, 2, 1, -1}}};
  static constexpr std::array<std::array<signed char, 4>, 6> voxel{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  static constexpr std::array<std::array<signed char, 4>, 6> hexahedron{
      {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
  static constexpr std::array<std::array<signed char, 4>, 5> wedge{
      {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
  static constexpr std::array<std::array<signed char, 4>, 5> pyramid{
      {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
  switch (type) {
    case CellType::Tetrahedron:
      return tetrahedron;
    case CellType::Voxel:
      return voxel;
    case CellType::Hexahedron:
      return hexahedron;
    case CellType::Wedge:
      return wedge;
    default:
      return pyramid;
  }
}

std::size_t n_corners_of(CellType type) {
  switch (type) {
    case CellType::Tetrahedron:
      return 4;
    case CellType::Wedge:
      return 6;
    case CellType::Pyramid:
      return 5;
    default:
      return 8;
  }
}

}  // namespace

struct PolyhedralMesh::Parts {
  PolygonMesh face_mesh;
  Csr cells;
  /// Face -> the cell that it was given to point out of, -1: not given.
  Array<Index> given_below;
  MeshRepairs repairs;
};

PolyhedralMesh::PolyhedralMesh() : topology_(std::make_shared<Topology>()) {}

PolyhedralMesh::PolyhedralMesh(Parts parts)
    : face_mesh_(std::move(parts.face_mesh)), topology_(std::make_shared<Topology>()) {
  Topology& topology = *topology_;
  topology.cells = std::move(parts.cells);
  topology.repairs = std::move(parts.repairs);
  check_cells(topology.cells, n_faces());
  topology.face_cells = incident_cells(topology.cells, n_faces());
  orient(points(), face_mesh_.faces(), topology.cells, topology.face_cells);
  for (Index f = 0; f < static_cast<Index>(parts.given_below.size()); ++f)
    if (topology.face_cells[f].below != parts.given_below[f])
      topology.repairs.turned_faces.push_back(f);
}

PolyhedralMesh::PolyhedralMesh(Points points, Csr faces, Csr cells)
    : topology_(std::make_shared<Topology>()) {
  // Repeated corners go first, so that faces that differ by them alone are equal.
  PolygonMesh given(std::move(points), std::move(faces));
  check_cells(cells, given.n_faces());
  Csr kept = given.faces();
  std::vector<Index> merged = merge_equal_faces(kept, cells, given.n_vertices());
  Parts parts;
  parts.face_mesh =
      merged.empty() ? std::move(given) : PolygonMesh(given.points(), std::move(kept));
  parts.cells = std::move(cells);
  parts.repairs.merged_faces = std::move(merged);
  *this = PolyhedralMesh(std::move(parts));
}

PolyhedralMesh PolyhedralMesh::from_face_cells(Points points, Csr faces, Csr cells,
                                               Array<FaceCells> face_cells) {
  PolyhedralMesh mesh;
  mesh.face_mesh_ = PolygonMesh(std::move(points), std::move(faces));
  check_cells(cells, mesh.n_faces());
  const Array<FaceCells> named = incident_cells(cells, mesh.n_faces());
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const bool known = static_cast<std::size_t>(f) < face_cells.size();
    const FaceCells by_cells = named[f], given = known ? face_cells[f] : FaceCells{-1, -1};
    const bool same = given.below == by_cells.below && given.above == by_cells.above;
    const bool swapped = given.below == by_cells.above && given.above == by_cells.below;
    if (!known || !(same || swapped))
      throw InvalidMesh("face " + std::to_string(f) + ": its cells are given as " +
                            std::to_string(given.below) + " and " + std::to_string(given.above) +
                            ", but cells " + std::to_string(by_cells.below) + " and " +
                            std::to_string(by_cells.above) + " name it (-1: none)",
                        {f});
  }
  mesh.topology_->cells = std::move(cells);
  mesh.topology_->face_cells = std::move(face_cells);
  return mesh;
}

PolyhedralMesh PolyhedralMesh::from_owner_neighbour(Points points, Csr faces,
                                                    std::span<const Index> owner,
                                                    std::span<const Index> neighbour) {
  Parts parts;
  parts.face_mesh = PolygonMesh(std::move(points), std::move(faces));
  const Index n = parts.face_mesh.n_faces();
  if (owner.size() != static_cast<std::size_t>(n))
    throw InvalidMesh(std::to_string(owner.size()) + " owners for " + std::to_string(n) +
                      " faces; every face needs one");
  if (neighbour.size() > owner.size())
    throw InvalidMesh(std::to_string(neighbour.size()) + " neighbours for " + std::to_string(n) +
                      " faces; at most one a face is possible");
  // A cell without a face would be open, so there are at most as many cells as uses of faces.
  Index n_cells = 0;
  const auto for_uses = [&](auto&& visit) {
    for (Index f = 0; f < n; ++f) visit(owner[f], f);
    for (Index f = 0; f < static_cast<Index>(neighbour.size()); ++f) visit(neighbour[f], f);
  };
  const std::size_t n_uses = owner.size() + neighbour.size();
  for_uses([&](Index c, Index f) {
    if (c < 0 || static_cast<std::size_t>(c) >= n_uses)
      throw InvalidMesh("face " + std::to_string(f) + ": cell " + std::to_string(c) +
                            " cannot exist; " + std::to_string(n_uses) +
                            " uses of faces make fewer cells",
                        {f});
    n_cells = std::max(n_cells, c + 1);
  });
  Csr& cells = parts.cells;
  cells.offsets.assign(static_cast<std::size_t>(n_cells) + 1, 0);
  for_uses([&](Index c, Index) { ++cells.offsets[c + 1]; });
  for (Index c = 0; c < n_cells; ++c) cells.offsets[c + 1] += cells.offsets[c];
  cells.indices.resize(n_uses);
  Array<Index> next(cells.offsets.begin(), cells.offsets.end() - 1);
  for_uses([&](Index c, Index f) { cells.indices[next[c]++] = f; });
  parts.given_below.assign(owner.begin(), owner.end());
  return PolyhedralMesh(std::move(parts));
}

PolyhedralMesh PolyhedralMesh::from_tets(Points points, const CellArray& tets) {
  return from_rows(std::move(points), tets, CellType::Tetrahedron, 4);
}

PolyhedralMesh PolyhedralMesh::from_hexes(Points points, const CellArray& hexes) {
  return from_rows(std::move(points), hexes, CellType::Hexahedron, 8);
}

PolyhedralMesh PolyhedralMesh::with_points(Points points) const {
  PolyhedralMesh moved = *this;
  moved.face_mesh_ = face_mesh_.with_points(std::move(points));
  return moved;
}

const Csr& PolyhedralMesh::cell_vertices() const {
  std::call_once(topology_->cell_vertices_once, [this] {
    Csr result;
    result.offsets.resize(static_cast<std::size_t>(n_cells()) + 1);
    result.offsets[0] = 0;
    result.indices.reserve(cells().indices.size() / 3 * 4);  // hexahedra: 8 vertices, 6 faces
    Array<Index> last_cell(static_cast<std::size_t>(n_vertices()), -1);
    for (Index c = 0; c < n_cells(); ++c) {
      for (const Index f : cell(c))
        for (const Index v : face(f)) {
          if (last_cell[v] == c) continue;
          last_cell[v] = c;
          result.indices.push_back(v);
        }
      if (result.indices.size() > kIndexLimit)
        throw InvalidMesh("more than " + std::to_string(kIndexLimit) +
                          " vertices of cells; split the mesh");
      result.offsets[c + 1] = static_cast<Index>(result.indices.size());
    }
    topology_->cell_vertices = std::move(result);
  });
  return topology_->cell_vertices;
}

const Array<Index>& PolyhedralMesh::corner_cells() const {
  std::call_once(topology_->corner_cells_once, [this] {
    const Csr& vertices = cell_vertices();
    Array<Index> result(vertices.indices.size());
    for (Index c = 0; c < n_cells(); ++c)
      std::fill(result.begin() + vertices.begin(c), result.begin() + vertices.end(c), c);
    topology_->corner_cells = std::move(result);
  });
  return topology_->corner_cells;
}

const Csr& PolyhedralMesh::vertex_cell_corners() const {
  std::call_once(topology_->vertex_cell_corners_once, [this] {
    const Csr& vertices = cell_vertices();
    Csr result;
    result.offsets.assign(static_cast<std::size_t>(n_vertices()) + 1, 0);
    for (const Index v : vertices.indices) ++result.offsets[v + 1];
    for (Index v = 0; v < n_vertices(); ++v) result.offsets[v + 1] += result.offsets[v];
    Array<Index> next(result.offsets.begin(), result.offsets.end() - 1);
    result.indices.resize(vertices.indices.size());
    for (Index k = 0; k < static_cast<Index>(vertices.indices.size()); ++k)
      result.indices[next[vertices.indices[k]]++] = k;
    topology_->vertex_cell_corners = std::move(result);
  });
  return topology_->vertex_cell_corners;
}

void CellCollector::add(CellType type, std::span<const Index> vertices) {
  if (vertices.size() != n_corners_of(type))
    throw InvalidMesh(cell_name(n_cells()) + " has " + std::to_string(vertices.size()) +
                          " vertices; its type needs " + std::to_string(n_corners_of(type)),
                      {n_cells()});
  for (const auto& pattern : face_template(type)) {
    // Collapsed cells repeat vertices: their sides then have fewer, or vanish.
    std::array<Index, 4> face{};
    std::size_t size = 0;
    for (const signed char k : pattern) {
      if (k < 0) break;
      const Index v = vertices[static_cast<std::size_t>(k)];
      if (size == 0 || (v != face[size - 1] && v != face[0])) face[size++] = v;
    }
    if (size >= 3) add_face({face.data(), size});
  }
  end_cell();
  // Both ways of numbering a wedge are in use.
  oriented_.back() = type != CellType::Wedge;
}

void CellCollector::add_face(std::span<const Index> vertices) {
  if (faces_.indices.size() + vertices.size() > kIndexLimit)
    throw InvalidMesh("more than " + std::to_string(kIndexLimit) +
                      " corners of cells' faces; split the mesh");
  faces_.indices.insert(faces_.indices.end(), vertices.begin(), vertices.end());
  faces_.offsets.push_back(static_cast<Index>(faces_.indices.size()));
}

void CellCollector::end_cell() {
  faces_of_cells_.offsets.push_back(faces_.n_rows());
  oriented_.push_back(false);
}

PolyhedralMesh CellCollector::build(Points points) && {
  const Index n = faces_.n_rows();
  faces_of_cells_.indices.resize(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) faces_of_cells_.indices[k] = k;
  // What the vertices say is checked before anything is merged.
  PolygonMesh given(std::move(points), std::move(faces_));
  Csr kept = given.faces();
  PolyhedralMesh::Parts parts;
  parts.cells = std::move(faces_of_cells_);
  merge_equal_faces(kept, parts.cells, given.n_vertices());
  parts.face_mesh = PolygonMesh(given.points(), std::move(kept));
  const Csr& raw = given.faces();
  PolyhedralMesh mesh(std::move(parts));
  Index use = 0;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    const Index f = mesh.cell(c)[0];
    if (oriented_[static_cast<std::size_t>(c)]) {
      // The face has the direction in which its first cell gave it.
      const std::span<const Index> given_face = raw.row(use), face = mesh.face(f);
      const auto at = std::find(face.begin(), face.end(), given_face[0]);
      const Index next = at + 1 == face.end() ? face.front() : at[1];
      const bool same = next == given_face[1];
      const FaceCells& cells = mesh.face_cells()[f];
      if ((same ? cells.below : cells.above) != c)
        mesh.topology_->repairs.turned_cells.push_back(c);
    }
    use += mesh.cells().size(c);
  }
  return mesh;
}

BoundarySurface boundary_surface(const PolyhedralMesh& mesh) {
  BoundarySurface result;
  const std::vector<bool> on_boundary = boundary_vertices(mesh);
  Array<Index> number(static_cast<std::size_t>(mesh.n_vertices()), -1);
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    if (on_boundary[static_cast<std::size_t>(v)]) {
      number[v] = static_cast<Index>(result.vertex_ids.size());
      result.vertex_ids.push_back(v);
    }
  Points points(static_cast<Eigen::Index>(result.vertex_ids.size()), 3);
  for (std::size_t k = 0; k < result.vertex_ids.size(); ++k)
    points.row(static_cast<Eigen::Index>(k)) = mesh.points().row(result.vertex_ids[k]);
  Csr faces;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const FaceCells& cells = mesh.face_cells()[f];
    if (!cells.boundary()) continue;
    result.face_ids.push_back(f);
    const std::size_t first = faces.indices.size();
    for (const Index v : mesh.face(f)) faces.indices.push_back(number[v]);
    if (cells.below < 0) std::reverse(faces.indices.begin() + first + 1, faces.indices.end());
    faces.offsets.push_back(static_cast<Index>(faces.indices.size()));
  }
  result.mesh = PolygonMesh(std::move(points), std::move(faces));
  return result;
}

std::vector<bool> boundary_vertices(const PolyhedralMesh& mesh) {
  std::vector<bool> flags(static_cast<std::size_t>(mesh.n_vertices()), false);
  for (Index f = 0; f < mesh.n_faces(); ++f)
    if (mesh.face_cells()[f].boundary())
      for (const Index v : mesh.face(f)) flags[static_cast<std::size_t>(v)] = true;
  return flags;
}

}  // namespace carat
