#pragma once
// One small valid volume mesh in every format and encoding.

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io_support.h"

namespace carat::test {

/// A hexahedron, a wedge beside it, a pyramid on top, a tetrahedron beside that, and a polyhedron
/// of eight faces below: a prism over a pentagon. Two vertices are in no cell.
inline Points mixed_points() {
  Points points(20, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,       // bottom of the hexahedron
      0.1, -0.0, 1, 1.0 / 3, 0, 1, 1, 1, 1, 0, 1, 1,  // its top
      2, 0.5, 0, 2, 0.5, 1,                           // edge of the wedge
      0.5, 0.5, 2, 2, 1, 2,                           // apex of the pyramid and the tetrahedron
      -0.5, 0.5, 0, 0, 0, -1, 1, 0, -1, 1, 1, -1, 0, 1, -1,  // pentagons of the prism
      -0.5, 0.5, -1, 7, 8, 9, 0.30000000000000004, 1e22, 5e-324;
  return points;
}

inline PolyhedralMesh mixed_mesh() {
  CellCollector cells;
  const auto add = [&](CellType type, const std::vector<Index>& vertices) {
    cells.add(type, vertices);
  };
  add(CellType::Hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add(CellType::Wedge, {1, 8, 2, 5, 9, 6});
  add(CellType::Pyramid, {4, 5, 6, 7, 10});
  add(CellType::Tetrahedron, {5, 6, 10, 11});
  for (const std::vector<Index>& face : std::vector<std::vector<Index>>{{0, 1, 2, 3},
                                                                        {0, 3, 12},
                                                                        {13, 14, 15, 16, 17},
                                                                        {0, 1, 14, 13},
                                                                        {1, 2, 15, 14},
                                                                        {2, 3, 16, 15},
                                                                        {3, 12, 17, 16},
                                                                        {12, 0, 13, 17}})
    cells.add_face(face);
  cells.end_cell();
  return std::move(cells).build(mixed_points());
}

inline MeshFields mixed_fields() {
  const auto make = [](const char* name, Index components, Index rows, double seed) {
    Field field{name, components, {}};
    for (Index i = 0; i < rows * components; ++i) field.values.push_back(seed / (i + 3.0));
    return field;
  };
  return {{make("heat", 1, 20, 0.7), make("flow", 3, 20, -1e-200)},
          {},
          {make("conductivity", 6, 5, 1e-310), make("region", 1, 5, 1e17)}};
}

using FaceSets = std::vector<std::multiset<std::set<Index>>>;

/// What cells are but for the numbers and directions of their faces.
inline FaceSets face_sets(const PolyhedralMesh& mesh) {
  FaceSets cells;
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    cells.emplace_back();
    for (const Index f : mesh.cell(c))
      cells.back().insert({mesh.face(f).begin(), mesh.face(f).end()});
  }
  return cells;
}

inline void expect_same_cells(const PolyhedralMesh& a, const PolyhedralMesh& b) {
  ASSERT_EQ(a.n_vertices(), b.n_vertices());
  EXPECT_TRUE(
      same_bits(a.points().data(), b.points().data(), static_cast<std::size_t>(a.points().size())));
  EXPECT_EQ(a.n_faces(), b.n_faces());
  EXPECT_EQ(face_sets(a), face_sets(b));
}

// -- Medit and Gmsh: a hexahedron with a pyramid on top
// --------------------------------------------

inline const std::vector<std::vector<double>>& tower_points() {
  static const std::vector<std::vector<double>> points = {
      {0, 0, 0}, {1, 0, 0}, {1, 1, 0},
      {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
      {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 0.1 + 1.6}};
  return points;
}

inline std::string medit_sample() {
  std::string text = " MeshVersionFormatted 2\n Dimension\n 3\n# nodes\nVertices\n9\n";
  char line[96];
  for (const auto& p : tower_points()) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g 0\n", p[0], p[1], p[2]);
    text += line;
  }
  return text +
         "Edges\n1\n1 2 9\nTriangles\n3\n5 6 9 4\n6 7 9 4\n7 8 9 0\nQuadrilaterals\n2\n1 4 3 2 3\n"
         "5 6 7 8 7\nCorners\n2\n1\n2\nHexahedra\n1\n1 2 3 4 5 6 7 8 1\nPyramids 1\n"
         "5 6 7 8 9 2\nRidges\n1\n1\nEnd\n";
}

enum class GmshForm { Text, Little, Big };

/// Values of a Gmsh file in text or binary.
class GmshBytes {
 public:
  explicit GmshBytes(GmshForm form)
      : form_(form), bytes_(form == GmshForm::Big ? std::endian::big : std::endian::little) {}
  bool text_form() const { return form_ == GmshForm::Text; }
  GmshBytes& text(std::string_view text) {
    bytes_.text(text);
    return *this;
  }
  template <class T>
  GmshBytes& put(T value) {
    if (!text_form()) {
      bytes_.add(value);
    } else {
      char number[40];
      std::snprintf(number, sizeof number, "%.17g ", static_cast<double>(value));
      bytes_.text(number);
    }
    return *this;
  }
  template <class T>
  GmshBytes& put_all(const std::vector<T>& values) {
    for (const T value : values) put(value);
    return line();
  }
  GmshBytes& line() { return text_form() ? text("\n") : *this; }
  GmshBytes& format(const char* version) {
    text("$MeshFormat\n").text(version).text(text_form() ? " 0 8\n" : " 1 8\n");
    if (!text_form()) put(std::int32_t{1}).text("\n");
    return text(
        "$EndMeshFormat\n$PhysicalNames\n2\n2 3 \"the floor\"\n3 1 \"body\"\n"
        "$EndPhysicalNames\n");
  }
  const std::string& str() const { return bytes_.str(); }

 private:
  GmshForm form_;
  Bytes bytes_;
};

inline std::string gmsh_2_sample(GmshForm form) {
  using I = std::int32_t;
  GmshBytes out(form);
  out.format("2.2").text("$Nodes\n9\n");
  for (I v = 0; v < 9; ++v) {
    out.put(v + 1);
    out.put_all(tower_points()[static_cast<std::size_t>(v)]);
  }
  if (!out.text_form()) out.text("\n");
  out.text("$EndNodes\n$Elements\n6\n");
  const auto element = [&](I id, I type, I group, const std::vector<I>& nodes) {
    if (out.text_form()) {
      out.put(id).put(type).put(I{2}).put(group).put(I{1});
    } else {
      out.put(type).put(I{1}).put(I{2}).put(id).put(group).put(I{1});
    }
    out.put_all(nodes);
  };
  element(1, 15, 9, {1});
  element(2, 1, 9, {1, 2});
  element(3, 3, 3, {1, 4, 3, 2});
  element(4, 2, 4, {5, 6, 9});
  element(5, 5, 1, {1, 2, 3, 4, 5, 6, 7, 8});
  element(6, 7, 2, {5, 6, 7, 8, 9});
  if (!out.text_form()) out.text("\n");
  out.text("$EndElements\n$NodeData\n1\n\"u\"\n0\n0\n$EndNodeData\n");
  return out.str();
}

inline std::string gmsh_4_sample(GmshForm form) {
  using I = std::int32_t;
  using L = std::int64_t;
  GmshBytes out(form);
  out.format("4.1").text("$Entities\n").put_all<L>({1, 1, 2, 2});
  out.put(I{1}).put_all<double>({0, 0, 0}).put(L{0}).line();
  const auto entity = [&](I tag, const std::vector<I>& groups, const std::vector<I>& bounding) {
    out.put(tag).put_all<double>({0, 0, 0, 1, 1, 1});
    out.put(static_cast<L>(groups.size())).put_all(groups);
    out.put(static_cast<L>(bounding.size())).put_all(bounding);
  };
  entity(7, {}, {1, -1});
  entity(5, {3}, {7});
  entity(6, {4, 8}, {});
  entity(1, {1}, {5, 6});
  entity(2, {2}, {6});
  if (!out.text_form()) out.text("\n");
  out.text("$EndEntities\n$Nodes\n").put_all<L>({2, 9, 10, 90});
  // One block on a curve with its parameter; numbers with gaps, not ascending.
  out.put(I{1}).put(I{7}).put(I{1}).put(L{2}).put_all<L>({20, 10});
  out.put_all<double>({1, 0, 0, 0.5}).put_all<double>({0, 0, 0, 0.25});
  out.put(I{3}).put(I{1}).put(I{0}).put(L{7}).put_all<L>({30, 40, 50, 60, 70, 80, 90});
  for (std::size_t v = 2; v < 9; ++v) out.put_all(tower_points()[v]);
  if (!out.text_form()) out.text("\n");
  out.text("$EndNodes\n$Elements\n").put_all<L>({5, 5, 1, 6});
  const auto block = [&](I dimension, I tag, I type, L id, const std::vector<L>& nodes) {
    out.put(dimension).put(tag).put(type).put(L{1}).put(id).put_all(nodes);
  };
  block(1, 7, 1, 1, {10, 20});
  block(2, 5, 3, 2, {10, 40, 30, 20});
  block(2, 6, 2, 3, {50, 60, 90});
  block(3, 1, 5, 4, {10, 20, 30, 40, 50, 60, 70, 80});
  block(3, 2, 7, 5, {50, 60, 70, 80, 90});
  if (!out.text_form()) out.text("\n");
  out.text("$EndElements\n");
  return out.str();
}

// -- VTK
// -------------------------------------------------------------------------------------------

/// A hexahedron, a quadrilateral of it, a polyhedron on top, and a voxel apart.
inline std::string vtk_volume_sample(int version, bool binary) {
  Bytes bytes(std::endian::big);
  const auto put_all = [&](const std::vector<std::int64_t>& values, bool large) {
    for (const std::int64_t value : values) {
      if (!binary) {
        bytes.text(std::to_string(value) + " ");
      } else if (large) {
        bytes.add(value);
      } else {
        bytes.add(static_cast<std::int32_t>(value));
      }
    }
    bytes.text("\n");
  };
  bytes.text("# vtk DataFile Version " + std::to_string(version) + ".0\nt\n");
  bytes.text(binary ? "BINARY\n" : "ASCII\n").text("DATASET UNSTRUCTURED_GRID\nPOINTS 17 double\n");
  std::vector<double> coordinates;
  for (const auto& p : tower_points()) coordinates.insert(coordinates.end(), p.begin(), p.end());
  for (int i = 0; i < 8; ++i)
    coordinates.insert(coordinates.end(), {5.0 + (i & 1), 1.0 * (i >> 1 & 1), 1.0 * (i >> 2)});
  for (const double x : coordinates) {
    if (binary) {
      bytes.add(x);
    } else {
      char number[40];
      std::snprintf(number, sizeof number, "%.17g ", x);
      bytes.text(number);
    }
  }
  const std::vector<std::vector<std::int64_t>> cells = {
      {0, 1, 2, 3, 4, 5, 6, 7},
      {0, 1, 2, 3},
      {5, 4, 4, 5, 6, 7, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8},
      {9, 10, 11, 12, 13, 14, 15, 16}};
  if (version < 5) {
    bytes.text("\nCELLS 4 46\n");
    for (const auto& cell : cells) {
      put_all({static_cast<std::int64_t>(cell.size())}, false);
      if (binary) {
        // No line ends between binary rows.
        std::string text = bytes.str();
        text.pop_back();
        bytes = Bytes(std::endian::big);
        bytes.text(text);
      }
      for (const std::int64_t value : cell) {
        if (binary) {
          bytes.add(static_cast<std::int32_t>(value));
        } else {
          bytes.text(std::to_string(value) + " ");
        }
      }
    }
  } else {
    bytes.text("\nCELLS 5 42\nOFFSETS vtktypeint64\n");
    put_all({0, 8, 12, 34, 42}, true);
    bytes.text("CONNECTIVITY vtktypeint64\n");
    std::vector<std::int64_t> all;
    for (const auto& cell : cells) all.insert(all.end(), cell.begin(), cell.end());
    put_all(all, true);
  }
  bytes.text("\nCELL_TYPES 4\n");
  put_all({12, 9, 42, 11}, false);
  bytes.text("\nCELL_DATA 4\nSCALARS id int 1\nLOOKUP_TABLE default\n");
  put_all({10, 20, 30, 40}, false);
  return bytes.str();
}

/// The same in VTU, with the polyhedron in either way, in two pieces.
inline std::string vtu_volume_sample(bool new_way) {
  const std::string array = "<DataArray type=\"Int64\" format=\"ascii\" Name=\"";
  const std::string end = "</DataArray>\n";
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">\n<CellData>" +
      array + "id\">40" + end +
      "</CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
      "format=\"ascii\">5 0 0 6 0 0 5 1 0 6 1 0 5 0 1 6 0 1 5 1 1 6 1 1" +
      end + "</Points>\n<Cells>" + array + "connectivity\">0 1 2 3 4 5 6 7" + end + array +
      "offsets\">8" + end + array + "types\">11" + end + "</Cells></Piece>\n" +
      "<Piece NumberOfPoints=\"9\" NumberOfCells=\"3\">\n<CellData>" + array + "id\">10 20 30" +
      end +
      "</CellData>\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
      "format=\"ascii\">";
  char number[40];
  for (const auto& p : tower_points())
    for (const double x : p) {
      std::snprintf(number, sizeof number, "%.17g ", x);
      text += number;
    }
  text += end + "</Points>\n<Cells>" + array + "connectivity\">0 1 2 3 4 5 6 7 0 1 2 3 4 5 6 7 8" +
          end + array + "offsets\">8 12 17" + end + array + "types\">12 9 42" + end;
  if (new_way) {
    text += array + "face_connectivity\">4 5 6 7 4 5 8 5 6 8 6 7 8 7 4 8" + end + array +
            "face_offsets\">4 7 10 13 16" + end + array + "polyhedron_to_faces\">0 1 2 3 4" + end +
            array + "polyhedron_offsets\">0 0 5" + end;
  } else {
    text += array + "faces\">5 4 4 5 6 7 3 4 5 8 3 5 6 8 3 6 7 8 3 7 4 8" + end + array +
            "faceoffsets\">-1 -1 22" + end;
  }
  return text + "</Cells></Piece>\n</UnstructuredGrid></VTKFile>\n";
}

inline std::string ovm_sample() {
  const TemporaryFolder folder;
  write_volume(folder / "a.ovm", mixed_mesh(), mixed_fields(), {{"wall", "", {1, 2}}});
  return read_bytes(folder / "a.ovm");
}

struct VolumeSample {
  std::string name, file, content;
};

inline const std::vector<VolumeSample>& volume_samples() {
  static const std::vector<VolumeSample> samples = [] {
    std::vector<VolumeSample> list = {
        {"ovm", "a.ovm", ovm_sample()},
        {"medit", "a.mesh", medit_sample()},
        {"gmsh2_text", "a.msh", gmsh_2_sample(GmshForm::Text)},
        {"gmsh2_little", "a.msh", gmsh_2_sample(GmshForm::Little)},
        {"gmsh4_text", "a.msh", gmsh_4_sample(GmshForm::Text)},
        {"gmsh4_little", "a.msh", gmsh_4_sample(GmshForm::Little)},
        {"gmsh4_big", "a.msh", gmsh_4_sample(GmshForm::Big)},
        {"vtk3_text", "a.vtk", vtk_volume_sample(3, false)},
        {"vtk3_binary", "a.vtk", vtk_volume_sample(3, true)},
        {"vtk5_text", "a.vtk", vtk_volume_sample(5, false)},
        {"vtk5_binary", "a.vtk", vtk_volume_sample(5, true)},
        {"vtu_old_polyhedra", "a.vtu", vtu_volume_sample(false)},
        {"vtu_new_polyhedra", "a.vtu", vtu_volume_sample(true)},
    };
    const TemporaryFolder folder;
    write_volume(folder / "a.vtu", mixed_mesh(), mixed_fields());
    list.push_back({"vtu_appended", "a.vtu", read_bytes(folder / "a.vtu")});
    return list;
  }();
  return samples;
}

inline VolumeData read_volume_as(const std::string& name, std::string_view content) {
  const TemporaryFolder folder;
  return read_volume(write_bytes(folder / name, content));
}

}  // namespace carat::test
