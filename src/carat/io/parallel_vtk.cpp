// PVTU and PVTP: VTU and VTP files that are pieces of one mesh.

#include "carat/io/parallel_vtk.h"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkXMLDataElement.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "carat/base/error.h"
#include "carat/io/load_file.h"
#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"
#include "carat/io/with_path.h"
#include "carat/mesh/join_points.h"

namespace carat {
namespace detail {
namespace {

namespace fs = std::filesystem;

/// A piece as its file holds it, without the cells that belong to others.
struct VtkPiece {
  Points points;
  std::vector<bool> used;  ///< point -> it has a cell
  std::vector<Field> vertex_fields, cell_fields;
  std::vector<std::int64_t> vertex_ids, cell_ids;  ///< empty: none
  std::vector<unsigned char> types;
  std::vector<std::size_t> offsets{0};
  std::vector<std::int64_t> entries;  ///< points of a cell, or the list of faces of a polyhedron

  std::size_t n_cells() const { return types.size(); }
  std::span<const std::int64_t> cell(std::size_t c) const {
    return std::span(entries).subspan(offsets[c], offsets[c + 1] - offsets[c]);
  }
  void add(int type, std::span<const std::int64_t> values) {
    types.push_back(static_cast<unsigned char>(type));
    entries.insert(entries.end(), values.begin(), values.end());
    offsets.push_back(entries.size());
  }
};

/// Calls visit(number) with a reference to the number of every point of a cell. What is no list of
/// faces is left to who reads it.
template <class Visit>
void for_points(unsigned char type, std::span<std::int64_t> entries, const Visit& visit) {
  if (type != VTK_POLYHEDRON) {
    for (std::int64_t& point : entries) visit(point);
    return;
  }
  for (std::size_t i = 1; i < entries.size();) {
    const std::int64_t size = entries[i++];
    if (size < 0 || static_cast<std::uint64_t>(size) > entries.size() - i) return;
    for (std::int64_t k = 0; k < size; ++k) visit(entries[i++]);
  }
}

/// Takes the first field out that has one of these names; of the first that is not empty.
std::vector<std::int64_t> take_ids(std::vector<Field>& fields, const std::string& attribute,
                                   std::span<const char* const> names) {
  const auto take = [&](const std::string& name) -> std::vector<std::int64_t> {
    const auto at = std::find_if(fields.begin(), fields.end(), [&](const Field& field) {
      return field.name == name && field.components == 1;
    });
    if (at == fields.end()) return {};
    std::vector<std::int64_t> ids;
    ids.reserve(at->values.size());
    for (const double value : at->values) {
      if (!(std::abs(value) < 9e15) || value != std::floor(value))
        throw IoError("array '" + name + "' has a value that is no global id; the file is damaged");
      ids.push_back(static_cast<std::int64_t>(value));
    }
    fields.erase(at);
    return ids;
  };
  std::vector<std::int64_t> ids;
  if (!attribute.empty()) ids = take(attribute);
  for (const char* const name : names) {
    if (!ids.empty()) break;
    ids = take(name);
  }
  return ids;
}

std::string global_ids_of(vtkDataSetAttributes* attributes) {
  vtkDataArray* const ids = attributes->GetGlobalIds();
  return ids == nullptr || ids->GetName() == nullptr ? std::string() : ids->GetName();
}

/// Which cells belong to others. The field goes.
std::vector<bool> take_ghosts(std::vector<Field>& fields, std::size_t n) {
  constexpr unsigned kDuplicate = 1;  // vtkDataSetAttributes::DUPLICATECELL
  std::vector<bool> ghosts(n, false);
  for (auto field = fields.begin(); field != fields.end();) {
    const bool levels = field->name == "vtkGhostLevels";  // of VTK before version 6
    if ((!levels && field->name != kGhostField) || field->components != 1) {
      ++field;
      continue;
    }
    for (std::size_t c = 0; c < n; ++c) {
      const double value = field->values[c];
      if (!(value >= 0 && value <= 255))
        throw IoError("array '" + field->name + "' has a value that is no byte");
      const auto bits = static_cast<unsigned>(value);
      if (levels ? bits > 0 : (bits & kDuplicate) != 0) ghosts[c] = true;
    }
    field = fields.erase(field);
  }
  return ghosts;
}

void drop_cells(VtkPiece& piece, const std::vector<bool>& ghosts) {
  if (std::none_of(ghosts.begin(), ghosts.end(), [](bool ghost) { return ghost; })) return;
  std::vector<std::int64_t> kept;
  VtkPiece own;
  for (std::size_t c = 0; c < piece.n_cells(); ++c) {
    if (ghosts[c]) continue;
    kept.push_back(static_cast<std::int64_t>(c));
    own.add(piece.types[c], piece.cell(c));
  }
  for (Field& field : piece.cell_fields) field = select_rows(std::move(field), kept);
  piece.types = std::move(own.types);
  piece.offsets = std::move(own.offsets);
  piece.entries = std::move(own.entries);
}

VtkPiece load_piece(const fs::path& path) {
  const Array<char> bytes = load_file(path);
  const FileContent file{path, {bytes.data(), bytes.size()}};
  const std::string_view type = vtk_file_type(file.bytes);
  VtkSession session;
  VtkPiece piece;
  const VtkCellVisitor visit{
      [&](int cell_type, std::span<const std::int64_t> points, std::int64_t) {
        piece.add(cell_type, points);
      },
      [&](std::span<const std::int64_t> faces, std::int64_t) { piece.add(VTK_POLYHEDRON, faces); }};
  const auto data =
      type == "PolyData" ? load_vtp(file, session, visit) : load_vtu(file, session, visit);
  piece.points = points_of(data);
  piece.vertex_fields = point_fields(data, piece.points.rows());
  piece.cell_fields = cell_fields(data, static_cast<std::int64_t>(piece.n_cells()));
  drop_cells(piece, take_ghosts(piece.cell_fields, piece.n_cells()));
  constexpr std::array of_points{"GlobalNodeIds", "GlobalPointIds", "vertex_id"};
  constexpr std::array of_cells{"GlobalElementIds", "GlobalCellIds", "cell_id", "face_id"};
  piece.vertex_ids = take_ids(piece.vertex_fields, global_ids_of(data->GetPointData()), of_points);
  piece.cell_ids = take_ids(piece.cell_fields, global_ids_of(data->GetCellData()), of_cells);
  const std::int64_t n = piece.points.rows();
  piece.used.assign(static_cast<std::size_t>(n), false);
  for (std::size_t c = 0; c < piece.n_cells(); ++c)
    for_points(piece.types[c],
               std::span(piece.entries).subspan(piece.offsets[c], piece.cell(c).size()),
               [&](std::int64_t& v) {
                 if (v < 0 || v >= n)
                   throw InvalidMesh("cell " + std::to_string(c) + ": vertex " + std::to_string(v) +
                                     " does not exist; the mesh has vertices 0 to " +
                                     std::to_string(n - 1));
                 piece.used[static_cast<std::size_t>(v)] = true;
               });
  return piece;
}

/// What the file of an index and its pieces is called.
struct IndexType {
  std::string_view type;   ///< of the index
  std::string_view piece;  ///< of its pieces
};

constexpr std::array<IndexType, 2> kTypes{
    {{"PUnstructuredGrid", "UnstructuredGrid"}, {"PPolyData", "PolyData"}}};

bool recognises_index(std::string_view content) {
  const std::string_view type = vtk_file_type(content);
  return type == kTypes[0].type || type == kTypes[1].type;
}

std::vector<fs::path> pieces_of(const FileContent& file) {
  const bool grid = vtk_file_type(file.bytes) != kTypes[1].type;
  const char* const type = kTypes[grid ? 0 : 1].type.data();
  VtkSession session;
  const auto root = parse_vtk_xml(file, type, session);
  std::vector<fs::path> pieces;
  const fs::path folder = file.path.parent_path();
  for (int i = 0; i < root->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* const element = root->GetNestedElement(i);
    if (std::strcmp(element->GetName(), type) != 0) continue;
    for (int k = 0; k < element->GetNumberOfNestedElements(); ++k) {
      vtkXMLDataElement* const piece = element->GetNestedElement(k);
      if (std::strcmp(piece->GetName(), "Piece") != 0) continue;
      const char* const source = piece->GetAttribute("Source");
      if (source == nullptr || *source == '\0')
        throw IoError("piece " + std::to_string(pieces.size()) +
                      " names no file (attribute Source); the index is damaged");
      pieces.push_back(folder / source);
    }
  }
  if (pieces.empty()) throw IoError("names no piece; the index is damaged");
  return pieces;
}

/// Refuses pieces with other fields than the first that has rows.
void check_same_fields(const std::vector<VtkPiece>& pieces, const std::vector<fs::path>& paths,
                       std::vector<Field> VtkPiece::*fields, const char* where,
                       const std::vector<std::size_t>& n_rows) {
  std::size_t first = pieces.size();
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (n_rows[p] == 0) continue;
    if (first == pieces.size()) first = p;
    const std::vector<Field>&expected = pieces[first].*fields, &found = pieces[p].*fields;
    const auto shape = [](const Field& field) {
      return "'" + field.name + "' of " + std::to_string(field.components) + " components";
    };
    for (std::size_t k = 0; k < std::max(expected.size(), found.size()); ++k) {
      const std::string a = k < expected.size() ? shape(expected[k]) : "no more",
                        b = k < found.size() ? shape(found[k]) : "no more";
      if (a != b)
        throw IoError(paths[p].string() + ": its " + where + " array number " + std::to_string(k) +
                      " is " + b + ", in " + paths[first].string() + " it is " + a +
                      "; the pieces are not of one mesh");
    }
  }
}

/// Whether the pieces have ids: all that have rows, or none.
bool have_ids(const std::vector<VtkPiece>& pieces, const std::vector<fs::path>& paths,
              std::vector<std::int64_t> VtkPiece::*ids, const char* where,
              const std::vector<std::size_t>& n_rows) {
  std::size_t with = pieces.size(), without = pieces.size();
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (n_rows[p] > 0) ((pieces[p].*ids).empty() ? without : with) = p;
  if (with < pieces.size() && without < pieces.size())
    throw IoError(paths[without].string() + ": it has no global ids of " + where + ", but " +
                  paths[with].string() + " has; the pieces are not of one mesh");
  return without == pieces.size();
}

/// One row of a piece.
struct Row {
  std::size_t piece;
  std::int64_t index;
};

/// A field of all pieces, these rows of it.
std::vector<Field> gather(const std::vector<VtkPiece>& pieces, std::vector<Field> VtkPiece::*fields,
                          const std::vector<Row>& rows) {
  std::vector<Field> gathered;
  if (rows.empty()) return gathered;
  const std::vector<Field>& shapes = pieces[rows.front().piece].*fields;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    Field field{shapes[k].name, shapes[k].components, {}};
    field.values.reserve(rows.size() * static_cast<std::size_t>(field.components));
    for (const Row& row : rows) {
      const auto first =
          (pieces[row.piece].*fields)[k].values.begin() + row.index * field.components;
      field.values.insert(field.values.end(), first, first + field.components);
    }
    gathered.push_back(std::move(field));
  }
  return gathered;
}

/// Joins pieces to one mesh.
class Merger {
 public:
  explicit Merger(std::vector<fs::path> paths) : paths_(std::move(paths)) {
    for (const fs::path& path : paths_) {
      pieces_.push_back(with_path(path, [&] { return load_piece(path); }));
      n_points_.push_back(static_cast<std::size_t>(pieces_.back().points.rows()));
      n_cells_.push_back(pieces_.back().n_cells());
    }
    check_same_fields(pieces_, paths_, &VtkPiece::vertex_fields, "point", n_points_);
    check_same_fields(pieces_, paths_, &VtkPiece::cell_fields, "cell", n_cells_);
  }

  MeshData merge() {
    number_points();
    order_cells();
    Points points(static_cast<Eigen::Index>(vertices_.size()), 3);
    for (std::size_t v = 0; v < vertices_.size(); ++v)
      points.row(static_cast<Eigen::Index>(v)) =
          pieces_[vertices_[v].piece].points.row(vertices_[v].index);
    VtkCells cells;
    std::vector<std::int64_t> entries;
    const auto n_points = static_cast<std::int64_t>(vertices_.size());
    for (const Row& row : cells_) {
      const VtkPiece& piece = pieces_[row.piece];
      const auto c = static_cast<std::size_t>(row.index);
      entries.assign(piece.cell(c).begin(), piece.cell(c).end());
      for_points(piece.types[c], entries,
                 [&](std::int64_t& v) { v = numbers_[row.piece][static_cast<std::size_t>(v)]; });
      with_path(paths_[row.piece], [&] {
        if (piece.types[c] == VTK_POLYHEDRON) {
          cells.add_polyhedron(entries, n_points);
        } else {
          cells.add_cell(piece.types[c], entries, n_points);
        }
      });
    }
    std::vector<Field> vertex_fields = gather(pieces_, &VtkPiece::vertex_fields, vertices_);
    std::vector<Field> cell_fields = gather(pieces_, &VtkPiece::cell_fields, cells_);
    pieces_.clear();
    return cells.build(std::move(points), std::move(vertex_fields), std::move(cell_fields));
  }

 private:
  void number_points() {
    for (const std::size_t n : n_points_) numbers_.emplace_back(n, -1);
    if (have_ids(pieces_, paths_, &VtkPiece::vertex_ids, "points", n_points_)) {
      number_by_ids();
    } else {
      number_by_places();
    }
    if (vertices_.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      throw InvalidMesh("the pieces have " + std::to_string(vertices_.size()) +
                        " vertices, more than 2^31 - 1; read them by several processes");
  }

  std::vector<Row> all_points() const {
    std::vector<Row> rows;
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      for (std::size_t v = 0; v < n_points_[p]; ++v)
        rows.push_back({p, static_cast<std::int64_t>(v)});
    return rows;
  }
  bool used(const Row& row) const {
    return pieces_[row.piece].used[static_cast<std::size_t>(row.index)];
  }
  std::int64_t& number(const Row& row) {
    return numbers_[row.piece][static_cast<std::size_t>(row.index)];
  }
  std::array<double, 3> place(const Row& row) const {
    const Points& points = pieces_[row.piece].points;
    return {points(row.index, 0), points(row.index, 1), points(row.index, 2)};
  }

  void number_by_ids() {
    const auto id = [&](const Row& row) {
      return pieces_[row.piece].vertex_ids[static_cast<std::size_t>(row.index)];
    };
    std::vector<Row> rows = all_points();
    // The values of those that are used count.
    std::stable_sort(rows.begin(), rows.end(), [&](const Row& a, const Row& b) {
      return id(a) != id(b) ? id(a) < id(b) : used(a) && !used(b);
    });
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (k == 0 || id(rows[k]) != id(rows[k - 1])) vertices_.push_back(rows[k]);
      number(rows[k]) = static_cast<std::int64_t>(vertices_.size()) - 1;
      if (place(rows[k]) != place(vertices_.back()))
        throw InvalidMesh("vertex " + std::to_string(rows[k].index) + " of " +
                          paths_[rows[k].piece].string() + " has the global id " +
                          std::to_string(id(rows[k])) + " of vertex " +
                          std::to_string(vertices_.back().index) + " of " +
                          paths_[vertices_.back().piece].string() +
                          ", but lies elsewhere; the pieces are not of one mesh");
    }
  }

  void number_by_places() {
    const std::vector<Row> rows = all_points();
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return place(rows[a]) < place(rows[b]); });
    std::vector<std::int64_t> stands_for(rows.size(), -1);
    std::vector<PiecePoint> same;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      same.clear();
      for (; end < order.size() && place(rows[order[end]]) == place(rows[order[begin]]); ++end) {
        const Row& row = rows[order[end]];
        same.push_back({static_cast<std::int64_t>(row.piece), row.index, used(row)});
      }
      const std::vector<std::int64_t> joined = join_points(same);
      for (std::size_t k = begin; k < end; ++k)
        if (joined[k - begin] >= 0)
          stands_for[order[k]] =
              static_cast<std::int64_t>(order[begin + static_cast<std::size_t>(joined[k - begin])]);
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (stands_for[k] != static_cast<std::int64_t>(k)) continue;
      number(rows[k]) = static_cast<std::int64_t>(vertices_.size());
      vertices_.push_back(rows[k]);
    }
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (stands_for[k] >= 0)
        number(rows[k]) = number(rows[static_cast<std::size_t>(stands_for[k])]);
  }

  void order_cells() {
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      for (std::size_t c = 0; c < n_cells_[p]; ++c)
        cells_.push_back({p, static_cast<std::int64_t>(c)});
    if (!have_ids(pieces_, paths_, &VtkPiece::cell_ids, "cells", n_cells_)) return;
    const auto id = [&](const Row& row) {
      return pieces_[row.piece].cell_ids[static_cast<std::size_t>(row.index)];
    };
    std::stable_sort(cells_.begin(), cells_.end(),
                     [&](const Row& a, const Row& b) { return id(a) < id(b); });
    for (std::size_t k = 1; k < cells_.size(); ++k)
      if (id(cells_[k]) == id(cells_[k - 1]))
        throw InvalidMesh("cell " + std::to_string(cells_[k].index) + " of " +
                          paths_[cells_[k].piece].string() + " has the global id " +
                          std::to_string(id(cells_[k])) + " of one of " +
                          paths_[cells_[k - 1].piece].string() + "; mark the copy as a ghost (" +
                          kGhostField + " 1)");
  }

  std::vector<fs::path> paths_;
  std::vector<VtkPiece> pieces_;
  std::vector<std::size_t> n_points_, n_cells_;
  std::vector<std::vector<std::int64_t>> numbers_;  ///< piece -> point -> vertex; -1: none
  std::vector<Row> vertices_, cells_;
};

MeshData read_parallel(const FileContent& file) { return Merger(pieces_of(file)).merge(); }

/// A mesh with the ids of its elements in its last field of these.
template <class Mesh>
AnyMeshPiece to_piece(Mesh mesh, MeshFields fields, std::vector<Field> MeshFields::*of_elements,
                      bool has_ids, std::vector<std::int64_t> vertex_ids) {
  MeshPiece<Mesh> piece{std::move(mesh), std::move(vertex_ids), {}, {}, std::move(fields), {}};
  std::vector<Field>& list = piece.fields.*of_elements;
  if (has_ids) {
    piece.element_ids.assign(list.back().values.begin(), list.back().values.end());
    list.pop_back();
  }
  return piece;
}

}  // namespace

FormatEntry parallel_vtk_format() {
  return {
      .format =
          {"pvtu", "VTK XML pieces of a mesh", {".pvtu", ".pvtp"}, true, false, true, true, false},
      .recognises = recognises_index,
      .read = read_parallel};
}

}  // namespace detail

std::vector<std::filesystem::path> parallel_pieces(const std::filesystem::path& path) {
  return detail::with_path(path, [&] {
    const Array<char> bytes = detail::load_file(path);
    return detail::pieces_of({path, {bytes.data(), bytes.size()}});
  });
}

AnyMeshPiece read_piece(const std::filesystem::path& path) {
  return detail::with_path(path, [&]() -> AnyMeshPiece {
    detail::VtkPiece piece = detail::load_piece(path);
    detail::VtkCells cells;
    for (std::size_t c = 0; c < piece.n_cells(); ++c)
      if (piece.types[c] == VTK_POLYHEDRON) {
        cells.add_polyhedron(piece.cell(c), piece.points.rows());
      } else {
        cells.add_cell(piece.types[c], piece.cell(c), piece.points.rows());
      }
    // Rows of what is no element of the mesh go with the fields.
    const bool has_ids = !piece.cell_ids.empty();
    if (has_ids)
      piece.cell_fields.push_back({"", 1, {piece.cell_ids.begin(), piece.cell_ids.end()}});
    MeshData data = cells.build(std::move(piece.points), std::move(piece.vertex_fields),
                                std::move(piece.cell_fields));
    if (auto* const volume = std::get_if<VolumeData>(&data))
      return detail::to_piece(std::move(volume->mesh), std::move(volume->fields), &MeshFields::cell,
                              has_ids, std::move(piece.vertex_ids));
    auto& surface = std::get<SurfaceData>(data);
    return detail::to_piece(std::move(surface.mesh), std::move(surface.fields), &MeshFields::face,
                            has_ids, std::move(piece.vertex_ids));
  });
}

}  // namespace carat
